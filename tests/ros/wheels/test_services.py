"""Services and parameters between a program on the folder's ROS 2 and the ``ros2`` that TANK_REAL_ROS2 runs.

Both use Fast DDS: even in ROS 2 itself, services do not work between different RMWs.
"""

import os
import shlex
import subprocess
import sys

import pytest
from programs import TIMEOUT, until

from tutorial.ros.wheels import folder

REAL = shlex.split(os.environ.get("TANK_REAL_ROS2", ""))
ROBOT = """
import tutorial, rclpy
from std_srvs.srv import Trigger

def reset(request, response):
    response.success, response.message = True, f"gain {node.get_parameter('gain').value:g}"
    return response

rclpy.init()
node = rclpy.create_node("robot")
node.declare_parameter("gain", 200.0)
node.create_service(Trigger, "reset", reset)
print("ready", flush=True)
rclpy.spin(node)
"""

pytestmark = [pytest.mark.ros2, pytest.mark.timeout(300)]
if not REAL:
    pytest.skip("TANK_REAL_ROS2 is not set to a command that runs other commands on ROS 2", allow_module_level=True)
if not folder.is_complete(folder.prefix()):
    pytest.skip(f"the folder of the real ROS 2 is not filled. {folder.how_to_get_it()}", allow_module_level=True)


def test_service_and_parameter(domain):
    environment = {**os.environ, "RMW_IMPLEMENTATION": folder.RMW, "TUTORIAL_ROS": "rclpy"}

    def ros2(*words):
        command = [*REAL, "ros2", *words]
        return subprocess.run(command, env=environment, check=False, capture_output=True, text=True).stdout

    command = [sys.executable, "-c", ROBOT]
    with subprocess.Popen(command, env=environment, stdout=subprocess.PIPE, text=True) as robot:
        try:
            assert robot.stdout.readline() == "ready\n"
            set_gain = ("param", "set", "/robot", "gain", "100.0")
            until(lambda: "successful" in ros2(*set_gain), "the parameter", 2 * TIMEOUT)
            assert "message='gain 100'" in ros2("service", "call", "/reset", "std_srvs/srv/Trigger")
        finally:
            robot.kill()
            ros2("daemon", "stop")
