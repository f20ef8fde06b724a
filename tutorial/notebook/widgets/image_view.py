"""The pictures of a topic in a cell, as ``rqt_image_view`` shows them."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from typing import Any

import numpy as np
from rclpy.qos import QoSProfile, ReliabilityPolicy
from sensor_msgs.msg import Image

from tutorial.errors import printable
from tutorial.notebook.widgets.cell_widget import NodeWidget
from tutorial.notebook.widgets.frame_widget import FrameWidget
from tutorial.view.assets import read_static

__all__ = ["Frame", "ImageView"]

CHANNELS = {"rgb8": 3, "bgr8": 3, "mono8": 1}  # what is shown, with the bytes of a pixel
LARGEST = 1920 * 1080  # [pixels]


@dataclass(frozen=True)
class Frame:
    """A picture, as it is sent to a page.

    Attributes:
        line: what stands below it.
        pixels: the bytes, row by row from the top, nothing between them; none where there is nothing to show.
        width, height: of the picture [px].
        encoding: what a pixel is, such as ``"rgb8"``.
    """

    line: str
    pixels: bytes = b""
    width: int = 0
    height: int = 0
    encoding: str = ""


class ImageView(FrameWidget, NodeWidget):
    """Shows the newest picture of a topic. Make it on the main thread, while its loop runs.

    It has a node of its own, ``image_view``, and takes what comes best effort, one at a time. A page is sent the next
    picture when it has drawn the last one, so a slow page misses pictures, and nothing piles up.

    Args:
        topic: of type ``sensor_msgs/msg/Image``.

    Attributes:
        newest: what is shown.

    Raises:
        TutorialError: no event loop runs.
    """

    AHEAD = 1
    _esm = read_static("make.js", "cell.js", "image_view.js")
    _css = read_static("image_view.css")

    def __init__(self, topic: str = "/Tank/camera/image") -> None:
        super().__init__(topic)
        self.newest = Frame(f"nothing has come on {topic} yet")
        qos = QoSProfile(depth=1, reliability=ReliabilityPolicy.BEST_EFFORT)  # fits every publisher
        self.open_node("image_view", lambda node: node.create_subscription(Image, topic, self._on_image, qos))

    def whole(self) -> tuple[bytes, dict[str, Any]]:
        """The newest picture."""
        fields = asdict(self.newest)
        return fields.pop("pixels"), fields

    def _on_image(self, message: Image) -> None:
        """Take a picture, on the executor's thread."""
        self.calls.call_latest("image", self._show, _frame(message))

    def _show(self, frame: Frame) -> None:
        """Keep the newest picture, and send it to those who have drawn the last one. Main thread."""
        self.newest = frame
        content, fields = self.whole()
        self.send_frame(content, **fields)


def _frame(message: Image) -> Frame:
    """Take a picture out of a message, or say why it is none that can be shown."""
    width, height, step, encoding = message.width, message.height, message.step, message.encoding
    if encoding not in CHANNELS:
        return Frame(f"the encoding {printable(encoding[:20])!r} is not shown here, only {', '.join(CHANNELS)}")
    row = CHANNELS[encoding] * width
    if not 0 < width * height <= LARGEST:
        return Frame(f"a picture of {width} x {height} pixels is not shown here")
    size, pixels = len(message.data), f"{width} pixels of {encoding}"
    if step < row or size < step * height:
        return Frame(f"no picture: {size} bytes for {height} rows of {step}, with {pixels}")
    rows = np.frombuffer(message.data, np.uint8, step * height).reshape(height, step)
    stamp = message.header.stamp.sec + message.header.stamp.nanosec / 1e9
    line = f"{width} x {height}, {encoding}, {step * height / 1000:.1f} kB, at {stamp:.3f} s"
    return Frame(line, rows[:, :row].tobytes(), width, height, encoding)
