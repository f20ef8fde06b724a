"""Record topics to a bag."""

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

LOOK_EVERY = 0.1  # [s] between checks for new topics and received messages
QUIET = 0.1  # [s]; after this long without messages, the recorder expects no more
FLUSH_EVERY = 1.0  # [s]; if the recorder is killed, at most the messages from this period are lost
DEPTH = 1000  # depth of the subscriptions; the publishers' own depths can be too small while Python is busy
MOST_WAITING = 2 * LARGEST_MESSAGE  # [bytes] maximum total size of the messages waiting to be written

_log = logging.getLogger(__name__)


class Recorder:
    """Records topics to a bag inside a ``with`` block.

    Messages are stored byte for byte. Callbacks only queue them; a separate thread writes them, flushes once a second,
    and looks for new topics. The time of receipt is simulated time if the node's parameter ``use_sim_time`` is true.

    Args:
        node: the node that subscribes; it must be spinning on another thread.
        path: the bag's folder, which must not exist.
        topics: their names; None for all existing and future topics, except for hidden ones.
        storage: ``"mcap"`` or ``"sqlite3"``.
        max_duration: maximum duration of each file [s]; after that, the next file is started.

    Attributes:
        path: the bag's folder.
        lost: number of received messages that could not be written because the disk was too slow or full.
        error: why writing has stopped; None if there was no error.

    Raises:
        TutorialError: the folder exists or cannot be created, or a topic's name breaks the naming rules. At the
            end of the block: the bag could not be completed.
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
        self._received = 0  # messages, counted on the executor's thread
        self._lock = threading.Lock()  # protects the waiting messages and `lost`
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
        """Return whether the recorder has discovered a topic's publisher. If so, every later message is recorded."""
        subscription = self._subscriptions.get(topic)
        return subscription is not None and subscription.get_publisher_count() > 0

    @property
    def counts(self) -> Mapping[str, int]:
        """Number of messages written so far on each recorded topic."""
        return {topic: self._writer.counts[topic] for topic in tuple(self._subscriptions)}

    @property
    def duration(self) -> float:
        """Time from the first message to the last one written [s]."""
        return self._writer.duration

    def close(self) -> None:
        """Destroy the subscriptions, write all received messages, and complete the bag. Idempotent.

        Raises:
            TutorialError: the bag could not be completed.
        """
        if self._stop.is_set():
            return
        self._stop.set()
        self._settle()
        self._thread.join()
        for subscription in self._subscriptions.values():
            with suppress(Exception):  # the node may be destroyed before its recorder
                self._node.destroy_subscription(subscription)
        if self.error is None:
            self._write()
        try:
            self._writer.close()
        except OSError as error:
            self.error = self.error or error
        if self.error is not None:
            raise TutorialError(
                f"the bag {str(self.path)!r} could not be completed: {self.error.strerror}. Its content can be read, "
                f"but {self.lost:,} messages, and those from up to a second before them, are lost. Free some space, or "
                "record to a different disk."
            ) from self.error

    def _settle(self) -> None:
        """Wait, for at most one second, until the messages that were sent before the recording ended stop arriving.

        A timer on the executor's thread checks for new messages, because no messages arrive while that thread is busy.
        """
        seen: deque[int] = deque(maxlen=3)
        quiet = threading.Event()

        def look() -> None:
            seen.append(self._received)
            if seen.count(seen[0]) == 3:
                quiet.set()

        with suppress(Exception):  # the node may be destroyed before its recorder
            timer = self._node.create_timer(QUIET / 2, look, clock=Clock())
            quiet.wait(1.0)
            self._node.destroy_timer(timer)

    def _run(self) -> None:
        """Write messages and look for new topics until the recording ends."""
        while not self._stop.wait(LOOK_EVERY):
            if self.error is None:
                self._write()
                self._look()

    def _look(self) -> None:
        """Subscribe to new topics."""
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
        except (RuntimeError, UnicodeDecodeError):  # the node is destroyed, or the real rclpy cannot decode a name
            return

    def _subscribe(self, topic: str, types: list[str]) -> None:
        """Record a topic if it has a publisher.

        Raises:
            TutorialError: the topic cannot be recorded; the error's text completes a sentence.
        """
        publishers = publishers_on(self._node, topic)
        if not publishers:
            return
        if not is_valid_topic(topic):
            raise TutorialError("its name breaks ROS 2's naming rules")
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
        """Queue a message for the recorder's thread. Called on the executor's thread."""
        self._received += 1
        clock = self._node.get_clock()
        time_ns = clock.now().nanoseconds if clock.ros_time_is_active else info["received_timestamp"]
        if not time_ns:
            return  # simulated time is not known before the first message on /clock
        with self._lock:
            if self.error is None and self._waiting_bytes <= MOST_WAITING:
                self._waiting_bytes += len(payload)
                self._waiting.append((topic, time_ns, info["source_timestamp"], payload))
            else:
                if not self.lost:
                    _log.warning("messages are being lost: the disk is too slow or full")
                self.lost += 1

    def _write(self) -> None:
        """Write the received messages."""
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
        """Stop writing."""
        with self._lock:
            self.error = error
            self.lost += len(self._waiting)
            self._waiting.clear()
        _log.error("the bag %r can no longer be written to: %s", str(self.path), error.strerror)


def _definition(type_name: str) -> tuple[str, str]:
    """Return a message type's definition, including the types it uses, and its hash; both empty for an unknown type."""
    store = get_typestore(Stores.ROS2_JAZZY)
    if type_name not in store.fielddefs:
        return "", ""
    return store.generate_msgdef(type_name, ros_version=2)[0], store.hash_rihs01(type_name)
