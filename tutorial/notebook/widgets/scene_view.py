"""The 3D view in a cell: a scene, shown by meshcat's viewer over the notebook's own connection."""

from __future__ import annotations

import asyncio
import threading
from typing import Annotated

import msgspec
import traitlets

from tutorial.errors import TutorialError, running_loop
from tutorial.handoff import CallQueue
from tutorial.notebook.widgets.cell_widget import CellWidget, parse_message
from tutorial.view.assets import read_static, zipped_viewer
from tutorial.view.scene import Record, Scene, pack_record, unpack_command, unpack_records

__all__ = ["SceneView"]

FRAMES_AHEAD = 60
"""How many frames a page may be behind before it is taken to be gone. Jupyter keeps for a closed page what is sent."""

FRAME = 1 / 40  # [s] between two messages at the least; a program draws 30 frames a second
LONGEST_ID = 64

NO_LOOP = (
    "a 3D view in a cell needs the event loop of the notebook's kernel, and none runs here. Make it in a "
    "notebook; a script shows a scene with SceneServer."
)


class _Words(msgspec.Struct):
    """What a page says."""

    type: str
    view: Annotated[str, msgspec.Meta(max_length=LONGEST_ID)]
    frame: int = 0


class SceneView(CellWidget):
    """Shows a scene in a notebook's cell, as often as it is displayed, on every page that has the notebook open.

    Make it in a cell, on the main thread: it belongs to the thread of the scene. A page that comes to look is answered
    when that thread is free; those who look already see at once what a busy cell flushes.

    Args:
        scene: what to show.
        title: what a screen reader says it is.
        height: of the picture, in pixels of the page.

    Raises:
        TutorialError: no event loop runs, or the height is not positive.
        WrongThreadError: made on another thread than the scene's.
    """

    _esm = read_static("make.js", "cell.js", "scene.js", "viewer.js", "scene_view.js")
    _css = read_static("scene_view.css", "readings.css")
    title = traitlets.Unicode().tag(sync=True)
    height = traitlets.Int().tag(sync=True)

    def __init__(self, scene: Scene, title: str = "Tank", height: int = 420) -> None:
        if height <= 0:
            raise TutorialError(f"a 3D view cannot be {height} pixels high. Give a height such as 420.")
        self._scene = scene
        self._loop = running_loop(NO_LOOP)
        self._calls = CallQueue(self._loop)
        self._audience = _Audience()
        self._waiting: list[bytes] = []
        self._timer: asyncio.TimerHandle | None = None
        self._next_at = 0.0
        scene.attach(self._show)
        super().__init__(title=title, height=height)
        self._scope = self._calls.scope(repr(self))
        self.on_msg(self._on_message)

    def __repr__(self) -> str:
        return f"{type(self).__name__}({self.title!r})"

    @property
    def scene(self) -> Scene:
        """What it shows."""
        return self._scene

    @property
    def views(self) -> int:
        """How many views of it are on pages that keep up."""
        return len(self._audience)

    def end(self) -> None:
        """Show no more of what the scene becomes; the last picture stays on the page, also on one that comes later.

        Idempotent.

        Raises:
            WrongThreadError: called on another thread than the scene's.
        """
        self._scene.detach(self._show)
        if self._timer is not None:
            self._send_frame()
        super().end()

    def close(self) -> None:
        """Take the view off every page, and let the scene go. Idempotent.

        Raises:
            WrongThreadError: called on another thread than the scene's.
        """
        if self.comm is not None:
            self._scene.detach(self._show)
            self._calls.close()
            self._cancel_timer()
        super().close()

    def _on_message(self, _widget: object, content: object, _buffers: object) -> None:
        """Take what a page says: on whatever thread, so what touches the scene is posted."""
        match parse_message(content, _Words):
            case _Words(type="library"):
                self._scope.call_latest("library", lambda: self.say("library", [zipped_viewer()]))
            case _Words(type="hello", view=view):
                self._scope.call_latest(("hello", view), self._welcome, view)
            case _Words(type="seen", view=view, frame=frame) if not self._audience.note(view, frame):
                self._scope.call_latest(("hello", view), self._welcome, view)  # taken to be gone, it has missed frames
            case _Words(type="bye", view=view):
                self._audience.leave(view)

    def _welcome(self, view: str) -> None:
        """Show the whole scene to one view, and from now on all that changes."""
        self._audience.join(view)
        self.say("scene", [self._scene.snapshot()], view=view, frame=self._audience.frame)

    def _show(self, message: bytes) -> None:
        """Send one frame; if the last one was only just sent, soon. Main thread: the scene calls it in `flush`."""
        if not len(self._audience):
            return
        self._waiting.append(message)
        if len(self._waiting) > FRAMES_AHEAD:  # nothing grows, however often a scene is flushed
            self._waiting = [_merged(self._waiting)]
        if self._loop.time() >= self._next_at:
            self._send_frame()
        elif self._timer is None:
            self._timer = self._loop.call_at(self._next_at, self._send_frame)

    def _send_frame(self) -> None:
        self._cancel_timer()
        self._next_at = self._loop.time() + FRAME
        messages, self._waiting = self._waiting, []
        if self._audience.next_frame():
            self.say("frame", [_merged(messages)], frame=self._audience.frame)

    def _cancel_timer(self) -> None:
        if self._timer is not None:
            self._timer.cancel()
            self._timer = None


class _Audience:
    """The views on all pages, and the last frame that each has seen; one that is too far behind is dropped. Any thread.

    Attributes:
        frame: the number of the last frame that was sent.
    """

    def __init__(self) -> None:
        self.frame = 0
        self._lock = threading.Lock()
        self._seen: dict[str, int] = {}

    def __len__(self) -> int:
        return len(self._seen)

    def join(self, view: str) -> None:
        with self._lock:
            self._seen[view] = self.frame

    def leave(self, view: str) -> None:
        with self._lock:
            self._seen.pop(view, None)

    def note(self, view: str, frame: int) -> bool:
        """Note what a view has seen; False when it was dropped, or never joined."""
        with self._lock:
            if view not in self._seen:
                return False
            self._seen[view] = max(self._seen[view], min(frame, self.frame))
            return True

    def next_frame(self) -> bool:
        """Drop the views that are too far behind; if any are left, count one more frame."""
        with self._lock:
            oldest = self.frame - FRAMES_AHEAD
            self._seen = {view: frame for view, frame in self._seen.items() if frame > oldest}
            self.frame += bool(self._seen)
            return bool(self._seen)


def _merged(messages: list[bytes]) -> bytes:
    """Make one message of several, in which of each body's poses only the last one is left."""
    if len(messages) == 1:
        return messages[0]
    merged: dict[object, bytes] = {}
    for number, (kind, payload) in enumerate(unpack_records(b"".join(messages))):
        key = _subject(kind, payload) or number
        merged.pop(key, None)
        merged[key] = pack_record(kind, payload)
    return b"".join(merged.values())


def _subject(kind: Record, payload: bytes) -> object:
    """What a record sets, so that of several only the last one counts; None for one that has to stay."""
    if kind is not Record.COMMAND:
        return kind.name
    command = unpack_command(payload)
    return command["path"] if command["type"] == "set_transform" else None
