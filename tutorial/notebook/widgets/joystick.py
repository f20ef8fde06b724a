"""A joystick in a cell: two sticks for mouse, fingers, keys or a gamepad, published as `sensor_msgs/Joy`."""

import math
import threading
import time

from msgspec import Struct
from rclpy.node import Node
from sensor_msgs.msg import Joy

from tutorial.handoff import Latest
from tutorial.notebook.widgets.cell_widget import CellWidget, NodeWidget, parse_message
from tutorial.ros.joy import NEUTRAL, RATE, joy_message
from tutorial.view.assets import read_static

PATIENCE = 0.5
"""After so long without a message from the page [s] the sticks count as released: its tab or the laptop is closed."""


class _Sticks(Struct, tag="sticks"):
    """What a page says of its sticks."""

    axes: tuple[float, ...] = NEUTRAL
    buttons: tuple[int, ...] = (0,) * 15


class Joystick(NodeWidget):
    """Two sticks in a notebook's cell. Their own node, ``joystick``, publishes them on ``joy`` at 50 Hz.

    It publishes from its node's thread, so it drives also while a cell is busy. The numbers are those of the ROS 2 joy
    package's ``game_controller_node``: left and forward are +1. If the page sends no more while a stick is held,
    the sticks are released. When the page has been gone for a minute, it publishes nothing, as an unplugged joystick.
    """

    _esm = read_static("make.js", "cell.js", "joystick.js")
    _css = read_static("joystick.css")
    _clock = staticmethod(time.monotonic)

    def __init__(self) -> None:
        self._held = Latest((_Sticks(), -math.inf))  # what the page said last, and when
        self._publishing = threading.Lock()
        super().__init__()
        self.open_node("joystick", self._set_up)
        self.on_msg(self._on_message)

    @property
    def axes(self) -> tuple[float, ...]:
        """The newest six axes: left stick left and up, right stick left and up, the two triggers; -1 to 1."""
        return self._now().axes

    def end(self) -> None:
        """Release the sticks, publish that, and end the node and its thread. Idempotent, main thread."""
        if not self.ended:
            self.ended = True
            self._publish()
        super().end()

    def _set_up(self, node: Node) -> None:
        self._node = node
        self._publisher = node.create_publisher(Joy, "joy", 1)
        self._timer = node.create_timer(1 / RATE, self._tick)

    def _on_message(self, _widget: object, content: object, _buffers: object) -> None:
        """Take what a page says, on whatever thread, and leave it for the node's."""
        if said := parse_message(content, _Sticks):
            self._held.put((said, self._clock()))
            CellWidget.heard_at = time.monotonic()

    def _now(self) -> _Sticks:
        held, received_at = self._held.get()
        is_old = self._clock() - received_at >= PATIENCE
        return _Sticks() if is_old or self.ended else held

    def _tick(self) -> None:
        """Publish; while the page is gone, only look once a second whether it is back."""
        is_gone = self.page_is_gone()
        self._timer.timer_period_ns = 10**9 if is_gone else 10**9 // RATE
        if not is_gone:
            self._publish()

    def _publish(self) -> None:
        """Publish the sticks as they are now: on the node's thread, and once more in the end, on the main thread."""
        with self._publishing:  # so that the last message is the neutral one
            held = self._now()
            self._publisher.publish(joy_message(self._node, held.axes, held.buttons))
