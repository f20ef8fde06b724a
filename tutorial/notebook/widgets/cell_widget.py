"""What the widgets with a page of their own have in common."""

from __future__ import annotations

from typing import Any, TypeVar

import anywidget
import msgspec
import traitlets

__all__ = ["CellWidget", "parse_message"]

T = TypeVar("T")


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
        ended: whether what is behind it has gone. What it showed last stays on the page, and the page says so.
    """

    ended = traitlets.Bool(False).tag(sync=True)

    def __repr__(self) -> str:
        return f"{type(self).__name__}()"

    def end(self) -> None:
        """End what is behind the widget; what it showed last stays on the page. Idempotent, main thread."""
        self.ended = True

    def close(self) -> None:
        """Take the widget off every page. Idempotent, main thread."""
        layout = self.layout if self.comm is not None else None
        super().close()
        if layout is not None:
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
