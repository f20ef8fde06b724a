"""What the widgets with a page of their own have in common."""

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
    """Return the event loop of the notebook's kernel, which keeps a widget up to date. Main thread.

    Raises:
        TutorialError: no event loop runs.
    """
    try:
        return asyncio.get_running_loop()
    except RuntimeError:
        text = "a widget needs the event loop of the notebook's kernel, and none runs here. Make it in a cell."
        raise TutorialError(text) from None


def parse_message(content: object, kind: type[T]) -> T | None:
    """Read a message of a page; None for one that makes no sense. Any thread.

    Args:
        content: the message, as it arrived.
        kind: what it should be, a `msgspec.Struct`.
    """
    try:
        return msgspec.convert(content, kind)
    except msgspec.ValidationError:
        return None


class CellWidget(anywidget.AnyWidget):
    """A widget that can be ended and closed, both twice, and whose text is the same in every run.

    Attributes:
        ended: whether it is ended. What it showed last stays on the page, and the page says so.
        heard_at: when a view or a joystick said something last, of `time.monotonic` [s]; infinite before the first.
    """

    heard_at: ClassVar[float] = math.inf
    ended = traitlets.Bool(False).tag(sync=True)

    def __repr__(self) -> str:
        return f"{type(self).__name__}()"

    @staticmethod
    def page_is_gone() -> bool:
        """Whether no page was heard for over a minute: one that is hidden speaks once a minute. Any thread."""
        return time.monotonic() - CellWidget.heard_at > 70.0

    def end(self) -> None:
        """End what is behind the widget; what it showed last stays on the page. Idempotent, main thread."""
        self.ended = True

    def close(self) -> None:
        """End it, and take it off every page. Idempotent, main thread."""
        if self.comm is None:  # it is closed, or could not be made: Python closes that, too
            return
        self.end()
        layout = self.layout
        super().close()
        layout.close()

    def say(self, kind: str, buffers: list[bytes] | None = None, **fields: Any) -> None:
        """Send a message to every page that shows the widget. Main thread.

        Args:
            kind: what it is; ``type`` in the page's message.
            buffers: binary parts.
            fields: what else it says, as JSON.
        """
        if self.comm is not None:
            self.send({"type": kind, **fields}, buffers)


class NodeWidget(CellWidget):
    """A widget with a node of its own, whose callbacks run on a thread of their own."""

    _ros: NodeThread | None = None

    def open_node(self, name: str, set_up: Callable[[MeteredNode], object]) -> None:
        """Make the node, and what it publishes and subscribes to. If that fails, the widget is closed.

        Args:
            name: of the node.
            set_up: makes publishers, subscriptions and timers.
        """
        try:
            self._ros = NodeThread(name)
            set_up(self._ros.node)
        except BaseException:
            self.close()
            raise

    def end(self) -> None:
        """Take the node away; what was shown last stays. Idempotent, main thread."""
        if self._ros is not None:
            self._ros.close()
        super().end()
