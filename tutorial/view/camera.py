"""Cameras of a simulated world, whose images MuJoCo renders off screen on a separate thread."""

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
from tutorial.errors import TutorialError, printable
from tutorial.view.offscreen import USUAL, Offscreen, advice

TIMEOUT = 30.0  # [s] maximum time to wait for an image in lockstep; rendering the first image also starts OpenGL
UNSET = (1, 1)  # [px] MuJoCo's default resolution, for a camera that sets none
NO_PICTURES = "cameras do not work, but everything else does: rendering failed (%s). %s."
_log = logging.getLogger(__name__)


@dataclass(eq=False)
class Camera:
    """A camera of a simulated body, made by `CameraRenderer`.

    Attributes:
        name: the camera's name, without the body's prefix.
        width, height: the size of its images [px].
    """

    name: str
    width: int
    height: int
    body: Body = field(repr=False)
    number: int = field(repr=False)  # the camera's MuJoCo ID in the whole model
    renderer: CameraRenderer = field(repr=False)

    def capture(self, deliver: Callable[..., object], *args: object) -> None:
        """Request an image of the world in its current state, to be delivered by ``deliver(pixels, *args)``.

        This call only copies the state. The renderer's thread renders the image and calls ``deliver``. The pixels have
        the shape (height, width, 3), with red, green and blue from 0 to 255, and the top row first. A new request
        replaces a request that has not been rendered yet.

        Call it on the thread that steps the simulation. If that thread also made the renderer (lockstep), this call
        waits until the image has been delivered, so that no image is lost, and raises any exception from
        ``deliver``.

        Raises:
            TutorialError: in lockstep, the image did not arrive in time.
        """
        self.renderer.request(self, deliver, args)

    def close(self) -> None:
        """Stop delivering images, after waiting for a delivery in progress. Idempotent. Thread-safe."""
        self.renderer.forget(self)


@dataclass(eq=False)
class _Request:
    """A request for an image."""

    camera: Camera
    qpos: NDArray[np.float64]
    deliver: Callable[..., object]
    args: tuple[object, ...]
    is_awaited: bool  # in lockstep
    error: BaseException | None = None
    done: threading.Event = field(default_factory=threading.Event)


class CameraRenderer:
    """Renders the images of one simulated world's cameras, on a thread that starts with the first request.

    Each image is rendered from a copy of the state, so the simulation continues during rendering. If rendering fails,
    one log line reports the error, and no more images are delivered.

    Attributes:
        error: the last exception that an image callback raised, except in lockstep; None if there was none.
    """

    def __init__(self) -> None:
        self.error: BaseException | None = None
        self._owner = threading.current_thread()
        self._changed = threading.Condition()
        self._requests: dict[Camera, _Request] = {}  # the newest request for each camera
        self._at_work: _Request | None = None
        self._thread: threading.Thread | None = None
        self._closed = False

    def camera(self, body: Body, name: str) -> Camera:
        """Find a camera of a simulated body by name.

        Raises:
            TutorialError: the body has no such camera; the error suggests the closest match.
        """
        number = body.find_id("camera", body.model.camera, body.model.ncam, name)
        width, height = body.model.cam_resolution[number].tolist()
        if (width, height) == UNSET:
            width, height = USUAL
        return Camera(name, width, height, body, number, self)

    def request(self, camera: Camera, deliver: Callable[..., object], args: tuple[object, ...]) -> None:
        """Request an image; see `Camera.capture`."""
        is_awaited = threading.current_thread() is self._owner
        request = _Request(camera, camera.body.data.qpos.copy(), deliver, args, is_awaited)
        with self._changed:
            if self._closed:
                return
            self._requests[camera] = request
            if self._thread is None:
                self._thread = threading.Thread(
                    target=self._main, args=(camera.body.model,), name="camera", daemon=True
                )
                self._thread.start()
            self._changed.notify_all()
        if is_awaited:
            if not request.done.wait(TIMEOUT):
                raise TutorialError(f"camera {camera.name!r} delivered no image within {TIMEOUT:g} s.")
            if request.error is not None:
                raise request.error

    def forget(self, camera: Camera) -> None:
        """Stop delivering images from this camera; see `Camera.close`."""
        with self._changed:
            dropped = self._requests.pop(camera, None)
            if dropped is not None:
                dropped.done.set()
            if threading.current_thread() is not self._thread:
                self._changed.wait_for(lambda: self._at_work is None or self._at_work.camera is not camera, TIMEOUT)

    def close(self) -> None:
        """Stop the thread. Idempotent."""
        with self._changed:
            self._closed = True
            self._changed.notify_all()
        if self._thread is not None and self._thread is not threading.current_thread():
            self._thread.join(TIMEOUT / 10)
            if self._thread.is_alive():
                _log.error("an image callback does not return; its thread will end with the process")

    def _main(self, model: mujoco.MjModel) -> None:
        """Run the renderer's thread, the only thread that uses OpenGL."""
        try:
            with Offscreen(model) as offscreen:
                atexit.register(self.close)  # runs before OpenGL's own exit handler, which was registered earlier
                while request := self._next():
                    camera = request.camera
                    self._deliver(request, offscreen.render(request.qpos, camera.number, camera.width, camera.height))
        except Exception as error:  # noqa: BLE001 - PyOpenGL, MuJoCo and drivers can raise anything
            _log.warning(NO_PICTURES, printable(f"{type(error).__name__}: {error}")[:200], advice())
        finally:
            atexit.unregister(self.close)
            self._end()

    def _next(self) -> _Request | None:
        """Wait for a request and return it; None once the renderer is closed."""
        with self._changed:
            self._at_work = None
            self._changed.notify_all()
            self._changed.wait_for(lambda: self._requests or self._closed)
            if not self._closed:
                self._at_work = self._requests.pop(next(iter(self._requests)))
            return self._at_work

    def _deliver(self, request: _Request, pixels: NDArray[np.uint8]) -> None:
        """Deliver an image. Log the first error of an image callback, except in lockstep, where `request` raises it."""
        try:
            request.deliver(pixels, *request.args)
        except BaseException as error:  # noqa: BLE001 - the other cameras continue
            request.error = error
            if not request.is_awaited:
                if self.error is None:
                    _log.error("an image callback failed; the other callbacks continue", exc_info=error)
                self.error = error
        request.done.set()

    def _end(self) -> None:
        """Reject further requests, and release all waiting threads."""
        with self._changed:
            self._closed = True
            for request in filter(None, (self._at_work, *self._requests.values())):
                request.done.set()
            self._requests.clear()
            self._at_work = None
            self._changed.notify_all()
