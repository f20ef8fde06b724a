"""A widget that sends frames to its views on pages, and the protocol between the widget and its views.

A view sends ``hello`` and receives the ``whole`` content. From then on, the view receives every numbered ``frame`` and
reports the last frame that it has ``seen``. A view falls behind if its page is slow, asleep or closed; when all views
are too far behind, the widget stops sending frames. Once a view that was too far behind reports a frame as seen, it
receives the whole content again. A view also sends ``here`` once a minute, even if it receives no frames.
"""

import threading
import time
from typing import Any, ClassVar

import msgspec
import traitlets

from tutorial.handoff import CallQueue
from tutorial.notebook.widgets.cell_widget import CellWidget, kernel_loop, parse_message

Frame = tuple[bytes, dict[str, Any]]
"""The binary content of a frame, and the frame's other fields, which are sent as JSON."""


class _Words(msgspec.Struct):
    """A message from a page."""

    type: str
    view: str
    frame: int = 0


class FrameWidget(CellWidget):
    """Sends frames to every view that keeps up.

    Create the widget on the main thread while the kernel's event loop is running.

    Args:
        title: the title of the content, also used in the ``repr``.

    Attributes:
        AHEAD: the maximum number of frames that a view may lag behind.
        calls: the queue that callbacks on any thread post to.
        frame: the number of the last frame sent.

    Raises:
        TutorialError: no event loop is running.
    """

    AHEAD: ClassVar[int]
    title = traitlets.Unicode().tag(sync=True)

    def __init__(self, title: str) -> None:
        self.calls = CallQueue(kernel_loop()).scope(title)
        self.frame = 0
        self._lock = threading.Lock()
        self._seen: dict[str, int] = {}  # the last frame that each view has seen
        super().__init__(title=title)
        self.on_msg(self._on_message)

    def __repr__(self) -> str:
        return f"{type(self).__name__}({self.title!r})"

    def whole(self) -> Frame:
        """Return the whole content. Main thread only."""
        raise NotImplementedError

    def send_frame(self, content: bytes, **fields: Any) -> bool:
        """Send a frame and return True, or return False if no view keeps up. Main thread only.

        Args:
            content: the binary content.
            fields: the other fields, which are sent as JSON.
        """
        with self._lock:
            self._seen = {view: seen for view, seen in self._seen.items() if self.frame - seen < self.AHEAD}
            if not self._seen:
                return False
            self.frame += 1
        self.say("frame", [content], frame=self.frame, **fields)
        return True

    def _on_message(self, _widget: object, content: object, _buffers: object) -> None:
        """Handle a page's message. Messages can arrive on any thread, so this method posts work to the main thread."""
        CellWidget.heard_at = time.monotonic()
        match parse_message(content, _Words):
            case _Words(type="hello", view=view):
                self.calls.call_latest(("hello", view), self._welcome, view)
            case _Words(type="seen", view=view, frame=frame) if not self._note(view, frame):
                self.calls.call_latest(("hello", view), self._welcome, view)
            case _Words(type="bye", view=view):
                with self._lock:
                    self._seen.pop(view, None)

    def _note(self, view: str, frame: int) -> bool:
        """Record the last frame that a view has seen; return False if the view had fallen too far behind."""
        with self._lock:
            if view in self._seen:
                self._seen[view] = frame
            return view in self._seen

    def _welcome(self, view: str) -> None:
        """Send one view the whole content, and regard the view as up to date. Main thread only."""
        content, fields = self.whole()
        with self._lock:
            self._seen[view] = self.frame - 1
        self.say("whole", [content], view=view, frame=self.frame, **fields)
