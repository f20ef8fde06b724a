"""What the cameras of a simulated world see, rendered off screen by MuJoCo on a thread of its own."""

from __future__ import annotations

import atexit
import logging
import threading
from collections.abc import Callable
from dataclasses import dataclass, field

import mujoco
import numpy as np
from numpy.typing import NDArray

from tutorial.body import Body
from tutorial.errors import TutorialError, did_you_mean, printable
from tutorial.view.offscreen import LARGEST, USUAL, Offscreen, mend

__all__ = ["Camera", "CameraRenderer"]

PATIENCE = 30.0  # [s] that a picture may take in lockstep, the first one's OpenGL included
MISSED = 10  # pictures of a camera that have to be missed before it is said
NO_PICTURES = "cameras take no pictures, all else goes on: nothing renders here (%s). %s."
_log = logging.getLogger(__name__)


class Camera:
    """A camera of a simulated body, made by `CameraRenderer`.

    Args:
        renderer: takes its pictures.
        name: without the body's prefix.
        number: MuJoCo's, in the whole model.
        size: of its pictures (width, height) [px].

    Attributes:
        name: as given.
        width, height: of its pictures [px].
        missed: how many pictures a newer one has replaced before they were rendered, once OpenGL has begun.
    """

    def __init__(self, renderer: CameraRenderer, name: str, number: int, size: tuple[int, int]) -> None:
        self.name = name
        self.number = number
        self.width, self.height = size
        self.missed = 0
        self._renderer = renderer

    def __repr__(self) -> str:
        return f"Camera({self.name!r}, {self.width} x {self.height})"

    def capture(self, deliver: Callable[..., object], *args: object) -> None:
        """Have a picture taken of the world as it is now. ``deliver(pixels, *args)`` is called with it, elsewhere.

        Only the state is copied here: the picture is rendered and delivered on the renderer's thread. Pixels have the
        shape (height, width, 3), red, green and blue from 0 to 255, the topmost row first. A picture that still waits
        to be rendered is replaced.

        Who steps the simulation on the thread that has made the renderer, in lockstep, waits here until the picture is
        delivered, so that none is missed; what ``deliver`` raises is then raised here. The thread that steps.

        Raises:
            TutorialError: in lockstep, a picture does not come.
        """
        self._renderer.request(self, deliver, args)

    def close(self) -> None:
        """Deliver nothing any more; what is being delivered comes to its end first. Idempotent. Any thread."""
        self._renderer.forget(self)


@dataclass(eq=False)
class _Request:
    """A picture that is to be taken."""

    qpos: NDArray[np.float64]
    deliver: Callable[..., object]
    args: tuple[object, ...]
    is_awaited: bool  # in lockstep
    error: BaseException | None = None
    done: threading.Event = field(default_factory=threading.Event)


