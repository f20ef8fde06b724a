"""A joystick in a cell: two sticks that are moved by mouse, touch, keys or gamepad and publish `sensor_msgs/Joy`."""

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

TIMEOUT = 0.5
"""The sticks are treated as released if no message arrives for this long [s]: the tab or laptop may be closed."""


class _Sticks(Struct, tag="sticks"):
    """The state of the sticks, as sent by a page."""

    axes: tuple[float, ...] = NEUTRAL
    buttons: tuple[int, ...] = (0,) * 15


class Joystick(NodeWidget):
    """Shows two sticks in a cell. Its node, ``joystick``, publishes their positions on ``joy`` at 50 Hz.

    The joystick publishes from the node's thread, so it can drive the tank even while a cell is busy. The axes have the
    same signs as those of ``game_controller_node`` in the ROS 2 package joy: left and forward are +1. If the page stops
    sending while a stick is held, the sticks are treated as released. Once the page has been gone for a minute, the
    joystick stops publishing, as if it had been unplugged.
    """

    _esm = read_static("make.js", "cell.js", "joystick.js")
    _css = read_static("joystick.css")
    _clock = staticmethod(time.monotonic)

    def __init__(self) -> None:
        self._held = Latest((_Sticks(), -math.inf))  # the last message from the page, and its time of receipt
        self._publishing = threading.Lock()
        super().__init__()
        self.open_node("joystick", self._set_up)
        self.on_msg(self._on_message)

    @property
    def axes(self) -> tuple[float, ...]:
        """The six axes, each from -1 to 1: left/up of the left stick, left/up of the right stick, the two triggers."""
        return self._now().axes

    def end(self) -> None:
        """Release the sticks, publish their neutral state, and destroy the node. Idempotent; main thread only."""
        if not self.ended:
            self.ended = True
            self._publish()
        super().end()

    def _set_up(self, node: Node) -> None:
        self._node = node
        self._publisher = node.create_publisher(Joy, "joy", 1)
        self._timer = node.create_timer(1 / RATE, self._tick)

    def _on_message(self, _widget: object, content: object, _buffers: object) -> None:
        """Store a page's message for the node's thread. Thread-safe."""
        if said := parse_message(content, _Sticks):
            self._held.put((said, self._clock()))
            CellWidget.heard_at = time.monotonic()

    def _now(self) -> _Sticks:
        held, received_at = self._held.get()
        is_old = self._clock() - received_at >= TIMEOUT
        return _Sticks() if is_old or self.ended else held

    def _tick(self) -> None:
        """Publish the state of the sticks. While the page is gone, only check once a second whether it has returned."""
        is_gone = self.page_is_gone()
        self._timer.timer_period_ns = 10**9 if is_gone else 10**9 // RATE
        if not is_gone:
            self._publish()

    def _publish(self) -> None:
        """Publish the state of the sticks. Runs on the node's thread, except for the last call, which `end` makes."""
        with self._publishing:  # so that the neutral message is the last one
            held = self._now()
            self._publisher.publish(joy_message(self._node, held.axes, held.buttons))
