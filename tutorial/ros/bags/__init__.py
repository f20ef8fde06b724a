"""Record, read and play bags, in the same file formats as ``ros2 bag``. The package prints nothing."""

from importlib import import_module
from typing import TYPE_CHECKING, Any

from tutorial.ros.bags.bag import Bag, BagTopic
from tutorial.ros.bags.info import bag_info

if TYPE_CHECKING:
    from tutorial.ros.bags.player import Player
    from tutorial.ros.bags.recorder import Recorder

__all__ = ["Bag", "BagTopic", "Player", "Recorder", "bag_info"]

WITH_RCLPY = {"Player": "player", "Recorder": "recorder"}
"""The modules of the classes that need rclpy. Reading a bag does not need rclpy."""


def __getattr__(name: str) -> Any:
    """On first use, import a class that needs rclpy."""
    if name not in WITH_RCLPY:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(import_module(f"{__name__}.{WITH_RCLPY[name]}"), name)
