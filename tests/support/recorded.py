"""The recorded output of a real ``ros2``, from tests/support/data."""

import re
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path

from sensor_msgs.msg import JointState, Joy

from tutorial.ros.node_thread import MeteredNode, NodeThread

RECORDED = (Path(__file__).parent / "data" / "ros2_cli.txt").read_text(encoding="utf-8")


def recorded(command: str) -> str:
    """Return a command's output, including standard error."""
    return _row(command)[1]


def recorded_status(command: str) -> int:
    """A command's exit status."""
    return int(_row(command)[2])


def joint_state() -> JointState:
    """Return the message that was published."""
    message = JointState(name=["TURRET_Y", "TURRET_P"], position=[0.25, -0.00979])
    message.velocity, message.effort = [0.0, 0.0], [0.0, 1.9613]
    message.header.stamp.sec, message.header.stamp.nanosec = 8, 160_000_000
    return message


@contextmanager
def recorded_nodes() -> Iterator[list[MeteredNode]]:
    """Run the three recorded nodes, each in its own context; the first publishes at 50 Hz."""
    with ExitStack() as stack:
        nodes = [stack.enter_context(NodeThread(name)).node for name in ("simulation", "viewer", "joystick")]
        simulation, viewer, joystick = nodes
        publisher, message = simulation.create_publisher(JointState, "/Tank/joint_state", 1), joint_state()
        simulation.create_timer(0.02, lambda: publisher.publish(message))
        simulation.create_subscription(Joy, "/joy", lambda _: None, 10)
        viewer.create_subscription(JointState, "/Tank/joint_state", lambda _: None, 1)
        joystick.create_publisher(Joy, "/joy", 1)
        yield nodes


def _row(command: str) -> re.Match[str]:
    found = re.search(rf"^\$ {re.escape(command)}\n(.*?)^\[exit (\d+)\]$", RECORDED, re.DOTALL | re.MULTILINE)
    assert found is not None, command
    return found
