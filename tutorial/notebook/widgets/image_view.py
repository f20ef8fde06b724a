"""The pictures of a topic in a cell, as ``rqt_image_view`` shows them."""

from __future__ import annotations

import numpy as np
from rclpy.qos import QoSProfile, ReliabilityPolicy
from sensor_msgs.msg import Image

from tutorial.errors import printable
from tutorial.notebook.widgets.cell_widget import NodeWidget
from tutorial.notebook.widgets.frame_widget import Frame, FrameWidget
from tutorial.view.assets import read_static

__all__ = ["ImageView"]

CHANNELS = {"rgb8": 3, "bgr8": 3, "mono8": 1}  # what is shown, with the bytes of a pixel
LARGEST = 1920 * 1080  # [pixels]


class ImageView(FrameWidget, NodeWidget):
    """Shows the newest picture of a topic. Make it on the main thread, while its loop runs.

    It has a node of its own, ``image_view``, and takes what comes best effort, one at a time. A page is sent the next
    picture when it has drawn the last one, so a slow page misses pictures, and nothing piles up.

    Args:
        topic: of type ``sensor_msgs/msg/Image``.

    Attributes:
        newest: what is shown. The content is the bytes of the picture, row by row from the top, nothing between them;
            the fields are its ``width`` and ``height`` [px], the ``encoding`` of a pixel, and the ``line`` below it.
            Where there is no picture, there is only the line.

    Raises:
        TutorialError: no event loop runs.
    """

    AHEAD = 1
    _esm = read_static("make.js", "cell.js", "image_view.js")
    _css = read_static("image_view.css")

    def __init__(self, topic: str = "/Tank/camera/image") -> None:
        super().__init__(topic)
        self.newest = _no_picture(f"nothing has come on {topic} yet")
        qos = QoSProfile(depth=1, reliability=ReliabilityPolicy.BEST_EFFORT)  # fits every publisher
        self.open_node("image_view", lambda node: node.create_subscription(Image, topic, self._on_image, qos))

    def whole(self) -> Frame:
        """The newest picture."""
        return self.newest

    def _on_image(self, message: Image) -> None:
        """Take a picture, on the executor's thread."""
        self.calls.call_latest("image", self._show, _frame(message))

    def _show(self, frame: Frame) -> None:
        """Keep the newest picture, and send it to those who have drawn the last one. Main thread."""
        self.newest = frame
        content, fields = frame
        self.send_frame(content, **fields)


def _no_picture(line: str) -> Frame:
    return b"", {"line": line}


def _frame(message: Image) -> Frame:
    """Take a picture out of a message, or say why it is none that can be shown."""
    width, height, step, encoding = message.width, message.height, message.step, message.encoding
    if encoding not in CHANNELS:
        return _no_picture(f"the encoding {printable(encoding[:20])!r} is not shown here, only {', '.join(CHANNELS)}")
    row = CHANNELS[encoding] * width
    if not 0 < width * height <= LARGEST:
        return _no_picture(f"a picture of {width} x {height} pixels is not shown here")
    size, pixels = len(message.data), f"{width} pixels of {encoding}"
    if step < row or size < step * height:
        return _no_picture(f"no picture: {size} bytes for {height} rows of {step}, with {pixels}")
    rows = np.frombuffer(message.data, np.uint8, step * height).reshape(height, step)
    stamp = message.header.stamp.sec + message.header.stamp.nanosec / 1e9
    line = f"{width} x {height}, {encoding}, {step * height / 1000:.1f} kB, at {stamp:.3f} s"
    return rows[:, :row].tobytes(), {"line": line, "width": width, "height": height, "encoding": encoding}
