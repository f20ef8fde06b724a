"""The joystick: a gamepad, or a drive scripted in a file, published as `sensor_msgs/Joy`."""

from __future__ import annotations

import os
import threading
import time
from bisect import bisect_right
from collections.abc import Callable
from itertools import pairwise
from pathlib import Path
from typing import Annotated, Any

import msgspec
from sensor_msgs.msg import Joy

from tutorial.errors import TutorialError
from tutorial.model.yamlfile import YamlFile
from tutorial.ros.joy import NEUTRAL, RATE, joy_message
from tutorial.ros.node_thread import MeteredNode


class _Moment(msgspec.Struct, forbid_unknown_fields=True):
    time: Annotated[float, msgspec.Meta(ge=0)]
    axes: Annotated[list[Annotated[float, msgspec.Meta(ge=-1, le=1)]], msgspec.Meta(max_length=6)]


class _DriveFile(msgspec.Struct, forbid_unknown_fields=True):
    """The content of a drive file."""

    drive: Annotated[list[_Moment], msgspec.Meta(min_length=1)]
    repeat: bool = False


class ScriptedDrive:
    """A drive scripted in a YAML file: a list of times, each with the axes that apply from that time on.

    Args:
        path: the file. With ``repeat: true`` the drive restarts at the time of its last entry.

    Raises:
        TutorialError: the file is missing or malformed; the error gives the line and a fix.
    """

    def __init__(self, path: Path) -> None:
        file = YamlFile(path, _DriveFile, "drive")
        self._times = [moment.time for moment in file.data.drive]
        self._axes = [moment.axes for moment in file.data.drive]
        for i, (before, after) in enumerate(pairwise(self._times), start=1):
            with file.at("drive", i, "time"):
                if after <= before:
                    raise TutorialError(f"{after} is not later than {before}. Put the times in order.")
        self._period = self._times[-1] if file.data.repeat else 0.0

    def read(self, seconds: float) -> tuple[list[float], list[int]]:
        """Return the axes at a given time [s] since the drive's start, and no buttons."""
        if self._period:
            seconds %= self._period
        i = bisect_right(self._times, seconds) - 1
        return (self._axes[i] if i >= 0 else list(NEUTRAL)), []


class Gamepad:
    """A gamepad, read with pygame-ce through SDL's game controller API, which supports the layouts of common models.

    Args:
        controller: pygame's controller.

    Attributes:
        name: the gamepad's name.
    """

    def __init__(self, controller: Any) -> None:
        self._controller = controller
        self.name = str(controller.name)

    @classmethod
    def find(cls) -> Gamepad | None:
        """Return the first connected gamepad; None if there is no gamepad, or if pygame is not installed."""
        os.environ.setdefault("SDL_VIDEODRIVER", "dummy")
        os.environ.setdefault("PYGAME_HIDE_SUPPORT_PROMPT", "1")
        try:
            import pygame  # noqa: PLC0415 - an optional extra
            from pygame._sdl2 import controller  # noqa: PLC0415
        except ImportError:
            return None
        pygame.display.init()  # SDL events need the video subsystem
        controller.init()
        for i in range(controller.get_count()):
            if controller.is_controller(i):
                return cls(controller.Controller(i))
        return None

    def read(self, seconds: float) -> tuple[list[float], list[int]]:  # noqa: ARG002 - a gamepad only has current values
        """Return the current axes and buttons, as the ROS 2 joy package's ``game_controller_node`` publishes them.

        In SDL, right and backward are positive. The ``game_controller_node`` inverts every axis: left and forward are
        positive, and a trigger goes from 0 to -1.
        """
        import pygame  # noqa: PLC0415

        pygame.event.pump()
        axes = [-self._controller.get_axis(axis) / 32767 + 0.0 for axis in range(6)]
        buttons = [int(self._controller.get_button(button)) for button in range(15)]
        return [max(-1.0, min(axis, 1.0)) for axis in axes], buttons


def publish_joystick(
    node: MeteredNode,
    source: ScriptedDrive | Gamepad,
    duration: float | None,
    linger: float,
    stop: threading.Event,
    progress: Callable[[float], object],
) -> float:
    """Publish a joystick's state on ``joy`` at 50 Hz until the time is up or `stop` is set.

    A scripted drive starts when the first subscription appears, so that its subscriber receives the whole drive. The
    last message centres the sticks.

    Args:
        node: the node to publish with.
        source: the joystick.
        duration: how long to publish [s]; None to publish until `stop` is set.
        linger: the maximum time [s] to keep publishing after the duration. During this time, publishing stops as soon
            as one of the subscriptions ends, even if others remain: a monitoring program does not keep the joystick
            running.
        stop: set it, from any thread, to stop publishing.
        progress: called with the elapsed seconds.

    Returns:
        The time spent publishing [s].
    """
    publisher = node.create_publisher(Joy, "joy", 1)
    began = time.monotonic()
    met_at: float | None = None
    most = tick = 0
    while not stop.wait(max(0.0, began + tick / RATE - time.monotonic())):
        elapsed = time.monotonic() - began
        subscriptions = publisher.get_subscription_count()
        if met_at is None and subscriptions:
            met_at = elapsed
        most = max(most, subscriptions)
        if duration is not None and elapsed >= duration and (subscriptions < most or elapsed >= duration + linger):
            break
        publisher.publish(joy_message(node, *source.read(elapsed - met_at if met_at is not None else 0.0)))
        progress(elapsed)
        tick = max(tick + 1, int(elapsed * RATE))
    publisher.publish(joy_message(node, NEUTRAL, []))
    return time.monotonic() - began
