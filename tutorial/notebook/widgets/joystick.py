"""A joystick in a cell: two sticks for mouse, fingers, keys or a gamepad, published as `sensor_msgs/Joy`."""

from __future__ import annotations

import math
import threading
import time
from collections.abc import Sequence
from typing import Annotated, NamedTuple

from msgspec import Meta, Struct
from sensor_msgs.msg import Joy

from tutorial.commands.joystick import NEUTRAL, RATE, joy_message
from tutorial.handoff import Latest
from tutorial.notebook.widgets.cell_widget import CellWidget, parse_message
from tutorial.ros.node_thread import NodeThread
from tutorial.view.assets import read_static

__all__ = ["Joystick"]

PATIENCE = 0.5
"""After so long without a message from the page [s] the sticks count as released: its tab or the laptop is closed."""

BUTTONS = 15

_Axis = Annotated[float, Meta(gt=-1e6, lt=1e6)]


class _Sticks(Struct, tag="sticks"):
    """What a page says that the hands do."""

    axes: Annotated[list[_Axis], Meta(min_length=len(NEUTRAL), max_length=len(NEUTRAL))]
    buttons: Annotated[list[int], Meta(min_length=BUTTONS, max_length=BUTTONS)]


class _Held(NamedTuple):
    """What the hands did when the page last said so."""

    axes: tuple[float, ...] = NEUTRAL
    buttons: tuple[int, ...] = (0,) * BUTTONS
    received_at: float = -math.inf


class Joystick(CellWidget):
    """Two sticks in a notebook's cell. Their own node, ``joystick``, publishes them on ``joy`` at 50 Hz.

    It publishes from its node's thread, so it drives also while a cell is busy. The numbers are those of the ROS 2 joy
    package's ``game_controller_node``: left and forward are +1. If the page sends no more while a stick is held,
    the sticks are released.

    Args:
        ros_args: command line arguments, of which ROS 2 takes those after ``--ros-args``.
    """

    _esm = read_static("make.js", "cell.js", "joystick.js")
    _css = read_static("joystick.css")
    _clock = staticmethod(time.monotonic)

    def __init__(self, ros_args: Sequence[str] | None = None) -> None:
        self._held = Latest(_Held())
        self._publishing = threading.Lock()
        self._ros = NodeThread("joystick", ros_args)
        try:
            super().__init__()
            self._publisher = self._ros.node.create_publisher(Joy, "joy", 1)
            self._ros.node.create_timer(1 / RATE, self._publish)
            self.on_msg(self._on_message)
        except BaseException:
            self._ros.close()
            raise

    @property
    def axes(self) -> tuple[float, ...]:
        """The newest six axes: left stick left and up, right stick left and up, the two triggers; -1 to 1."""
        return self._now().axes

    def end(self) -> None:
        """Release the sticks, publish that, and end the node and its thread. Idempotent, main thread."""
        if self.ended:
            return
        super().end()
        self._publish()
        self._ros.close()

    def close(self) -> None:
        """End it, and take it off every page. Idempotent, main thread."""
        if self.comm is not None:
            self.end()
        super().close()

    def _on_message(self, _widget: object, content: object, _buffers: object) -> None:
        """Take what a page says, on whatever thread, and leave it for the node's."""
        said = parse_message(content, _Sticks)
        if said is not None:
            axes = tuple(max(-1.0, min(axis, 1.0)) for axis in said.axes)
            self._held.put(_Held(axes, tuple(int(button != 0) for button in said.buttons), self._clock()))

    def _now(self) -> _Held:
        held = self._held.get()
        is_old = self._clock() - held.received_at >= PATIENCE
        return _Held() if is_old or self.ended else held

    def _publish(self) -> None:
        """Publish what the hands do now: on the node's thread, and once more in the end, on the main thread."""
        with self._publishing:  # so that the last message is the neutral one
            held = self._now()
            self._publisher.publish(joy_message(self._ros.node, held.axes, held.buttons))
