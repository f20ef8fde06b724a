"""Handing work from one thread to another: the first of the two ideas that the tutorial is about.

A callback arrives on whatever thread its source has: ROS 2's executor, a widget's, a timer's. It may not touch what
belongs to another thread; it leaves the news where the owner finds it, and returns. There are two deliveries:

- a *snapshot*, of which only the newest counts: `Latest`, and `CallScope.call_latest`;
- an *event*, of which none may be lost: `CallScope.call_later`.
"""

from __future__ import annotations

import asyncio
import logging
import sys
import threading
import time
from collections import OrderedDict
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Generic, TypeVar, TypeVarTuple

from tutorial.errors import WrongThreadError

if TYPE_CHECKING:
    from collections.abc import Callable, Hashable
    from types import CodeType

    from tutorial.trace import Handoff, HandoffTrace

T = TypeVar("T")
Ts = TypeVarTuple("Ts")

CROWD = 1000  # waiting calls, beyond which it is said that they are too many
LONG_WAIT = 10.0  # [s] beyond which it is said that a call has waited too long
BUSY = (
    "the main thread is too busy for what is posted to it: %d waiting, the first for %.1f s. Let it do less at a time; "
    "where only the newest counts, %s may post with call_latest(key, f, message)"
)

_log = logging.getLogger(__name__)


class Latest(Generic[T]):
    """A value under a lock: one thread puts the newest, another takes it.

    What is put is handed over, not copied: the giver leaves it alone from then on, and the taker copies what it keeps.

    Args:
        value: what `get` returns until something is put.
    """

    def __init__(self, value: T) -> None:
        self._lock = threading.Lock()
        self._value = value

    def put(self, value: T) -> None:
        """Replace the value. Any thread."""
        with self._lock:
            self._value = value

    def get(self) -> T:
        """Return the newest value. Any thread."""
        with self._lock:
            return self._value


class CallQueue:
    """Calls that any thread may post, and that run on the main thread's event loop in the order of their posting.

    Underneath is one locked queue, and one `call_soon_threadsafe` that wakes the loop when the queue stops being empty.
    One turn of the loop runs what was queued when the turn began, so calls that post calls cannot hold it.
    When many calls wait, or one waits long, that is logged, once.

    Args:
        loop: the main thread's loop.
        trace: where to write down when each call is posted and when it runs; None for nowhere.

    Attributes:
        error: what a call raised last, SystemExit included; None when none did.
    """

    def __init__(self, loop: asyncio.AbstractEventLoop, trace: HandoffTrace | None = None) -> None:
        self._loop = loop
        self._trace = trace
        self.error: BaseException | None = None
        self._lock = threading.Lock()
        self._waiting: OrderedDict[Hashable, _Call] = OrderedDict()
        self._awake = False
        self._closed = False
        self._told = False

    def __len__(self) -> int:
        """How many calls wait, those of closed scopes included."""
        return len(self._waiting)

    def scope(self, owner: str) -> CallScope:
        """Make a front for one poster, the owner, as the log calls it; it is closed without closing the queue."""
        return CallScope(self, owner)

    def close(self) -> None:
        """Drop what waits; from now on posting does nothing. Idempotent, any thread."""
        with self._lock:
            self._closed = True
            self._waiting.clear()

    def _post(self, call: _Call, key: Hashable) -> None:
        """Queue a call, or replace the waiting one of the same key; drop it if it came too late."""
        with self._lock:
            if self._closed or call.scope.closed or not self._wake():
                return
            if self._trace is not None:
                call.handoff = self._trace.post()
            replaced = self._waiting.get(key)
            if replaced is not None:
                call.take_place_of(replaced)
            self._waiting[key] = call  # a new key comes last, a known one stays where it is
        self._tell()

    def _tell(self) -> None:
        """Say that many calls wait, or one waits long, unless it was said. Any thread."""
        with self._lock:
            if self._told or not self._waiting:
                return
            count, first = len(self._waiting), next(iter(self._waiting.values()))
            waits = time.monotonic() - first.posted_at
            told = self._told = count > CROWD or waits > LONG_WAIT
        if told:
            _log.warning(BUSY, count, waits, first.scope.owner)

    def _wake(self) -> bool:
        """Ask the loop for a turn unless one is coming; False when the loop is gone. Holds the lock."""
        if not self._awake:
            try:
                self._loop.call_soon_threadsafe(self._turn)
            except RuntimeError:  # the loop was closed before the queue
                return False
            self._awake = True
        return True

    def _turn(self) -> None:
        """Run what waits now; what comes in meanwhile gets a turn of its own. Main thread."""
        try:
            self._tell()
            for _ in range(len(self._waiting)):
                call = self._next()
                if call is None:
                    break
                call.run()
        finally:  # also after a KeyboardInterrupt: in a notebook the loop goes on, and so does what waits
            with self._lock:
                self._awake = False
                if self._waiting:
                    self._wake()

    def _next(self) -> _Call | None:
        with self._lock:
            return self._waiting.popitem(last=False)[1] if self._waiting else None


