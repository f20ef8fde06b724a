"""Step 7: a simulation that publishes the tank's pose, and a separate program with a viewer for this pose."""

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
                cmd=["tank", "run", str(PROJECT / "step7.yaml"), "--ros-args", "-r", "__node:=simulation"],
                output="screen",
            ),
            ExecuteProcess(
                name="viewer",
                cmd=["tank", "run", str(PROJECT / "step7_viewer.yaml"), "--ros-args", "-r", "__node:=viewer"],
                output="screen",
            ),
        ]
    )
