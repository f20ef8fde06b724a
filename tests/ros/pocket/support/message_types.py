"""Find message classes by the names of their types."""

from importlib import import_module
from typing import Any

import pytest

import pocket_ros2


def message_class(type_name: str) -> type[Any]:
    """Import a class, such as ``"sensor_msgs/msg/Joy"``; skip the test if a real ROS 2 lacks the package."""
    package, _, name = type_name.split("/")
    module = import_module(f"{package}.msg") if pocket_ros2.install() else pytest.importorskip(f"{package}.msg")
    found: type[Any] = getattr(module, name)
    return found
