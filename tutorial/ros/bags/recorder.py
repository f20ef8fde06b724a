"""Recording: what goes over topics is written into a bag."""

from __future__ import annotations

import logging
import threading
import time
from collections import deque
from collections.abc import Collection, Mapping
from contextlib import suppress
from functools import cache, partial
from pathlib import Path
from types import MappingProxyType
from typing import Any, Self

from rclpy.clock import Clock
from rclpy.node import Node
from rclpy.qos import QoSProfile
from rosbags.typesys import Stores, get_typestore

from tutorial.errors import TutorialError
from tutorial.ros.bags.metadata import qos_text
from tutorial.ros.bags.storage import LARGEST_MESSAGE, MOST_TOPICS, Channel
from tutorial.ros.bags.writer import BagWriter
from tutorial.ros.topics.endpoints import publishers_on, reader_qos
from tutorial.ros.topics.listing import topics_with_types
from tutorial.ros.topics.names import escape_name, full_topic, is_valid_topic, message_class

__all__ = ["Recorder"]

LOOK_EVERY = 0.1  # [s] for new topics, and for what has been received
QUIET = 0.1  # [s] without a message, after which nothing more is taken to be on its way
FLUSH_EVERY = 1.0  # [s]: of a recording that is killed, so much is missing
DEPTH = 1000  # of the subscriptions, where the publishers' depth would be too little when Python is busy
MOST_WAITING = 2 * LARGEST_MESSAGE  # of messages that wait to be written [bytes]
MOST_PROFILES = 100  # of the publishers of one topic
SAY_EVERY = 5.0  # [s] between two log lines about what is lost

_log = logging.getLogger(__name__)


