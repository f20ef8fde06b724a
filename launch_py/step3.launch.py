"""Step 3: like step 2, plus a separate program with a viewer for the joint states."""

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
                cmd=["tank", "run", str(PROJECT / "step2.yaml"), "--ros-args", "-r", "__node:=simulation"],
                output="screen",
            ),
            ExecuteProcess(
                name="viewer",
                cmd=["tank", "run", str(PROJECT / "step3.yaml"), "--ros-args", "-r", "__node:=viewer"],
                output="screen",
            ),
        ]
    )
