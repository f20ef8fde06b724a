"""Play a bag: publish its messages again, with their original timing."""

import asyncio
import heapq
import logging
import math
import threading
import time
from collections.abc import Callable, Collection, Iterator
from operator import itemgetter
from typing import Any

from builtin_interfaces.msg import Time
from rclpy.duration import Duration
from rclpy.node import Node
from rclpy.qos import QoSProfile, ReliabilityPolicy
from rosgraph_msgs.msg import Clock

from tutorial.errors import TutorialError
from tutorial.ros.bags.bag import Bag
from tutorial.ros.bags.qos import offered
from tutorial.ros.topics.graph import wait_for_graph
from tutorial.ros.topics.names import escape_name, full_topic, is_valid_topic, message_class

CLOCK = "/clock"
CLOCK_QOS = QoSProfile(depth=1, reliability=ReliabilityPolicy.BEST_EFFORT)  # like rclcpp's ClockQoS
SETTLE_FOR = 0.3  # [s] how long a discovered subscription takes, with Fast DDS, to discover the publisher
LOOP_PAUSE = 0.02  # [s] pause before a bag is played again: otherwise, a bag with one message would use a whole core
LONGEST_WAIT = 1.0  # [s] between progress reports
LAST_SECOND = 2**31 - 1  # the latest second that a stamp can hold
ACKNOWLEDGED_IN = 1.0  # [s] maximum time to wait for acknowledgements

_log = logging.getLogger(__name__)


