"""Base classes for the widgets that have their own JavaScript."""

import asyncio
import math
import time
from collections.abc import Callable
from typing import Any, ClassVar, TypeVar

import anywidget
import msgspec
import traitlets

from tutorial.errors import TutorialError
from tutorial.ros.node_thread import MeteredNode, NodeThread

T = TypeVar("T")


def kernel_loop() -> asyncio.AbstractEventLoop:
    """Return the event loop of the notebook's kernel, which updates the widgets. Main thread only.

    Raises:
        TutorialError: no event loop is running.
    """
    try:
        return asyncio.get_running_loop()
    except RuntimeError:
        text = (
            "a widget needs the event loop of the notebook's kernel, but none is running here. "
            "Create the widget in a cell."
        )
        raise TutorialError(text) from None


def parse_message(content: object, kind: type[T]) -> T | None:
    """Parse a message from a page; return None if it is invalid. Thread-safe.

    Args:
        content: the message as received.
        kind: the expected type, a `msgspec.Struct`.
    """
    try:
        return msgspec.convert(content, kind)
    except msgspec.ValidationError:
        return None


class CellWidget(anywidget.AnyWidget):
    """A widget whose `end` and `close` are idempotent, and whose ``repr`` is the same in every run.

    Attributes:
        ended: whether the widget has ended. An ended widget continues to show its last content, marked as the last.
        heard_at: `time.monotonic` [s] when a view or joystick last sent a message; infinite before the first message.
    """

    heard_at: ClassVar[float] = math.inf
    ended = traitlets.Bool(False).tag(sync=True)

    def __repr__(self) -> str:
        return f"{type(self).__name__}()"

    @staticmethod
    def page_is_gone() -> bool:
        """Return whether no page, not even a hidden one, has sent anything for over a minute. Thread-safe."""
        return time.monotonic() - CellWidget.heard_at > 70.0

    def end(self) -> None:
        """Stop updating the widget, which continues to show its last content. Idempotent; main thread only."""
        self.ended = True

    def close(self) -> None:
        """End the widget, and remove it from every page. Idempotent; main thread only."""
        if self.comm is None:  # already closed, or its creation failed: Python calls close() even then
            return
        self.end()
        layout = self.layout
        super().close()
        layout.close()

    def say(self, kind: str, buffers: list[bytes] | None = None, **fields: Any) -> None:
        """Send a message to every page that shows the widget. Main thread only.

        Args:
            kind: the message's ``type``.
            buffers: binary parts.
            fields: the other fields, which are sent as JSON.
        """
        if self.comm is not None:
            self.send({"type": kind, **fields}, buffers)


class NodeWidget(CellWidget):
    """A widget with its own node, whose callbacks run on a separate thread."""

    _ros: NodeThread | None = None

    def open_node(self, name: str, set_up: Callable[[MeteredNode], object]) -> None:
        """Make the node, its publishers and its subscriptions. If that fails, close the widget.

        Args:
            name: the node's name.
            set_up: a function that makes the node's publishers, subscriptions and timers.
        """
        try:
            self._ros = NodeThread(name)
            set_up(self._ros.node)
        except BaseException:
            self.close()
            raise

    def end(self) -> None:
        """Destroy the node. The widget continues to show its last content. Idempotent; main thread only."""
        if self._ros is not None:
            self._ros.close()
        super().end()
