"""A joystick in a cell: two sticks for mouse, fingers, keys or a gamepad, published as `sensor_msgs/Joy`."""

from __future__ import annotations

import math
import threading
import time
from collections.abc import Sequence
from typing import NamedTuple

from sensor_msgs.msg import Joy

from tutorial.handoff import Latest
from tutorial.notebook.widgets.cell_widget import CellWidget
from tutorial.ros.node_thread import NodeThread
from tutorial.view.assets import read_static

__all__ = ["Joystick"]

RATE = 50  # [Hz]
PATIENCE = 0.5
"""After so long without a word from the page [s] the sticks count as let go: its tab is closed, the laptop is shut."""

AXES, BUTTONS = 6, 15
SENSELESS = 1e6
NEUTRAL = (0.0,) * AXES


class _Held(NamedTuple):
    """What the hands did when the page last said so."""

    axes: tuple[float, ...] = NEUTRAL
    buttons: tuple[int, ...] = (0,) * BUTTONS
    heard_at: float = -math.inf


class Joystick(CellWidget):
    """Two sticks in a notebook's cell. Their own node, ``joystick``, publishes them on ``joy`` at 50 Hz.

    It publishes from its node's thread, so it drives also while a cell is busy. The numbers are those of the ROS 2 joy
    package's ``game_controller_node``: left and forward are +1. If the page falls silent while a stick is held, the
    sticks are let go.

    Args:
        ros_args: command line arguments, of which ROS 2 takes those after ``--ros-args``.
    """

    _esm = read_static("make.js", "cell.js", "joystick.js")
    _css = read_static("joystick.css")
    _clock = staticmethod(time.monotonic)

    def __init__(self, ros_args: Sequence[str] | None = None) -> None:
        self._held = Latest(_Held())
        self._publishing = threading.Lock()
        self._is_closing = False
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
        """Let the sticks go, say so on ``joy``, and end the node and its thread. Idempotent, main thread."""
        if self._is_closing:
            return
        super().end()
        self._is_closing = True
        self._publish()
        self._ros.close()

    def close(self) -> None:
        """End it, and take it off every page. Idempotent, main thread."""
        if self.comm is not None:
            self.end()
        super().close()

    def _on_message(self, _widget: object, content: object, _buffers: object) -> None:
        """Take what a page says, on whatever thread, and leave it for the node's."""
        if not isinstance(content, dict) or content.get("type") != "sticks":
            return
        axes, buttons = _axes(content.get("axes")), _buttons(content.get("buttons"))
        if axes is not None and buttons is not None:
            self._held.put(_Held(axes, buttons, self._clock()))

    def _now(self) -> _Held:
        held = self._held.get()
        is_old = self._clock() - held.heard_at >= PATIENCE
        return _Held() if is_old or self._is_closing else held

    def _publish(self) -> None:
        """Publish what the hands do now: on the node's thread, and once more in the end, on the main thread."""
        with self._publishing:  # so that the last message is the neutral one
            held = self._now()
            message = Joy(axes=list(held.axes), buttons=list(held.buttons))
            message.header.stamp = self._ros.node.get_clock().now().to_msg()
            message.header.frame_id = "joy"
            self._publisher.publish(message)


def _axes(given: object) -> tuple[float, ...] | None:
    """Six finite numbers, brought within -1 to 1; None for anything else."""
    if not isinstance(given, list) or len(given) != AXES:
        return None
    if not all(type(axis) in (int, float) and abs(axis) < SENSELESS for axis in given):  # NaN is not less
        return None
    return tuple(max(-1.0, min(float(axis), 1.0)) for axis in given)


def _buttons(given: object) -> tuple[int, ...] | None:
    """Fifteen times 0 or 1; None for anything else."""
    if not isinstance(given, list) or len(given) != BUTTONS or not all(type(button) is int for button in given):
        return None
    return tuple(int(button != 0) for button in given)