class Recorder:
    """Records topics into a bag, for as long as the context lasts.

    Messages are kept as they travel, byte for byte. Their callback posts and returns; a thread of the recorder's own
    writes them, once a second at the latest, and looks for topics that are new.

    Args:
        node: that subscribes; its thread must spin.
        path: the bag's folder, which must not be there.
        topics: their names; None for all that there are, hidden ones excepted, and all that there will be.
        storage: ``"mcap"`` or ``"sqlite3"``.
        max_duration: after how long to begin another file [s]; None for one file.

    Attributes:
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
        max_duration: float | None = None,
    ) -> None:
        self._overflown = 0  # by the thread that spins
        self._unwritten = 0  # by the recorder's own
        self.error: OSError | None = None
        self._node = node
        self._wanted = None if topics is None else {full_topic(node, topic) for topic in topics}
        self._writer = BagWriter(Path(path), storage, max_duration)
        self._subscriptions: dict[str, Any] = {}
        self._refused: set[str] = set()
        self._waiting: deque[tuple[int, int, int, bytes]] = deque()
        self._received_bytes = 0  # by the thread that spins
        self._taken_bytes = 0  # by the recorder's own
        self._said_lost = 0
        self._say_lost_at = 0.0
        self._flush_at = 0.0
        self._stop = threading.Event()
        self._closed = False
        self._thread = threading.Thread(target=self._run, name="bag", daemon=True)

    def __enter__(self) -> Self:
        self._look()
        self._thread.start()
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    @property
    def path(self) -> Path:
        """The bag's folder."""
        return self._writer.path

    @property
    def topics(self) -> tuple[str, ...]:
        """The topics that are being recorded."""
        return tuple(self._subscriptions)

    @property
    def missing(self) -> tuple[str, ...]:
        """The topics that were asked for by name and that nobody publishes so far."""
        return tuple(sorted((self._wanted or set()) - self._subscriptions.keys()))

    def hears(self, topic: str) -> bool:
        """Whether the recorder has met who publishes a topic: from now on nothing of it is missing."""
        subscription = self._subscriptions.get(topic)
        return subscription is not None and subscription.get_publisher_count() > 0

    @property
    def counts(self) -> Mapping[str, int]:
        """How many messages of each topic are written."""
        return MappingProxyType(dict.fromkeys(self._subscriptions, 0) | self._writer.counts)

    @property
    def lost(self) -> int:
        """How many messages were received and are not written, because the disk was too slow, or full."""
        return self._overflown + self._unwritten

    @property
    def duration(self) -> float:
        """From the first message to the last one that is written [s]."""
        return (self._writer.end - self._writer.start) / 1e9

    def close(self) -> None:
        """Take the subscriptions back, write what has been received, and complete the bag. Idempotent.

        Raises:
            TutorialError: the bag could not be written to its end.
        """
        if self._closed:
            return
        self._closed = True
        self._settle()
        self._stop.set()
        if self._thread.ident is not None:
            self._thread.join()
        for subscription in self._subscriptions.values():
            with suppress(Exception):  # the node may be gone before its recorder
                self._node.destroy_subscription(subscription)
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
            seen.append(self._received_bytes + self._overflown)
            if seen.count(seen[0]) == 3:
                quiet.set()

        with suppress(Exception):  # the node may be gone before its recorder
            timer = self._node.create_timer(QUIET / 2, look, clock=Clock())
            quiet.wait(1.0)
            self._node.destroy_timer(timer)

    def _run(self) -> None:
        """Write and look, until the end."""
        while not self._stop.wait(LOOK_EVERY):
            self._write()
            if self.error is None:
                self._look()

    def _look(self) -> None:
        """Subscribe to the topics that are new."""
        try:
            topics = topics_with_types(self._node, include_hidden=self._wanted is not None)
            for topic in sorted(topics.keys() - self._subscriptions.keys() - self._refused):
                if self._wanted is None or topic in self._wanted:
                    self._subscribe(topic, topics[topic])
        except OSError as error:
            self._fail(error)
        except (RuntimeError, UnicodeDecodeError):  # the node is gone; or a real one, which names nothing while any
            return  # name is no text

    def _subscribe(self, topic: str, types: list[str]) -> None:
        """Record a topic, if somebody publishes it and its messages are of a type that is known here."""
        publishers = publishers_on(self._node, topic)
        if not publishers:
            return
        try:
            kind = self._kind(topic, types)
        except TutorialError as error:
            self._refused.add(topic)
            _log.warning("topic %s is not recorded: %s", escape_name(topic), error)
            return
        number = len(self._subscriptions) + 1
        qos = qos_text(info.qos_profile for info in publishers[:MOST_PROFILES])
        definition, type_hash = _definition(types[0])
        type_hash = type_hash or str(publishers[0].topic_type_hash)
        self._subscriptions[topic] = self._node.create_subscription(
            kind, topic, partial(self._on_message, number), self._request(topic), raw=True
        )
        self._writer.add_channel(Channel(number, topic, types[0], "cdr", qos, definition, type_hash))
        _log.info("recording %s", escape_name(topic))

    def _kind(self, topic: str, types: list[str]) -> Any:
        """Return the class of a topic's messages.

        Raises:
            TutorialError: it cannot be recorded; the text is the end of a sentence.
        """
        if not is_valid_topic(topic):
            raise TutorialError("its name breaks the rules of ROS 2")
        if len(types) > 1:
            raise TutorialError(f"it has several types, {', '.join(map(escape_name, types[:10]))}")
        if len(self._subscriptions) >= MOST_TOPICS:
            raise TutorialError(f"there are more than {MOST_TOPICS:,} topics")
        return message_class(types[0])

    def _request(self, topic: str) -> QoSProfile:
        """What all publishers of a topic fit, with room for what comes while this program is busy."""
        qos = reader_qos(self._node, topic)
        qos.depth = DEPTH
        return qos

    def _on_message(self, channel_id: int, payload: bytes, info: Mapping[str, Any]) -> None:
        """Keep the message for the recorder's thread. The thread that spins."""
        if self.error is not None or self._received_bytes - self._taken_bytes > MOST_WAITING:
            self._overflown += 1
            return
        self._received_bytes += len(payload)
        received, sent = info["received_timestamp"], info["source_timestamp"]
        self._waiting.append((channel_id, received, sent, payload))

    def _write(self) -> None:
        """Write what has been received, and say what is lost."""
        now = time.monotonic()
        try:
            while self._waiting:
                message = self._waiting.popleft()
                self._taken_bytes += len(message[-1])
                if self.error is not None:
                    self._unwritten += 1
                    continue
                self._writer.write(*message)
            if now >= self._flush_at and self.error is None:
                self._writer.flush()
                self._flush_at = now + FLUSH_EVERY
        except OSError as error:
            self._unwritten += 1
            self._fail(error)
        if self.lost > self._said_lost and now >= self._say_lost_at:
            _log.warning("%d messages are lost so far: the disk is too slow, or full", self.lost)
            self._said_lost, self._say_lost_at = self.lost, now + SAY_EVERY

    def _fail(self, error: OSError) -> None:
        """Write no more."""
        self.error = error
        _log.error("the bag %r cannot be written any more: %s", str(self.path), error.strerror)


@cache
def _store() -> Any:
    return get_typestore(Stores.ROS2_JAZZY)


@cache
def _definition(type_name: str) -> tuple[str, str]:
    """Return a message type's definition, with those that it is made of, and its hash; empty where it is not known."""
    store = _store()
    if type_name not in store.fielddefs:
        return "", ""
    return store.generate_msgdef(type_name, ros_version=2)[0], store.hash_rihs01(type_name)
