"""The pictures of a topic in a cell, as ``rqt_image_view`` shows them."""

from __future__ import annotations

import asyncio
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Annotated

import msgspec
import numpy as np
import traitlets
from rclpy.qos import QoSProfile, ReliabilityPolicy
from sensor_msgs.msg import Image

from tutorial.errors import printable, running_loop
from tutorial.handoff import CallQueue
from tutorial.notebook.widgets.cell_widget import CellWidget, parse_message
from tutorial.ros.node_thread import NodeThread
from tutorial.view.assets import read_static

__all__ = ["Frame", "ImageView"]

CHANNELS = {"rgb8": 3, "bgr8": 3, "mono8": 1}  # what is shown, with the bytes of a pixel
LARGEST = 1920 * 1080  # [pixels]
PATIENCE = 2.0  # [s] that a page may take for a picture before the others go on without it
MOST_VIEWS = 16  # on all pages; one more is not shown anything
LONGEST_ID = 64
NO_LOOP = "a view of pictures is drawn by an event loop, and none runs here. Make it in a cell."


class _Words(msgspec.Struct):
    """What a page says."""

    type: str
    view: Annotated[str, msgspec.Meta(max_length=LONGEST_ID)]
    frame: int = 0


@dataclass(frozen=True)
class Frame:
    """A picture, as it is sent to a page.

    Attributes:
        pixels: the bytes, row by row from the top, nothing between them.
        width, height: of the picture [px].
        encoding: what a pixel is, such as ``"rgb8"``.
        line: what stands below it.
    """

    pixels: bytes
    width: int
    height: int
    encoding: str
    line: str


class ImageView(CellWidget):
    """Shows the newest picture of a topic. Make it on the main thread, while its loop runs.

    It has a node of its own, ``image_view``, and takes what comes best effort, one at a time. The next picture goes to
    the pages when all have drawn the last one, so who is slow misses pictures, and nothing piles up.

    Args:
        topic: of type ``sensor_msgs/msg/Image``.
        ros_args: command line arguments, of which ROS 2 takes those after ``--ros-args``.

    Attributes:
        newest: the newest picture; None before the first.
        ignored: how many messages were no pictures that can be shown.

    Raises:
        TutorialError: no event loop runs.
    """

    _esm = read_static("make.js", "cell.js", "image_view.js")
    _css = read_static("image_view.css")
    title = traitlets.Unicode().tag(sync=True)
    line = traitlets.Unicode().tag(sync=True)
    _calls: CallQueue | None = None  # also in a view whose making failed: Python closes it
    _ros: NodeThread | None = None

    def __init__(self, topic: str = "/Tank/camera/image", ros_args: Sequence[str] | None = None) -> None:
        self._loop = running_loop(NO_LOOP)
        super().__init__(title=topic, line=f"nothing has come on {topic} yet")
        self.ignored = 0
        self.newest: Frame | None = None
        self._number = 0  # of the last frame that was sent
        self._is_newer = False  # a frame has come since
        self._views: set[str] = set()
        self._awaited: set[str] = set()  # those that have not drawn the last one yet
        self._timer: asyncio.TimerHandle | None = None
        self._calls = CallQueue(self._loop)
        self._scope = self._calls.scope(repr(self))
        self.on_msg(self._on_message)
        try:
            self._ros = NodeThread("image_view", ros_args)
            qos = QoSProfile(depth=1, reliability=ReliabilityPolicy.BEST_EFFORT)  # fits every publisher
            self._ros.node.create_subscription(Image, topic, self._on_image, qos)
        except BaseException:
            self.close()
            raise

    def __repr__(self) -> str:
        return f"{type(self).__name__}({self.title!r})"

    def end(self) -> None:
        """Take the node away; the last picture stays, also on a page that comes later. Idempotent, main thread."""
        if self._ros is not None:
            self._ros.close()
        super().end()

    def close(self) -> None:
        """Take the view off every page, and its node away. Idempotent, main thread."""
        self.end()
        if self._calls is not None:
            self._calls.close()
            self._cancel_timer()
        super().close()

    def _on_image(self, message: Image) -> None:
        """Take a picture, on the executor's thread."""
        frame = _frame(message)
        self._scope.call_latest("image", self._take, frame)

    def _take(self, frame: Frame | str) -> None:
        """Keep the newest picture, and send it when the pages have drawn the last one. Main thread."""
        if isinstance(frame, str):
            self.ignored += 1
            if self.ignored == 1:
                self.line = frame
            return
        self.newest, self._is_newer = frame, True
        if not self._awaited:
            self._send_frame()

    def _on_message(self, _widget: object, content: object, _buffers: object) -> None:
        """Take what a page says: on whatever thread, so what belongs to the main thread is posted."""
        match parse_message(content, _Words):
            case _Words(type="hello", view=view):
                self._scope.call_latest(("hello", view), self._welcome, view)
            case _Words(type="drawn", view=view, frame=frame):
                self._scope.call_latest(("drawn", view), self._drawn, view, frame)
            case _Words(type="bye", view=view):
                self._scope.call_latest(("bye", view), self._leave, view)

    def _welcome(self, view: str) -> None:
        if len(self._views) >= MOST_VIEWS and view not in self._views:
            return
        self._views.add(view)
        self._is_newer = self.newest is not None  # to this one, at least
        if self._is_newer and not self._awaited:
            self._send_frame()

    def _drawn(self, view: str, frame: int) -> None:
        if frame == self._number:
            self._awaited.discard(view)
        if view not in self._views:  # it was too slow, and is there again
            self._welcome(view)
        elif not self._awaited and self._is_newer:
            self._send_frame()

    def _leave(self, view: str) -> None:
        self._views.discard(view)
        self._awaited.discard(view)
        if not self._awaited and self._is_newer:
            self._send_frame()

    def _send_frame(self) -> None:
        """Send the newest picture to every page. Main thread."""
        self._cancel_timer()
        if self.newest is None or not self._views:
            return
        self._number += 1
        self._is_newer = False
        self._awaited = set(self._views)
        self._timer = self._loop.call_later(PATIENCE, self._give_up)
        f = self.newest
        size = {"width": f.width, "height": f.height, "encoding": f.encoding}
        self.say("frame", [f.pixels], frame=self._number, line=f.line, **size)

    def _give_up(self) -> None:
        """Go on without the pages that have not drawn the last picture; one that does so later is there again."""
        self._views -= self._awaited
        self._awaited.clear()
        if self._is_newer:
            self._send_frame()

    def _cancel_timer(self) -> None:
        if self._timer is not None:
            self._timer.cancel()
            self._timer = None


def _frame(message: Image) -> Frame | str:
    """Take a picture out of a message, or say why it is none that can be shown."""
    width, height, step, encoding = message.width, message.height, message.step, message.encoding
    if encoding not in CHANNELS:
        return f"the encoding {printable(encoding[:20])!r} is not shown here, only {', '.join(CHANNELS)}"
    row = CHANNELS[encoding] * width
    if not 0 < width * height <= LARGEST:
        return f"a picture of {width} x {height} pixels is not shown here"
    if step < row or len(message.data) < step * height:
        return f"no picture: {len(message.data)} bytes for {height} rows of {step}, with {width} pixels of {encoding}"
    rows = np.frombuffer(message.data, np.uint8, step * height).reshape(height, step)
    stamp = message.header.stamp.sec + message.header.stamp.nanosec / 1e9
    line = f"{width} x {height}, {encoding}, {step * height / 1000:.1f} kB, at {stamp:.3f} s"
    return Frame(rows[:, :row].tobytes(), width, height, encoding, line)
