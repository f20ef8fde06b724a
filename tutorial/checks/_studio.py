"""A camera whose pictures are made up: a check needs no graphics, and knows every pixel."""

from __future__ import annotations

import threading
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tutorial.body import Body
from tutorial.checks._diagnose import AT_ONCE, Misuse
from tutorial.checks._watch import Failure, watch
from tutorial.controller import ControllerIO, SimpleController
from tutorial.errors import TutorialError

__all__ = ["DELAY", "Shot", "Studio"]

DELAY = 7  # steps from a picture's being asked for to its delivery


@dataclass(frozen=True)
class Shot:
    """A picture that was delivered.

    Attributes:
        taken_ns: the simulated time at which it was asked for [ns].
        pixels: shape (height, width, 3).
        first: the number of the message that was sent first when it was delivered.
    """

    taken_ns: int
    pixels: NDArray[np.uint8]
    first: int


class Studio(SimpleController):
    """Stands for the renderer of a simulated body's camera, and comes before the learner's controller at every step.

    Args:
        width, height: of its pictures [px].

    Attributes:
        sent: returns how many messages were sent.
        shots: what was delivered.
        open: the cameras that were asked for and are not closed.
    """

    def __init__(self, width: int, height: int) -> None:
        self.size = width, height
        self.sent: Callable[[], int] = lambda: 0
        self.shots: list[Shot] = []
        self.open: list[_MadeUpCamera] = []
        self.waiting: list[_Order] = []
        self._seed = 0

    def initialize(self, io: ControllerIO) -> None:
        """Begin anew."""
        self.io = io
        self.waiting.clear()

    def camera(self, body: Body, name: str) -> _MadeUpCamera:
        """Find a camera, as `CameraRenderer.camera` does."""
        if name != "CAMERA":
            raise TutorialError(f"the body {body.name!r} has no camera {name!r}. Known are 'CAMERA'.")
        self.open.append(_MadeUpCamera(self, name))
        return self.open[-1]

    def control(self) -> None:
        """Deliver what was asked for some steps ago, on another thread."""
        due = [order for order in self.waiting if self.io.step >= order.step + DELAY]
        for order in due:
            self.waiting.remove(order)
            if order.camera in self.open:
                self._deliver(order)

    def _deliver(self, order: _Order) -> None:
        pixels = self._picture()
        self.shots.append(Shot(order.taken_ns, pixels.copy(), self.sent()))
        failed: list[Failure] = []

        def deliver() -> None:
            try:
                with watch.call(getattr(order.receiver, "__name__", "the receiver")):
                    order.receiver(pixels, *order.args)
            except Failure as failure:
                failed.append(failure)

        thread = threading.Thread(target=deliver, name="camera")
        thread.start()
        thread.join()
        if failed:
            raise failed[0]

    def _picture(self) -> NDArray[np.uint8]:
        """Make pixels of which no two are alike, bright enough for three of them to be more than 255."""
        self._seed += 1
        width, height = self.size
        random = np.random.default_rng(self._seed)
        gray = random.permutation(width * height) * 3 + 60
        tints = random.permuted([[40, -10, -30]] * len(gray), axis=1)  # their sum is 0, so that the mean is whole
        pixels: NDArray[np.uint8] = (gray[:, np.newaxis] + tints).reshape(height, width, 3).astype(np.uint8)
        return pixels


class _MadeUpCamera:
    """What `tutorial.view.camera.Camera` is to a controller."""

    def __init__(self, studio: Studio, name: str) -> None:
        self.name = name
        self.width, self.height = studio.size
        self.missed = 0
        self._studio = studio

    def capture(self, deliver: Any, *args: object) -> None:
        """Take an order."""
        if not callable(deliver):
            text = f"capture is given {deliver!r} in place of a function"
            raise Misuse(text, AT_ONCE.format(name="publish"))
        io = self._studio.io
        self._studio.waiting.append(_Order(self, io.step, io.time_ns, deliver, args))

    def close(self) -> None:
        """Deliver nothing more."""
        if self in self._studio.open:
            self._studio.open.remove(self)


@dataclass(frozen=True)
class _Order:
    camera: _MadeUpCamera
    step: int
    taken_ns: int
    receiver: Callable[..., object]
    args: tuple[object, ...]
