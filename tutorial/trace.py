"""When each message was received, posted and applied, and on which thread: the hand-off, made visible.

A program without a trace pays one look at an attribute per message and per call. One with a trace keeps the newest
handoffs and nothing else, so it can stay on.
"""

from __future__ import annotations

import copy
import threading
import time
from collections import deque
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass


@dataclass(frozen=True)
class Moment:
    """A time and a thread.

    Attributes:
        time: of `time.perf_counter` [s].
        thread: the thread's name.
    """

    time: float
    thread: str

    @classmethod
    def now(cls) -> Moment:
        """This moment, on this thread."""
        return cls(time.perf_counter(), threading.current_thread().name)


@dataclass
class Handoff:
    """The way of one message through a program, or of one call that no message gave rise to.

    A message whose callback posts several calls has one of these for each call.

    Attributes:
        topic: where the message came from, or None for a call that was posted outside of any message's callback.
        received: when the message's callback began.
        handled: when its callback returned.
        posted: when a call was posted.
        applied: when that call began to run.
        superseded: when a newer call of the same key took its place.
    """

    topic: str | None = None
    received: Moment | None = None
    handled: Moment | None = None
    posted: Moment | None = None
    applied: Moment | None = None
    superseded: Moment | None = None

    @property
    def outcome(self) -> str:
        """``"applied"``, ``"superseded"``, ``"waiting"``, or ``"handled"`` where the callback posted nothing.

        A call that was dropped, because the one who posted it had closed, waits for ever.
        """
        if self.applied is not None:
            return "applied"
        if self.superseded is not None:
            return "superseded"
        return "handled" if self.posted is None else "waiting"

    def apply(self) -> None:
        """The posted call runs now, on this thread."""
        self.applied = Moment.now()

    def supersede(self, newer: Handoff | None) -> None:
        """A newer call has taken the place of the posted one, when it was posted itself."""
        self.superseded = newer.posted if newer is not None else Moment.now()


class HandoffTrace:
    """The newest handoffs of a program. May be used from any thread.

    Give it to `tutorial.handoff.CallQueue`, and to the attribute ``trace`` of a `tutorial.ros.node_thread.MeteredNode`.

    Args:
        capacity: how many are kept; the oldest go first.

    Attributes:
        handled: how many messages' callbacks have returned, kept or not.
    """

    def __init__(self, capacity: int = 200) -> None:
        self._lock = threading.Lock()
        self._kept: deque[Handoff] = deque(maxlen=capacity)
        self._current = threading.local()
        self.handled = 0

    @contextmanager
    def receiving(self, topic: str) -> Iterator[None]:
        """Around a message's callback, on the thread that runs it: what it posts meanwhile belongs to the message.

        Args:
            topic: where the message came from.
        """
        outer = getattr(self._current, "message", None)
        handoff = Handoff(topic, received=Moment.now())
        self._current.message = handoff
        self._keep(handoff)
        try:
            yield
        finally:
            handoff.handled = Moment.now()
            with self._lock:
                self.handled += 1
            self._current.message = outer

    def post(self) -> Handoff:
        """A call is posted here and now. Return what is to be told of its further way: `apply` or `supersede`."""
        message: Handoff | None = getattr(self._current, "message", None)
        if message is not None and message.posted is None:
            message.posted = Moment.now()
            return message
        another = Handoff(posted=Moment.now())
        if message is not None:
            another.topic, another.received = message.topic, message.received
        self._keep(another)
        return another

    def handoffs(self) -> list[Handoff]:
        """Return a copy of those that are kept, in the order in which they began."""
        with self._lock:
            return [copy.copy(handoff) for handoff in self._kept]

    def _keep(self, handoff: Handoff) -> None:
        with self._lock:
            self._kept.append(handoff)
