"""Beside a real ROS 2, where the environment variable TANK_REAL_ROS2 names a command that runs another one on it."""

from __future__ import annotations

import os
import subprocess
from collections.abc import Callable
from pathlib import Path

import pytest

REAL = os.environ.get("TANK_REAL_ROS2", "")

pytestmark = [
    pytest.mark.embedded,
    pytest.mark.skipif(not REAL, reason="TANK_REAL_ROS2 names no command that runs another one on a real ROS 2"),
]

TALKER = """
import rclpy
from std_msgs.msg import String
rclpy.init(args=[])
node = rclpy.create_node("talker")
node.create_publisher(String, "words", 10)
print("ready", flush=True)
rclpy.spin(node)
"""


@pytest.fixture(params=["rmw_cyclonedds_cpp", "rmw_fastrtps_cpp"])
def ros2(request: pytest.FixtureRequest) -> Callable[..., subprocess.CompletedProcess[str]]:
    """Run a real ``ros2`` with some arguments."""

    def run(*arguments: str) -> subprocess.CompletedProcess[str]:
        return subprocess.run(
            [REAL, "ros2", *arguments],
            cwd=Path(__file__).parents[3],
            env=os.environ | {"RMW_IMPLEMENTATION": request.param},
            capture_output=True,
            text=True,
            check=True,
            timeout=60,
        )

    return run


def test_it_finds_our_topic_and_has_nothing_to_complain_of(
    start: Callable[[str], subprocess.Popen[str]], ros2: Callable[..., subprocess.CompletedProcess[str]]
) -> None:
    process = start(TALKER)
    assert process.stdout is not None
    assert process.stdout.readline() == "ready\n"
    for _ in range(5):
        listed = ros2("topic", "list", "-t", "--no-daemon", "--spin-time", "3")
        assert listed.stderr == ""
        if "/words [std_msgs/msg/String]" in listed.stdout.splitlines():
            return
    pytest.fail(f"it lists {listed.stdout}")
