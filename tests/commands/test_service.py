"""``tank service`` and ``tank param`` without a real ROS 2. With one, see `tests/ros/test_beside_ros2.py`."""

import pytest

from tutorial.errors import TutorialError
from tutorial.ros.topics.names import service_class


@pytest.mark.pocket
@pytest.mark.parametrize("command", ["service list", "service type /x", "service call /x std_srvs/srv/Trigger"])
def test_services_need_a_real_ros_2(tank, command):
    run = tank(command)
    assert (run.status, run.stdout) == (1, "")
    assert run.stderr.startswith("A service needs a real ROS 2, because the pocket one has only topics. ")
    assert run.stderr.endswith("To use it, run export TUTORIAL_ROS=rclpy or, in a notebook, use_real_ros().\n")


@pytest.mark.pocket
@pytest.mark.parametrize("command", ["list", "list /x", "get /x y", "set /x y -1.0", "describe /x y", "dump /x"])
def test_parameters_of_other_nodes_need_a_real_ros_2(tank, command):
    run = tank(f"param {command}")
    assert (run.status, run.stdout) == (1, "")
    assert run.stderr.startswith("Another node's parameter needs a real ROS 2, because")


@pytest.mark.parametrize(
    ("name", "said"),
    [
        ("os/srv/path", "The passed service type is invalid"),
        ("sensor_msgs/srv/Nope", "The passed service type is invalid"),
        ("a/b/c/d", "The passed service type is invalid"),
        ("sensor_msgs/msg/Joy", "The passed type is not a service"),
    ],
)
def test_an_invalid_service_type_is_refused(name, said):
    with pytest.raises(TutorialError, match=said):
        service_class(name)
