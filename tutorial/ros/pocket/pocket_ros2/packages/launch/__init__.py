"""The part of ROS 2 launch that the tutorial's launch files use: a list of processes to start.

The same launch file works with and without a real ROS 2: ``ros2 launch`` loads the file with the real package, and
the tutorial's launcher loads the file with this package.
"""

from collections.abc import Iterable

from _absent import TABLE, absent_names
from launch.actions import ExecuteProcess

__all__ = ["LaunchDescription"]

__getattr__ = absent_names(__name__, TABLE["names"][__name__])


class LaunchDescription:
    """The processes that a launch file describes.

    Args:
        initial_entities: the processes to start, in order.
    """

    def __init__(self, initial_entities: Iterable[ExecuteProcess] | None = None) -> None:
        self.entities: list[ExecuteProcess] = list(initial_entities or [])

    def add_action(self, action: ExecuteProcess) -> None:
        """Add a process."""
        self.entities.append(action)