class CameraRenderer:
    """Takes the pictures of the cameras of one simulated world, on a thread that begins with the first.

    The world goes on meanwhile, for each picture is rendered from a copy of its state. Where nothing can render, that
    is said once, and no pictures are delivered.

    Args:
        model: the world's.
        data: its state; read by `request`, on the thread that steps the simulation.

    Attributes:
        error: what a receiver of pictures raised last; None when none did.
        problem: why nothing renders here; empty as long as that is not known.
    """

    def __init__(self, model: mujoco.MjModel, data: mujoco.MjData) -> None:
        self.error: BaseException | None = None
        self.problem = ""
        self._model = model
        self._data = data
        self._owner = threading.current_thread()
        self._changed = threading.Condition()
        self._requests: dict[Camera, _Request] = {}  # the newest of each camera
        self._at_work: tuple[Camera, _Request] | None = None
        self._thread: threading.Thread | None = None
        self._has_begun = False  # OpenGL, which may take a second or two
        self._closed = False

    def camera(self, body: Body, name: str) -> Camera:
        """Find a camera of a body by name.

        Raises:
            TutorialError: the body has no such camera, the text names the nearest; or its pictures are too large.
        """
        model, prefix = self._model, f"{body.name}/"
        every = (model.camera(i).name for i in range(model.ncam))
        own = {each.removeprefix(prefix): i for i, each in enumerate(every) if each.startswith(prefix)}
        if name not in own:
            raise TutorialError(f"the body {body.name!r} has no camera {name!r}.{did_you_mean(name, own)}")
        width, height = model.cam_resolution[own[name]].tolist()
        size = USUAL if (width, height) == (1, 1) else (width, height)  # 1 x 1 is MuJoCo's for what is not said
        if width > LARGEST[0] or height > LARGEST[1]:
            most = " x ".join(map(str, LARGEST))
            raise TutorialError(f"the camera {name!r} has {width} x {height} pixels. Give it at most {most}.")
        return Camera(self, name, own[name], size)

    def request(self, camera: Camera, deliver: Callable[..., object], args: tuple[object, ...]) -> None:
        """Have a picture taken; see `Camera.capture`."""
        is_awaited = threading.current_thread() is self._owner
        request = _Request(self._data.qpos.copy(), deliver, args, is_awaited)
        with self._changed:
            if self._closed or self.problem:
                return
            if camera in self._requests and self._has_begun:
                self._miss(camera)
            self._requests[camera] = request
            if self._thread is None:
                self._thread = threading.Thread(target=self._main, name="camera", daemon=True)
                self._thread.start()
            self._changed.notify_all()
        if is_awaited:
            if not request.done.wait(PATIENCE):
                raise TutorialError(f"the picture of {camera.name!r} has not come for {PATIENCE:g} s.")
            if request.error is not None:
                raise request.error

    def forget(self, camera: Camera) -> None:
        """Deliver nothing more to who has asked for this camera's pictures; see `Camera.close`."""
        with self._changed:
            dropped = self._requests.pop(camera, None)
            if dropped is not None:
                dropped.done.set()
            if threading.current_thread() is not self._thread:
                self._changed.wait_for(lambda: not (self._at_work and self._at_work[0] is camera), PATIENCE)

    def close(self) -> None:
        """End the thread. Idempotent."""
        with self._changed:
            self._closed = True
            self._changed.notify_all()
        if self._thread is not None and self._thread is not threading.current_thread():
            self._thread.join(PATIENCE / 10)
            if self._thread.is_alive():
                _log.error("a receiver of pictures does not return, so its thread ends with the process")

    def _miss(self, camera: Camera) -> None:
        camera.missed += 1
        if camera.missed == MISSED:
            _log.warning("the camera %r has missed %d pictures: rendering takes too long here", camera.name, MISSED)

    def _main(self) -> None:
        """The renderer's thread, the only one that knows of OpenGL."""
        try:
            with Offscreen(self._model) as offscreen:
                self._has_begun = True
                atexit.register(self.close)  # before OpenGL's own end, which comes after what was registered earlier
                try:
                    while self._take(offscreen):
                        pass
                finally:
                    atexit.unregister(self.close)
        except Exception as error:  # noqa: BLE001 - PyOpenGL, MuJoCo and the driver raise what they like
            self._give_up(error)
        finally:
            self._drop_all()

    def _take(self, offscreen: Offscreen) -> bool:
        """Wait for a request, and fulfil it; False when there will be none any more."""
        with self._changed:
            self._changed.wait_for(lambda: self._requests or self._closed)
            if self._closed:
                return False
            camera = next(iter(self._requests))
            request = self._requests.pop(camera)
            self._at_work = camera, request
        try:
            pixels = offscreen.render(request.qpos, camera.number, camera.width, camera.height)
            try:
                request.deliver(pixels, *request.args)
            except BaseException as error:  # noqa: BLE001 - whatever it is, the other cameras go on
                self._failed(request, error)
        finally:
            with self._changed:
                self._at_work = None
                self._changed.notify_all()
            request.done.set()
        return True

    def _failed(self, request: _Request, error: BaseException) -> None:
        """Keep what a receiver has raised. In lockstep it is raised there; else it is logged, the first time."""
        request.error = error
        if request.is_awaited:
            return
        if self.error is None:
            _log.error("a receiver of pictures failed; the others go on", exc_info=error)
        self.error = error

    def _give_up(self, error: Exception) -> None:
        text = printable(f"{type(error).__name__}: {error}")[:200]
        with self._changed:
            self.problem = text
        _log.warning(NO_PICTURES, text, mend())

    def _drop_all(self) -> None:
        """Nobody has to wait any more."""
        with self._changed:
            for request in self._requests.values():
                request.done.set()
            self._requests.clear()
