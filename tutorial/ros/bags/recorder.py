"""Recording: what goes over topics is written into a bag."""

import logging
import math
import threading
import time
from collections import deque
from collections.abc import Collection, Mapping
from contextlib import suppress
from functools import partial
from pathlib import Path
from typing import Any, Self

from rclpy.clock import Clock
from rclpy.node import Node
from rosbags.typesys import Stores, get_typestore

from tutorial.errors import TutorialError
from tutorial.ros.bags.qos import qos_text
from tutorial.ros.bags.storage import LARGEST_MESSAGE, Channel
from tutorial.ros.bags.writer import BagWriter
from tutorial.ros.topics.endpoints import publishers_on, reader_qos
from tutorial.ros.topics.listing import topics_with_types
from tutorial.ros.topics.names import escape_name, full_topic, is_valid_topic, message_class

LOOK_EVERY = 0.1  # [s] for new topics, and for what has been received
QUIET = 0.1  # [s] without a message, after which nothing more is taken to be on its way
FLUSH_EVERY = 1.0  # [s]: of a recording that is killed, so much is missing
DEPTH = 1000  # of the subscriptions, where the publishers' depth would be too little when Python is busy
MOST_WAITING = 2 * LARGEST_MESSAGE  # of messages that wait to be written [bytes]

_log = logging.getLogger(__name__)


