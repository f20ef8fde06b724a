"""A view of the images on a topic, as in ``rqt_image_view``."""

import numpy as np
from rclpy.node import Node
from rclpy.qos import QoSProfile
from rclpy.subscription import Subscription
from sensor_msgs.msg import Image

from tutorial.errors import printable
from tutorial.notebook.widgets.cell_widget import NodeWidget
from tutorial.notebook.widgets.frame_widget import Frame, FrameWidget
from tutorial.ros.topics.endpoints import reader_qos
from tutorial.view.assets import read_static

CHANNELS = {"rgb8": 3, "bgr8": 3, "mono8": 1}  # the supported encodings, with their bytes per pixel
LARGEST = 1920 * 1080  # [pixels]
LOOK_EVERY = 0.5  # [s] between checks of the publishers


class ImageView(FrameWidget, NodeWidget):
    """Shows the newest image on a topic. Create the view on the main thread while the kernel's event loop is running.

    Its node, ``image_view``, subscribes with depth 1. The subscription is reliable if all publishers are; otherwise it
    is best effort, and the loss of one fragment means the loss of the whole image. A page receives the next image only
    after it has drawn the previous image. A slow page therefore skips images instead of queueing them.

    Args:
        topic: a topic of type ``sensor_msgs/msg/Image``.

    Attributes:
        newest: the visible frame. Its content is the image, row by row from the top without padding. Its fields are
            ``width`` and ``height`` [px], the ``encoding``, and the ``line`` of text below the image. If there is no
            image, ``line`` is the only field.

    Raises:
        TutorialError: no event loop is running.
    """

    AHEAD = 1
    _esm = read_static("make.js", "cell.js", "image_view.js")
    _css = read_static("image_view.css")

    def __init__(self, topic: str = "/Tank/camera/image") -> None:
        super().__init__(topic)
        self.newest = _no_picture(f"no message on {topic} yet")
        self._topic = topic
        self._subscription: Subscription | None = None
        self.open_node("image_view", self._set_up)

    def whole(self) -> Frame:
        """Return the newest image."""
        return self.newest

    def _set_up(self, node: Node) -> None:
        self._look(node)
        node.create_timer(LOOK_EVERY, lambda: self._look(node))

    def _look(self, node: Node) -> None:
        """Subscribe with the reliability that all publishers offer; subscribe again when this reliability changes."""
        offered = reader_qos(node, self._topic).reliability
        if self._subscription is not None:
            if self._subscription.qos_profile.reliability == offered:
                return
            node.destroy_subscription(self._subscription)
        qos = QoSProfile(depth=1, reliability=offered)
        self._subscription = node.create_subscription(Image, self._topic, self._on_image, qos)

    def _on_image(self, message: Image) -> None:
        """Post an image to the main thread. Runs on the executor's thread."""
        self.calls.call_latest("image", self._show, _frame(message))

    def _show(self, frame: Frame) -> None:
        """Store the newest image and send it to the views that have drawn the previous image. Main thread only."""
        self.newest = frame
        content, fields = frame
        self.send_frame(content, **fields)


def _no_picture(line: str) -> Frame:
    return b"", {"line": line}


def _frame(message: Image) -> Frame:
    """Extract the image from a message, or explain why the view cannot show it."""
    width, height, step, encoding = message.width, message.height, message.step, message.encoding
    if encoding not in CHANNELS:
        return _no_picture(f"the encoding {printable(encoding[:20])!r} is not supported, only {', '.join(CHANNELS)}")
    row = CHANNELS[encoding] * width
    size = len(message.data)
    if not 0 < width * height <= LARGEST or step < row or size < step * height:
        return _no_picture(
            f"{width} x {height} pixels of {encoding}, in rows of {step} bytes, {size} bytes in all: not shown"
        )
    rows = np.frombuffer(message.data, np.uint8, step * height).reshape(height, step)
    stamp = message.header.stamp.sec + message.header.stamp.nanosec / 1e9
    line = f"{width} x {height}, {encoding}, {step * height / 1000:.1f} kB, at {stamp:.3f} s"
    return rows[:, :row].tobytes(), {"line": line, "width": width, "height": height, "encoding": encoding}
