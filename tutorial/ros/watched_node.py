"""A node that records when its callbacks run, and that can find and end deadlocks among them.

This module requires a real ROS 2, because the pocket ROS 2 has no services.
"""

from __future__ import annotations

import inspect
import re
import threading
import time
import types
from collections import deque
from collections.abc import Callable, Generator, Iterator
from contextlib import contextmanager, nullcontext
from dataclasses import dataclass, field
from functools import partial, wraps
from typing import Any

from rclpy.executors import SingleThreadedExecutor

from tutorial.errors import TutorialError
from tutorial.ros.node_thread import MeteredNode

KEPT = 2000  # number of spans to keep per node: the newest ones

Callback = Callable[..., Any]


class DeadlockError(TutorialError):
    """A callback waited for a response that nobody could receive."""


@dataclass(eq=False)
class Span:
    """A period during which a callback runs or waits.

    Attributes:
        label: the callback's name.
        group: the callback's group.
        kind: ``"runs"``, ``"call()"`` while its thread waits in `call`, or ``"await"`` while it awaits a response.
        thread: the thread's name.
        client, future: the client that sent the callback's last request, and the future for the response; both are None
            if the callback has sent no request.
        began, ended: from `time.perf_counter` [s]; `ended` is None until the span ends.
    """

    label: str
    group: Any
    kind: str = "runs"
    client: Any = None
    future: Any = None
    thread: str = field(default_factory=lambda: re.sub(r"ThreadPool.*_", "worker ", threading.current_thread().name))
    began: float = field(default_factory=time.perf_counter)
    ended: float | None = None


class WatchedNode(MeteredNode):
    """A node that records its callbacks, but otherwise behaves like an ordinary rclpy node.

    Attributes:
        spans: the newest spans, in the order they began.
        ended: descriptions of the deadlocks that `end_deadlocks` has ended.
    """

    def __init__(self, *args: Any, **kwargs: Any) -> None:
        self.spans: deque[Span] = deque(maxlen=KEPT)
        self.ended: list[str] = []
        self._running = threading.local()
        super().__init__(*args, **kwargs)

    def create_service(self, srv_type: type, srv_name: str, callback: Callback, **kwargs: Any) -> Any:
        """Create a service, as rclpy does, and record its callback."""
        recorded = self._recorded(callback, **kwargs)
        return super().create_service(srv_type, srv_name, recorded, **kwargs)  # type: ignore[misc]

    def create_timer(self, timer_period_sec: float, callback: Callback, *args: Any, **kwargs: Any) -> Any:
        """Create a timer, as rclpy does, and record its callback."""
        return super().create_timer(timer_period_sec, self._recorded(callback, **kwargs), *args, **kwargs)

    def create_subscription(self, msg_type: type, topic: str, callback: Callback, *args: Any, **kwargs: Any) -> Any:
        """Create a subscription, as rclpy does, and record its callback."""
        return super().create_subscription(msg_type, topic, self._recorded(callback, **kwargs), *args, **kwargs)

    def create_client(self, srv_type: type, srv_name: str, **kwargs: Any) -> Any:
        """Create a client, as rclpy does, and record its calls and the callbacks of its futures."""
        client: Any = super().create_client(srv_type, srv_name, **kwargs)  # type: ignore[misc]
        client.call_async = partial(self._call_async, client, client.call_async)
        client.call = partial(self._call, client.call)
        return client

    def deadlocks(self) -> dict[Span, str]:
        """Return the spans that wait for a response that nobody can receive, each with the reason."""
        waits = [span for span in [*self.spans] if span.kind != "runs" and span.ended is None and span.future]
        return {span: text for span in waits if (text := self._explain(span))}

    def end_deadlocks(self) -> None:
        """Raise a `DeadlockError` in each callback that waits for a response that nobody can receive. Thread-safe."""
        for wait, text in self.deadlocks().items():
            self.ended.append(text)
            wait.future.set_exception(DeadlockError(text))

    def _explain(self, wait: Span) -> str:
        """Explain why nobody can receive the response that a callback waits for; return "" if it can be received."""
        group, doing = wait.client.callback_group, {"call()": "waits in call() for"}.get(wait.kind, "awaits")
        waits = f"{wait.label} {doing} the response of {wait.client.srv_name}"
        if wait.kind == "call()" and isinstance(self.executor, SingleThreadedExecutor):
            return f"{waits}, on the thread {wait.thread!r}. Only this thread can receive the response."
        if group is wait.group and not group.can_execute(wait.client):
            return (
                f"{waits}. Nobody can receive the response: {wait.label} occupies the client's callback group until it "
                "returns."
            )
        return ""

    def _recorded(self, callback: Callback, callback_group: Any = None, **_: Any) -> Callback:
        """Wrap a callback so that its spans are recorded. rclpy's own callbacks are returned unchanged."""
        if (getattr(callback, "__module__", None) or "").startswith("rclpy."):
            return callback
        span = partial(Span, getattr(callback, "__name__", "callback"), callback_group or self.default_callback_group)

        @wraps(callback)
        async def steps(*args: Any) -> Any:
            return await self._steps(span, callback(*args))

        @wraps(callback)
        def run(*args: Any) -> Any:
            with self._span(span()):
                return callback(*args)

        return steps if inspect.iscoroutinefunction(callback) else run

    @types.coroutine
    def _steps(self, span: Callable[..., Span], coroutine: Any) -> Generator[Any, Any, Any]:
        """Run a coroutine; record its steps, and how long it awaits responses between them.

        While the coroutine awaits a response, the executor resumes it again and again. These steps are not recorded.
        """
        wait: Span | None = None
        while True:
            if wait is not None and wait.future.done():
                wait.ended, wait = time.perf_counter(), None
            step = span()
            with nullcontext() if wait else self._span(step):
                try:
                    yielded = coroutine.send(None)
                except StopIteration as end:
                    return end.value
            if wait is None and step.future is not None:
                wait = span(kind="await", client=step.client, future=step.future)
                self.spans.append(wait)
            yield yielded

    def _call(self, call: Callback, request: Any, timeout_sec: float | None = None) -> Any:
        inside: Span | None = getattr(self._running, "span", None)
        wait = nullcontext() if inside is None else self._span(Span(inside.label, inside.group, "call()"))
        with wait:
            return call(request, timeout_sec)

    def _call_async(self, client: Any, call_async: Callback, request: Any) -> Any:
        future = call_async(request)
        add, inside = future.add_done_callback, getattr(self._running, "span", None)
        future.add_done_callback = lambda callback: add(self._recorded(callback))
        if inside is not None:
            inside.client, inside.future = client, future
        return future

    @contextmanager
    def _span(self, span: Span) -> Iterator[None]:
        outer = getattr(self._running, "span", None)
        self._running.span = span
        self.spans.append(span)
        try:
            yield
        finally:
            span.ended = time.perf_counter()
            self._running.span = outer