class Player:
    """Plays a bag: publishes the recorded messages byte for byte, with the QoS that the original publishers offered.

    Args:
        node: the node that publishes.
        bag: the bag to play.
        rate: the speed; 2 is twice as fast.
        loop: whether to start again at the end, until stopped.
        start_offset: time to skip at the beginning [s].
        topics: the topics to play; None for all.
        clock: how often to publish the bag's time on ``/clock`` [Hz], instead of the recorded ``/clock``; 0 for never.

    Attributes:
        played: number of messages published so far.

    Raises:
        TutorialError: there is no such topic, there is nothing to play, or a number is out of range.
    """

    def __init__(
        self,
        node: Node,
        bag: Bag,
        rate: float = 1.0,
        loop: bool = False,
        start_offset: float = 0.0,
        topics: Collection[str] | None = None,
        clock: float = 0.0,
    ) -> None:
        if not (math.isfinite(rate) and rate > 0):
            raise TutorialError(f"the rate is {rate:g}; give a rate above 0, such as 2 to play twice as fast.")
        if not 0 <= start_offset <= bag.duration:
            raise TutorialError(
                f"the start offset is {start_offset:g} s, but the bag is {bag.duration:.3f} s long. "
                "Give an offset within the bag."
            )
        self.played = 0
        self._node = node
        self._bag = bag
        self._rate = rate
        self._loop = loop
        self._offset = start_offset
        self._clock = clock
        self._qos = self._playable(topics)
        if not any(topic.count for topic in bag.topics if topic.name in self._qos):
            raise TutorialError("there is nothing to play: the bag has no messages on these topics.")
        self._publishers: dict[str, Any] = {}
        self._refused: set[str] = set()

    def run(self, stop: threading.Event, progress: Callable[[float], object] = lambda seconds: None) -> None:  # noqa: ARG005
        """Play to the end, or until stopped. This method blocks: don't call it on a thread that runs an event loop.

        Playback starts when the node graph is known and all existing subscriptions have discovered the publishers. It
        waits at most 2 s (6 s with Fast DDS) for the subscriptions, and at most 8 s for the graph.

        Args:
            stop: an event that any thread can set to stop the playback.
            progress: called with the position in the bag [s].
        """
        try:
            for topic, (kind, qos) in self._qos.items():
                self._publishers[topic] = self._node.create_publisher(kind, topic, qos)
            if self._clock:
                self._publishers[CLOCK] = self._node.create_publisher(Clock, CLOCK, CLOCK_QOS)
            asyncio.run(wait_for_graph(self._node, lambda: stop.is_set() or self._met()))
            if any(publisher.get_subscription_count() for publisher in self._publishers.values()):
                stop.wait(SETTLE_FOR)
            self._play(stop, progress)
            while self._loop and not stop.wait(LOOP_PAUSE):
                self._play(stop, progress)
        finally:
            self._close(stop)

    def _play(self, stop: threading.Event, progress: Callable[[float], object]) -> None:
        """Play once."""
        begin = self._bag.start + round(self._offset * 1e9)
        messages = self._bag.raw_messages(self._qos, self._offset)
        began = time.monotonic()
        for topic, time_ns, message in heapq.merge(self._ticks(begin), messages, key=itemgetter(1)):
            due = began + (time_ns - begin) / 1e9 / self._rate
            while (now := time.monotonic()) < due:
                progress(self._offset + (now - began) * self._rate)
                if stop.wait(min(due - now, LONGEST_WAIT)):
                    return
            if stop.is_set():
                return
            self._publish(topic, message)
            progress((time_ns - self._bag.start) / 1e9)

    def _ticks(self, begin: int) -> Iterator[tuple[str, int, Clock]]:
        """Yield the bag's time at the rate requested for ``/clock``: (topic, time [ns], message)."""
        if self._clock:
            step = min(max(1.0, 1e9 * self._rate / self._clock), 1e18)  # [ns]; both rates can be any positive numbers
            for time_ns in range(begin, self._bag.end + 1, round(step)):
                seconds, rest = divmod(time_ns, 10**9)
                yield CLOCK, time_ns, Clock(clock=Time(sec=min(max(0, seconds), LAST_SECOND), nanosec=rest))

    def _publish(self, topic: str, message: bytes | Clock) -> None:
        """Publish a message. If ROS 2 rejects it because it does not have the topic's type, skip it and warn once."""
        try:
            self._publishers[topic].publish(message)
            self.played += topic in self._qos
        except RuntimeError as error:
            if topic not in self._refused:
                self._refused.add(topic)
                _log.warning("a message on %s is skipped, as are similar messages: %s", escape_name(topic), error)

    def _met(self) -> bool:
        """Return whether the publishers have been matched with all subscriptions to their topics."""
        return all(
            publisher.get_subscription_count() >= self._node.count_subscribers(publisher.topic_name)
            for publisher in self._publishers.values()
        )

    def _close(self, stop: threading.Event) -> None:
        """Destroy the publishers after their messages have been acknowledged."""
        deadline = time.monotonic() + ACKNOWLEDGED_IN
        while self._publishers:
            _, publisher = self._publishers.popitem()
            left = deadline - time.monotonic()
            if left > 0 and not stop.is_set():
                publisher.wait_for_all_acked(Duration(seconds=left))
            self._node.destroy_publisher(publisher)

    def _playable(self, topics: Collection[str] | None) -> dict[str, tuple[Any, QoSProfile]]:
        """Return the class and QoS of each topic that can be played, and log a warning for each that cannot."""
        wanted = self._bag.channels if topics is None else topics
        playable = {}
        for channel in map(self._bag.channel, sorted(wanted)):
            topic = channel.topic
            try:
                if self._full_name(topic) == self._full_name(CLOCK) and self._clock:
                    continue
                if channel.encoding != "cdr":
                    raise TutorialError(f"its messages are {escape_name(channel.encoding)!r}, not 'cdr'")
                playable[topic] = message_class(channel.type_name), offered(channel.qos)
            except TutorialError as error:
                _log.warning("topic %s is not played: %s", escape_name(topic), error)
        return playable

    def _full_name(self, topic: str) -> str:
        """Return the full name of a topic in the bag. Like ros2 bag, resolve a relative name in the node's namespace.

        Raises:
            TutorialError: the name breaks the naming rules.
        """
        try:
            name = full_topic(self._node, topic)
        except TutorialError:
            name = ""
        if not is_valid_topic(name):
            raise TutorialError("the name breaks ROS 2's naming rules")
        return name