class Recorder:
    """Records topics into a bag, for as long as the context lasts.

    Messages are kept as they travel, byte for byte. Their callback posts and returns; a thread of the recorder's own
    writes them, once a second at the latest, and looks for topics that are new. The time of receipt is simulated time
    if the node's parameter ``use_sim_time`` is true.

    Args:
        node: that subscribes; its thread must spin.
        path: the bag's folder, which must not be there.
        topics: their names; None for all that there are, hidden ones excepted, and all that there will be.
        storage: ``"mcap"`` or ``"sqlite3"``.
        max_duration: after how long to begin another file [s].

    Attributes:
        path: the bag's folder.
        lost: how many messages were received and are not written, because the disk was too slow, or full.
        error: why nothing is written any more; None while all is well.

    Raises:
        TutorialError: there is something of this name, or it cannot be made; a topic's name breaks the rules. When the
            context ends: the bag could not be written to its end.
    """

    def __init__(
        self,
        node: Node,
        path: str | Path,
        topics: Collection[str] | None = None,
        storage: str = "mcap",
        max_duration: float = math.inf,
    ) -> None:
        self.path = Path(path)
        self.lost = 0
        self.error: OSError | None = None
        self._node = node
        self._wanted = None if topics is None else {full_topic(node, topic) for topic in topics}
        self._writer = BagWriter(self.path, storage, max_duration)
        self._subscriptions: dict[str, Any] = {}
        self._refused: set[str] = set()
        self._received = 0  # messages, by the thread that spins
        self._lock = threading.Lock()  # of what waits and what is lost
        self._waiting: deque[tuple[str, int, int, bytes]] = deque()
        self._waiting_bytes = 0
        self._flush_at = 0.0
        self._stop = threading.Event()
        self._thread = threading.Thread(target=self._run, name="bag", daemon=True)

    def __enter__(self) -> Self:
        self._look()
        self._thread.start()
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def hears(self, topic: str) -> bool:
        """Whether the recorder has met who publishes a topic: from now on nothing of it is missing."""
        subscription = self._subscriptions.get(topic)
        return subscription is not None and subscription.get_publisher_count() > 0

    @property
    def counts(self) -> Mapping[str, int]:
        """How many messages are written, of each topic that is being recorded."""
        return {topic: self._writer.counts[topic] for topic in tuple(self._subscriptions)}

    @property
    def duration(self) -> float:
        """From the first message to the last one that is written [s]."""
        return self._writer.duration

    def close(self) -> None:
        """Take the subscriptions back, write what has been received, and complete the bag. Idempotent.

        Raises:
            TutorialError: the bag could not be written to its end.
        """
        if self._stop.is_set():
            return
        self._stop.set()
        self._settle()
        self._thread.join()
        for subscription in self._subscriptions.values():
            with suppress(Exception):  # the node may be gone before its recorder
                self._node.destroy_subscription(subscription)
        if self.error is None:
            self._write()
        try:
            self._writer.close()
        except OSError as error:
            self.error = self.error or error
        if self.error is not None:
            raise TutorialError(
                f"the bag {str(self.path)!r} could not be written to its end: {self.error.strerror}. What is in it "
                f"can be read; {self.lost:,} messages and those of the second before are lost. Make room, or record to "
                "another disk."
            ) from self.error

    def _settle(self) -> None:
        """Wait for what was sent before the end and is on its way: until nothing more comes, for a second at most.

        The thread that spins has to say so, for while it has no turn nothing comes, either.
        """
        seen: deque[int] = deque(maxlen=3)
        quiet = threading.Event()

        def look() -> None:
            seen.append(self._received)
            if seen.count(seen[0]) == 3:
                quiet.set()

        with suppress(Exception):  # the node may be gone before its recorder
            timer = self._node.create_timer(QUIET / 2, look, clock=Clock())
            quiet.wait(1.0)
            self._node.destroy_timer(timer)

    def _run(self) -> None:
        """Write and look, until the end."""
        while not self._stop.wait(LOOK_EVERY):
            if self.error is None:
                self._write()
                self._look()

    def _look(self) -> None:
        """Subscribe to the topics that are new."""
        try:
            topics = topics_with_types(self._node, include_hidden=self._wanted is not None)
            for topic in sorted(topics.keys() - self._subscriptions.keys() - self._refused):
                if self._wanted is None or topic in self._wanted:
                    try:
                        self._subscribe(topic, topics[topic])
                    except TutorialError as error:
                        self._refused.add(topic)
                        _log.warning("topic %s is not recorded: %s", escape_name(topic), error)
        except OSError as error:
            self._fail(error)
        except (RuntimeError, UnicodeDecodeError):  # the node is gone; or a real one, which names nothing while any
            return  # name is no text

    def _subscribe(self, topic: str, types: list[str]) -> None:
        """Record a topic, if somebody publishes it.

        Raises:
            TutorialError: it cannot be recorded; the text is the end of a sentence.
        """
        publishers = publishers_on(self._node, topic)
        if not publishers:
            return
        if not is_valid_topic(topic):
            raise TutorialError("its name breaks the rules of ROS 2")
        if len(types) > 1:
            raise TutorialError(f"it has several types, {', '.join(map(escape_name, types[:10]))}")
        kind, request = message_class(types[0]), reader_qos(self._node, topic)
        request.depth = DEPTH
        heard = partial(self._on_message, topic)
        self._subscriptions[topic] = self._node.create_subscription(kind, topic, heard, request, raw=True)
        qos = qos_text(info.qos_profile for info in publishers)
        definition, type_hash = _definition(types[0])
        type_hash = type_hash or str(publishers[0].topic_type_hash)
        self._writer.add_channel(Channel(topic, types[0], "cdr", qos, definition, type_hash))
        _log.info("recording %s", escape_name(topic))

    def _on_message(self, topic: str, payload: bytes, info: Mapping[str, Any]) -> None:
        """Keep the message for the recorder's thread. The thread that spins."""
        self._received += 1
        clock = self._node.get_clock()
        time_ns = clock.now().nanoseconds if clock.ros_time_is_active else info["received_timestamp"]
        if not time_ns:
            return  # before the first message of /clock, simulated time is not known
        with self._lock:
            if self.error is None and self._waiting_bytes <= MOST_WAITING:
                self._waiting_bytes += len(payload)
                self._waiting.append((topic, time_ns, info["source_timestamp"], payload))
            else:
                if not self.lost:
                    _log.warning("messages are lost: the disk is too slow, or full")
                self.lost += 1

    def _write(self) -> None:
        """Write what has been received."""
        try:
            while self._waiting:
                message = self._waiting.popleft()
                with self._lock:
                    self._waiting_bytes -= len(message[-1])
                self._writer.write(*message)
            if time.monotonic() >= self._flush_at:
                self._writer.flush()
                self._flush_at = time.monotonic() + FLUSH_EVERY
        except OSError as error:
            self._fail(error)

    def _fail(self, error: OSError) -> None:
        """Write no more."""
        with self._lock:
            self.error = error
            self.lost += len(self._waiting)
            self._waiting.clear()
        _log.error("the bag %r cannot be written any more: %s", str(self.path), error.strerror)


def _definition(type_name: str) -> tuple[str, str]:
    """Return a message type's definition, with those that it is made of, and its hash; empty where it is not known."""
    store = get_typestore(Stores.ROS2_JAZZY)
    if type_name not in store.fielddefs:
        return "", ""
    return store.generate_msgdef(type_name, ros_version=2)[0], store.hash_rihs01(type_name)
