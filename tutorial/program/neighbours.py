"""Warnings about other programs that use the same ROS domain and interfere with this program."""

import logging
import time

from tutorial.ros.clock_publisher import CLOCK_TOPIC
from tutorial.ros.node_thread import NodeThread

CHECK_EVERY = 1.0  # [s]
SAME_NAME = (
    "there are %d nodes named %s, so they cannot be distinguished. Give one node a different name "
    "with --ros-args -r __node:=%s_2, or its own ROS_DOMAIN_ID"
)
SAME_CLOCK = (
    "there are %d publishers on /clock, so simulated time jumps for every node that uses it. Make sure that "
    "only one program publishes /clock: remove 'clock: true' from the other program's project, or give that program "
    "its own ROS_DOMAIN_ID"
)

_log = logging.getLogger(__name__)


class Neighbours:
    """Warns if another node has the same name as this program's node, or if another program also publishes the clock.

    Args:
        ros: the thread of the program's node.
        publishes_clock: whether the program publishes simulated time.
    """

    def __init__(self, ros: NodeThread, publishes_clock: bool) -> None:
        self._ros = ros
        self._publishes_clock = publishes_clock
        self._checked_at = 0.0
        self._counts: dict[str, int] = {}  # the last count, keyed by the text of its warning

    def check(self) -> None:
        """At most once a second, count the nodes with this name and the clock publishers; warn if a count has risen."""
        if time.monotonic() - self._checked_at < CHECK_EVERY:
            return
        self._checked_at = time.monotonic()
        node = self._ros.node
        self._warn(SAME_NAME, self._ros.namesakes(), node.get_fully_qualified_name(), node.get_name())
        if self._publishes_clock:
            self._warn(SAME_CLOCK, node.count_publishers(CLOCK_TOPIC))

    def _warn(self, text: str, count: int, *names: str) -> None:
        if count > max(self._counts.get(text, 1), 1):
            _log.warning(text, count, *names)
        self._counts[text] = count
