"""What only a real ROS 2 can run."""

from pathlib import Path

import pytest

from tutorial.ros.backend import ros_backend


def need_ros_for(notebook: Path) -> None:
    """Skip a test of a notebook that needs a real ROS 2 if the tests use the pocket one."""
    if notebook.stem == "10_services" and ros_backend() == "pocket":
        pytest.skip("services need a real ROS 2: see make test-ros2")