class CallScope:
    """One poster's front of a `CallQueue`: what it has posted does not run any more once the scope is closed.

    Attributes:
        queue: where its calls wait.
        owner: who posts.
        closed: whether `close` was called.
    """

    def __init__(self, queue: CallQueue, owner: str) -> None:
        self.queue = queue
        self.owner = owner
        self.closed = False

    def call_later(self, function: Callable[[*Ts], object], /, *args: *Ts) -> None:
        """From any thread: run ``function(*args)`` on the main thread. Every call is kept, in order."""
        frame = sys._getframe(1)
        call = _Call(self, function, args, frame.f_code, frame.f_lineno)
        self.queue._post(call, call)  # a key of its own, so nothing is replaced

    def call_latest(self, key: Hashable, function: Callable[[*Ts], object], /, *args: *Ts) -> None:
        """As `call_later`, but a waiting call of the same key, such as a body's name, is replaced, in its place."""
        frame = sys._getframe(1)
        self.queue._post(_Call(self, function, args, frame.f_code, frame.f_lineno), (self, key))

    def close(self) -> None:
        """What still waits will not run; from now on posting does nothing. Idempotent.

        Any thread; but a call that runs already goes on, so only the main thread knows that nothing runs afterwards.
        """
        self.closed = True


@dataclass(slots=True, eq=False)
class _Call:
    """One posted call, and where it was posted."""

    scope: CallScope
    function: Callable[..., object]
    args: tuple[object, ...]
    frame_code: CodeType
    frame_line: int
    thread: str = field(default_factory=lambda: threading.current_thread().name)
    posted_at: float = field(default_factory=time.monotonic)
    handoff: Handoff | None = None

    def take_place_of(self, older: _Call) -> None:
        """Replace an older call: keep its posting time, and tell its trace."""
        self.posted_at = older.posted_at
        if older.handoff is not None:
            older.handoff.supersede(self.handoff)

    def run(self) -> None:
        if self.scope.closed:
            return
        if self.handoff is not None:
            self.handoff.apply()
        try:
            self.function(*self.args)
        except (Exception, SystemExit) as error:  # noqa: BLE001 - whatever it is, the other calls go on
            self.scope.queue.error = error
            posted = f"{self.frame_code.co_filename}:{self.frame_line} on the thread {self.thread!r}"
            _log.exception("%s: a call that was posted at %s failed", self.scope.owner, posted)


class ThreadGuard:
    """Remembers the thread it was made on, and raises when another one comes by.

    Args:
        what: what is guarded, as it should appear in the error, for instance ``"the body 'Tank'"``.
    """

    def __init__(self, what: str) -> None:
        self._what = what
        self._thread = threading.current_thread()
        self._ident = threading.get_ident()

    def check(self, action: str) -> None:
        """Pass on the owner's thread, raise on any other.

        Args:
            action: what was about to be done, for instance ``"set_joint_positions"``.

        Raises:
            WrongThreadError: called on another thread than the one that made the guard.
        """
        if threading.get_ident() != self._ident:
            raise WrongThreadError(
                f"{action} was called on the thread {threading.current_thread().name!r}, but {self._what} belongs "
                f"to the thread {self._thread.name!r}. Post the call instead: call_later(f, message)."
            )
