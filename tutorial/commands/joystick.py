"""The joystick: a gamepad, or a drive that is written down in a file, published as `sensor_msgs/Joy`."""

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
from tutorial.program.yamlfile import YamlFile
from tutorial.ros.joy import NEUTRAL, RATE, joy_message
from tutorial.ros.node_thread import MeteredNode


class _Moment(msgspec.Struct, forbid_unknown_fields=True):
    time: Annotated[float, msgspec.Meta(ge=0)]
    axes: Annotated[list[Annotated[float, msgspec.Meta(ge=-1, le=1)]], msgspec.Meta(max_length=6)]


class _DriveFile(msgspec.Struct, forbid_unknown_fields=True):
    """What a drive file looks like."""

    drive: Annotated[list[_Moment], msgspec.Meta(min_length=1)]
    repeat: bool = False


class ScriptedDrive:
    """A drive that is written down in a YAML file: from each time on, these axes.

    Args:
        path: the file. With ``repeat: true`` it begins anew at the time of its last moment.

    Raises:
        TutorialError: the file is missing or malformed; the text names the line and the mend.
    """

    def __init__(self, path: Path) -> None:
        file = YamlFile(path, _DriveFile, "drive")
        self._times = [moment.time for moment in file.data.drive]
        self._axes = [moment.axes for moment in file.data.drive]
        for i, (before, after) in enumerate(pairwise(self._times), start=1):
            with file.at("drive", i, "time"):
                if after <= before:
                    raise TutorialError(f"{after} is not later than {before}. Put the moments in order.")
        self._period = self._times[-1] if file.data.repeat else 0.0

    def read(self, seconds: float) -> tuple[list[float], list[int]]:
        """Return the axes at a time since its beginning [s]; it has no buttons."""
        if self._period:
            seconds %= self._period
        i = bisect_right(self._times, seconds) - 1
        return (self._axes[i] if i >= 0 else list(NEUTRAL)), []


class Gamepad:
    """A gamepad, through SDL's game controllers, which know where every make has its sticks (pygame-ce).

    Args:
        controller: pygame's controller.

    Attributes:
        name: what the gamepad calls itself.
    """

    def __init__(self, controller: Any) -> None:
        self._controller = controller
        self.name = str(controller.name)

    @classmethod
    def find(cls) -> Gamepad | None:
        """Return the first gamepad that is connected; None where there is none, or no pygame."""
        os.environ.setdefault("SDL_VIDEODRIVER", "dummy")
        os.environ.setdefault("PYGAME_HIDE_SUPPORT_PROMPT", "1")
        try:
            import pygame  # noqa: PLC0415 - an optional extra
            from pygame._sdl2 import controller  # noqa: PLC0415
        except ImportError:
            return None
        pygame.display.init()  # events are SDL's video subsystem's
        controller.init()
        for i in range(controller.get_count()):
            if controller.is_controller(i):
                return cls(controller.Controller(i))
        return None

    def read(self, seconds: float) -> tuple[list[float], list[int]]:  # noqa: ARG002 - a gamepad lives in the present
        """Return the axes and buttons of now, as of the ROS 2 joy package's ``game_controller_node``.

        SDL has right and backward positive. That node turns every axis round: left and forward are positive, a trigger
        goes from 0 to -1.
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
    """Publish a joystick on ``joy`` at 50 Hz, until it is time to stop.

    A scripted drive begins with the first subscription, so that nothing of it is lost. The last message has the sticks
    in the middle.

    Args:
        node: the node to publish with.
        source: the joystick.
        duration: how long [s]; None for until `stop`.
        linger: after the duration, go on for at most so long [s], until a subscription that had come has gone. Others
            may stay: whoever listens in does not keep the joystick.
        stop: set it to stop, from any thread.
        progress: called with the seconds that have passed.

    Returns:
        How long it has published [s].
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
