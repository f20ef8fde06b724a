"""Records when, and on which thread, each message was received, posted and applied, to show how it was handed off.

Without a trace, the only cost is one check per message and per call. A trace stores only the newest handoffs, so it can
remain enabled permanently.
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
        """Return the current time and thread."""
        return cls(time.perf_counter(), threading.current_thread().name)


@dataclass
class Handoff:
    """The path of one message through a program, or of a call that was posted outside any message callback.

    If a callback posts several calls, the message has a handoff for each of them.

    Attributes:
        topic: the message's topic; None if no message caused the call.
        received: when the message's callback began.
        handled: when the callback returned; set only in the message's first handoff.
        posted: when the call was posted.
        applied: when the call began to run.
        superseded: when a newer call with the same key replaced this call.
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

        The outcome of a call that was cancelled because its scope was closed remains ``"waiting"``.
        """
        if self.applied is not None:
            return "applied"
        if self.superseded is not None:
            return "superseded"
        return "handled" if self.posted is None else "waiting"

    def apply(self) -> None:
        """Record that the posted call is beginning to run on this thread."""
        self.applied = Moment.now()

    def supersede(self, newer: Handoff | None) -> None:
        """Record that a newer call replaced this one, at the time when the newer call was posted."""
        self.superseded = newer.posted if newer is not None else Moment.now()


class HandoffTrace:
    """Stores the newest handoffs of a program. Thread-safe.

    Pass the trace to the program's `tutorial.handoff.CallQueue` and `tutorial.ros.node_thread.NodeThread`.

    Args:
        capacity: the maximum number of handoffs to store; older handoffs are dropped.

    Attributes:
        handled: the number of messages whose callbacks have returned, including those whose handoffs were dropped.
    """

    def __init__(self, capacity: int = 200) -> None:
        self._lock = threading.Lock()
        self._kept: deque[Handoff] = deque(maxlen=capacity)
        self._current = threading.local()
        self.handled = 0

    @contextmanager
    def receiving(self, topic: str) -> Iterator[None]:
        """Record a message's callback, which runs in the ``with`` block, and attribute its calls to the message.

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
        """Record that a call was posted, and return its handoff. Call the handoff's `apply` or `supersede` later."""
        message: Handoff | None = getattr(self._current, "message", None)
        if message is not None and message.posted is None:  # the callback's first call
            message.posted = Moment.now()
            return message
        handoff = Handoff(posted=Moment.now())
        if message is not None:
            handoff.topic, handoff.received = message.topic, message.received
        self._keep(handoff)
        return handoff

    def handoffs(self) -> list[Handoff]:
        """Return copies of the newest handoffs, oldest first."""
        with self._lock:
            return [copy.copy(handoff) for handoff in self._kept]

    def _keep(self, handoff: Handoff) -> None:
        with self._lock:
            self._kept.append(handoff)
