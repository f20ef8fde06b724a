"""Step 6: a joystick, and a simulation that publishes its joint states and its camera's images."""

from pathlib import Path

from launch import LaunchDescription
from launch.actions import ExecuteProcess

PROJECT = Path(__file__).resolve().parent.parent / "project"


def generate_launch_description():
    return LaunchDescription(
        [
            ExecuteProcess(
                name="joystick",
                cmd=["tank", "joy", "--ros-args", "-r", "__node:=joystick"],
                output="screen",
            ),
            ExecuteProcess(
                name="simulation",
                cmd=["tank", "run", str(PROJECT / "step6.yaml"), "--ros-args", "-r", "__node:=simulation"],
                output="screen",
            ),
        ]
    )
