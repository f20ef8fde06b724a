"""A widget that sends frames to the pages that show it, and the one protocol that they keep.

A view on a page says ``hello``, and is sent the ``whole``: all that there is to see. After that every view is sent each
``frame``, which has a number, and says which one it has ``seen``. A view that is too far behind, because its page is
slow, asleep or closed, is not sent for any more. When it says that it has seen a frame, it is sent the whole again.
Once a minute it says that it is still ``here``, also if there is no frame to see.
"""

import threading
import time
from typing import Any, ClassVar

import msgspec
import traitlets

from tutorial.handoff import CallQueue
from tutorial.notebook.widgets.cell_widget import CellWidget, kernel_loop, parse_message

Frame = tuple[bytes, dict[str, Any]]
"""What there is to see, binary, and what else there is to say of it, as JSON."""


class _Words(msgspec.Struct):
    """What a page says."""

    type: str
    view: str
    frame: int = 0


class FrameWidget(CellWidget):
    """Sends frames to every view that keeps up. Make it on the main thread, while its loop runs.

    Args:
        title: what it shows, also for its ``repr``.

    Attributes:
        AHEAD: how many frames may be on their way to a view.
        calls: what callbacks of any thread post with.
        frame: the number of the last frame that was sent.

    Raises:
        TutorialError: no event loop runs.
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
        """All that there is to see. Main thread."""
        raise NotImplementedError

    def send_frame(self, content: bytes, **fields: Any) -> bool:
        """Send a frame, if there is a view that keeps up; return whether there is. Main thread.

        Args:
            content: binary.
            fields: what else there is to say of it, as JSON.
        """
        with self._lock:
            self._seen = {view: seen for view, seen in self._seen.items() if self.frame - seen < self.AHEAD}
            if not self._seen:
                return False
            self.frame += 1
        self.say("frame", [content], frame=self.frame, **fields)
        return True

    def _on_message(self, _widget: object, content: object, _buffers: object) -> None:
        """Take what a page says: on whatever thread, so what belongs to the main thread is posted."""
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
        """Note what a view has seen; False for one that is not sent for, and has missed frames."""
        with self._lock:
            if view in self._seen:
                self._seen[view] = frame
            return view in self._seen

    def _welcome(self, view: str) -> None:
        """Send one view the whole, which it has yet to see, and from now on each frame. Main thread."""
        content, fields = self.whole()
        with self._lock:
            self._seen[view] = self.frame - 1
        self.say("whole", [content], view=view, frame=self.frame, **fields)
