"""Records when each message was received, posted and applied, and the threads, to make the hand-off visible.

Without a trace, a program spends one attribute lookup per message and per call. A trace keeps only the newest handoffs,
so it can stay switched on.
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
        time: from `time.perf_counter` [s].
        thread: the thread's name.
    """

    time: float
    thread: str

    @classmethod
    def now(cls) -> Moment:
        """Return this moment, on this thread."""
        return cls(time.perf_counter(), threading.current_thread().name)


@dataclass
class Handoff:
    """The path of one message through a program, or of one call that was not posted for a message.

    A message whose callback posts several calls has one handoff for each call.

    Attributes:
        topic: the message's topic, or None for a call that was posted outside of any message's callback.
        received: when the message's callback began.
        handled: when its callback returned.
        posted: when a call was posted.
        applied: when that call began to run.
        superseded: when a newer call with the same key replaced it.
    """

    topic: str | None = None
    received: Moment | None = None
    handled: Moment | None = None
    posted: Moment | None = None
    applied: Moment | None = None
    superseded: Moment | None = None

    @property
    def outcome(self) -> str:
        """``"applied"``, ``"superseded"``, ``"waiting"``, or ``"handled"`` if the callback posted nothing.

        A call that was dropped because its scope was closed stays ``"waiting"``.
        """
        if self.applied is not None:
            return "applied"
        if self.superseded is not None:
            return "superseded"
        return "handled" if self.posted is None else "waiting"

    def apply(self) -> None:
        """Record that the posted call begins to run, on this thread."""
        self.applied = Moment.now()

    def supersede(self, newer: Handoff | None) -> None:
        """Record that a newer call replaced this one. The recorded time is that of the newer call's posting."""
        self.superseded = newer.posted if newer is not None else Moment.now()


class HandoffTrace:
    """The newest handoffs of a program. May be used from any thread.

    Give it to `tutorial.handoff.CallQueue`, and to the `tutorial.ros.node_thread.NodeThread` of its node.

    Args:
        capacity: how many handoffs to keep; the oldest are dropped.

    Attributes:
        handled: the number of messages whose callbacks have returned, kept or not.
    """

    def __init__(self, capacity: int = 200) -> None:
        self._lock = threading.Lock()
        self._kept: deque[Handoff] = deque(maxlen=capacity)
        self._current = threading.local()
        self.handled = 0

    @contextmanager
    def receiving(self, topic: str) -> Iterator[None]:
        """Assign the calls that are posted inside this context to a message. Use it on the callback's thread.

        Args:
            topic: the message's topic.
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
        """Record that a call is posted. Return its handoff; call `apply` or `supersede` on that later."""
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
        """Return copies of the newest handoffs, in the order of their beginnings."""
        with self._lock:
            return [copy.copy(handoff) for handoff in self._kept]

    def _keep(self, handoff: Handoff) -> None:
        with self._lock:
            self._kept.append(handoff)
