"""Handing work from one thread to another: the first of the two ideas that the tutorial is about.

A callback runs on the thread of its source: ROS 2's executor, a widget or a timer. It must not use anything that
belongs to a different thread, so it hands over what it received and returns. There are two ways:

- as a *snapshot*, if only the newest value matters: `Latest` and `CallScope.call_latest`;
- as an *event*, if every value matters: `CallScope.call_later`.

A service callback needs a result: `RequestQueue.ask` has the simulation's thread call a function and returns the
function's result.
"""

from __future__ import annotations

import asyncio
import logging
import sys
import threading
import time
from collections import OrderedDict
from concurrent.futures import Future, wait
from dataclasses import dataclass, field
from functools import partial
from typing import TYPE_CHECKING, Any, Generic, TypeVar, TypeVarTuple

from tutorial.errors import RefusedError, WrongThreadError

if TYPE_CHECKING:
    from collections.abc import Callable, Hashable
    from types import CodeType

    from tutorial.trace import Handoff, HandoffTrace

T = TypeVar("T")
Ts = TypeVarTuple("Ts")

CROWD = 1000  # waiting calls; a warning is logged if there are more
LONG_WAIT = 10.0  # [s]; a warning is logged if a call waits longer
PATIENCE = 1.0  # [s] maximum time to wait for an answer; a step takes a few milliseconds
NOT_RUNNING = "the simulation is not running. Start it, and ask again."
BUSY = (
    "the main thread is too busy for the calls posted to it: %d waiting, the first for %.1f s. Do less in each call; "
    "if only the newest message matters, %s can post with call_latest(key, f, message)"
)

_log = logging.getLogger(__name__)


class Latest(Generic[T]):
    """A value guarded by a lock: one thread puts in the newest value, and other threads get it as often as they like.

    The value is not copied, so nobody may change it after `put`.

    Args:
        value: what `get` returns before the first `put`.
    """

    def __init__(self, value: T) -> None:
        self._lock = threading.Lock()
        self._value = value

    def put(self, value: T) -> None:
        """Replace the value. Thread-safe."""
        with self._lock:
            self._value = value

    def get(self) -> T:
        """Return the newest value. Thread-safe."""
        with self._lock:
            return self._value


class CallQueue:
    """Calls that any thread may post. The main thread's event loop runs them in the order they were posted.

    The first call in an empty queue requests a turn of the event loop with `call_soon_threadsafe`. A turn runs only the
    calls that were waiting when it began, so that calls that post calls cannot block the loop. A warning is logged once
    if many calls are waiting, or if one waits too long.

    Args:
        loop: the main thread's loop.
        trace: records when each call is posted and when it runs; None to record nothing.

    Attributes:
        error: the last error that a call raised (even SystemExit); None without errors.
    """

    def __init__(self, loop: asyncio.AbstractEventLoop, trace: HandoffTrace | None = None) -> None:
        self._loop = loop
        self._trace = trace
        self.error: BaseException | None = None
        self._lock = threading.Lock()
        self._waiting: OrderedDict[Hashable, _Call] = OrderedDict()
        self._turn_requested = False
        self._closed = False
        self._warned = False

    def __len__(self) -> int:
        """Return the number of waiting calls, including those that a closed scope has cancelled."""
        return len(self._waiting)

    def scope(self, owner: str) -> CallScope:
        """Return a scope for one poster, which the log calls `owner`. Closing the scope cancels only its own calls."""
        return CallScope(self, owner)

    def close(self) -> None:
        """Remove all waiting calls, and ignore calls posted from now on. Idempotent, any thread."""
        with self._lock:
            self._closed = True
            self._waiting.clear()

    def _post(self, call: _Call, key: Hashable) -> None:
        """Queue a call, or replace the call with the same key. Do nothing if the queue or the scope is closed."""
        with self._lock:
            if self._closed or call.scope.closed or not self._request_turn():
                return
            if self._trace is not None:
                call.handoff = self._trace.post()
            replaced = self._waiting.get(key)
            if replaced is not None:
                call.take_place_of(replaced)
            self._waiting[key] = call  # a new key is added at the end; an existing key keeps its place
        self._warn_if_busy()

    def _request_turn(self) -> bool:
        """Request a turn of the loop unless one is due. Return False if the loop is closed. Call with the lock held."""
        if not self._turn_requested:
            try:
                self._loop.call_soon_threadsafe(self._turn)
            except RuntimeError:  # the loop was closed before the queue
                return False
            self._turn_requested = True
        return True

    def _warn_if_busy(self) -> None:
        """Warn once if many calls are waiting, or if one has waited too long. Thread-safe."""
        with self._lock:
            if self._warned or not self._waiting:
                return
            count, first = len(self._waiting), next(iter(self._waiting.values()))
            waited = time.monotonic() - first.posted_at
            if count <= CROWD and waited <= LONG_WAIT:
                return
            self._warned = True
        _log.warning(BUSY, count, waited, first.scope.owner)

    def _turn(self) -> None:
        """Run the calls that are waiting now; calls posted in the meantime run in the next turn. Main thread only."""
        try:
            self._warn_if_busy()
            for _ in range(len(self._waiting)):
                if (call := self._next()) is None:  # the queue has been closed in the meantime
                    break
                call.run()
        finally:  # even after a KeyboardInterrupt, because a notebook's loop continues and the calls are still waiting
            with self._lock:
                self._turn_requested = False
                if self._waiting:
                    self._request_turn()

    def _next(self) -> _Call | None:
        with self._lock:
            return self._waiting.popitem(last=False)[1] if self._waiting else None


class CallScope:
    """One poster's access to a `CallQueue`.

    Attributes:
        queue: the queue.
        owner: the poster's name, for the log.
        closed: whether `close` was called.
    """

    def __init__(self, queue: CallQueue, owner: str) -> None:
        self.queue = queue
        self.owner = owner
        self.closed = False

    def call_later(self, function: Callable[[*Ts], object], /, *args: *Ts) -> None:
        """Have the main thread run ``function(*args)``. No call is lost or reordered. Thread-safe."""
        frame = sys._getframe(1)
        call = _Call(self, function, args, frame.f_code, frame.f_lineno)
        self.queue._post(call, call)  # the key is unique, so the call replaces no other call

    def call_latest(self, key: Hashable, function: Callable[[*Ts], object], /, *args: *Ts) -> None:
        """Post a call as `call_later` does, but replace a waiting call with the same key, such as a body's name."""
        frame = sys._getframe(1)
        self.queue._post(_Call(self, function, args, frame.f_code, frame.f_lineno), (self, key))

    def close(self) -> None:
        """Cancel the scope's waiting calls, and ignore calls posted from now on. Idempotent, any thread.

        A call that is already running continues, so only the main thread can be sure that nothing runs afterwards.
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
        """Replace an older call: take over its posting time, and mark it as superseded in the trace."""
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
        except (Exception, SystemExit) as error:  # noqa: BLE001 - the calls after it still have to run
            self.scope.queue.error = error
            posted = f"{self.frame_code.co_filename}:{self.frame_line} on the thread {self.thread!r}"
            _log.exception("%s: a call posted at %s failed", self.scope.owner, posted)


class RequestQueue:
    """Requests from callbacks to the simulation. Each callback waits for the answer.

    The thread that steps the simulation carries them out between two steps. So `ask` blocks the executor's thread only
    until the current step ends, usually for a few milliseconds, and never longer than its timeout. While the simulation
    is not running, and when it stops, requests are refused at once, so that no callback keeps waiting after a shutdown.

    A coroutine could await the answer instead, but with rclpy this has no advantage. While the coroutine is waiting,
    its callback group runs no other callbacks, either. The executor notices the answer only when something else wakes
    it, often 50 ms later. And a coroutine that is still waiting at shutdown is dropped, so its client never gets a
    response.
    """

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._waiting: list[tuple[Future[Any], Callable[[], object]]] = []
        self._thread: threading.Thread | None = None
        self._refusal = NOT_RUNNING

    def open(self, thread: threading.Thread) -> None:
        """Accept requests from now on. Thread-safe.

        Args:
            thread: the thread that will call `run_waiting`.
        """
        with self._lock:
            self._thread, self._refusal = thread, ""

    def close(self, reason: str = NOT_RUNNING) -> None:
        """Refuse the waiting requests, and all further requests until the next `open`. Idempotent, thread-safe.

        Args:
            reason: the text of the error that `ask` raises.
        """
        with self._lock:
            self._refusal = reason
            refused = self._waiting
            self._waiting = []
        for answer, _ in refused:
            if answer.set_running_or_notify_cancel():  # the caller has not given up
                answer.set_exception(RefusedError(reason))

    def ask(self, function: Callable[[*Ts], T], /, *args: *Ts, timeout: float = PATIENCE) -> T:
        """Have the simulation's thread run ``function(*args)`` between two steps, and return the result. Thread-safe.

        Args:
            function: the function.
            args: its arguments.
            timeout: the maximum time to wait [s].

        Raises:
            RefusedError: the function was not called, or did not return in time; the text says which of these happened.
            WrongThreadError: the caller is on the simulation's thread, so it would wait for itself.
            Exception: any exception that the function raised.
        """
        answer: Future[T] = Future()
        with self._lock:
            if self._refusal:
                raise RefusedError(self._refusal)
            if threading.current_thread() is self._thread:
                raise WrongThreadError("ask was called on the simulation's thread. Call the function directly.")
            self._waiting.append((answer, partial(function, *args)))
        wait([answer], timeout)
        # cancel() settles the race: it returns False if the simulation's thread has already started the request.
        if answer.cancel():  # the request will never be started
            raise RefusedError(f"the simulation did not finish its step within {timeout:g} s.")
        if not answer.done():
            raise RefusedError(f"the request was started, but did not finish within {timeout:g} s.")
        return answer.result()

    def run_waiting(self) -> None:
        """Carry out the requests that are waiting now.

        Call this only on the simulation's thread, between two steps. Requests that arrive in the meantime wait for the
        next call, so that callers cannot hold up the simulation.
        """
        with self._lock:
            requests = self._waiting
            self._waiting = []
        for answer, request in requests:
            if answer.set_running_or_notify_cancel():  # the caller has not given up
                try:
                    answer.set_result(request())
                except (Exception, SystemExit) as error:  # noqa: BLE001 - the caller of `ask` gets it
                    answer.set_exception(error)


class ThreadGuard:
    """Remembers the thread that made it and raises an error on every other thread.

    Args:
        what: the guarded object, as it should appear in the error message, for instance ``"the body 'Tank'"``.
    """

    def __init__(self, what: str) -> None:
        self._what = what
        self._thread = threading.current_thread()
        self._ident = threading.get_ident()

    def check(self, action: str) -> None:
        """Raise an error unless the calling thread is the owner.

        Args:
            action: the name of the guarded call, for instance ``"set_joint_positions"``.

        Raises:
            WrongThreadError: the calling thread did not create the guard.
        """
        if threading.get_ident() != self._ident:
            raise WrongThreadError(
                f"{action} was called on the thread {threading.current_thread().name!r}, but {self._what} belongs "
                f"to the thread {self._thread.name!r}. Post the call instead: call_later(f, message)."
            )
