"""Off-screen rendering with MuJoCo, using EGL on Linux and the system's OpenGL elsewhere."""

import copy
import importlib
import os
import platform
from contextlib import AbstractContextManager
from typing import Any

import mujoco
import numpy as np
from numpy.typing import NDArray

USUAL = (320, 240)  # [px] default camera resolution, if the model sets none
ON_DEBIAN = "On Debian and Ubuntu, sudo apt-get install libegl1 libgl1 fixes this problem"
ELSEWHERE = "See MuJoCo's documentation on rendering in Python to find out what to install on this system"

Pixels = NDArray[np.uint8]


class Offscreen(AbstractContextManager["Offscreen"]):
    """An off-screen OpenGL context for rendering one model. Use it only on the thread that made it.

    Args:
        model: the model to render. The context renders a copy of it, without the costly shadows and antialiasing.

    Raises:
        Exception: rendering does not work on this machine.
    """

    def __init__(self, model: mujoco.MjModel) -> None:
        self._model = copy.copy(model)
        width, height = np.max([USUAL, *model.cam_resolution.tolist()], axis=0).tolist()
        self._model.vis.global_.offwidth, self._model.vis.global_.offheight = width, height
        self._model.vis.quality.offsamples = self._model.vis.quality.shadowsize = 0
        self._data = mujoco.MjData(self._model)
        self._gl = _gl_context(width, height)
        self._gl.make_current()
        self._context = mujoco.MjrContext(self._model, mujoco.mjtFontScale.mjFONTSCALE_100)
        mujoco.mjr_setBuffer(mujoco.mjtFramebuffer.mjFB_OFFSCREEN, self._context)
        self._scene = mujoco.MjvScene(self._model, maxgeom=self._model.ngeom + self._model.nsite + 1000)
        self._scene.flags[mujoco.mjtRndFlag.mjRND_SHADOW] = 0
        self._option = mujoco.MjvOption()
        self._view = mujoco.MjvCamera()
        self._view.type = mujoco.mjtCamera.mjCAMERA_FIXED

    def __exit__(self, *_: object) -> None:
        self._context.free()
        self._gl.free()

    def render(self, qpos: NDArray[np.float64], camera: int, width: int, height: int) -> Pixels:
        """Render a camera's image.

        Args:
            qpos: MuJoCo's generalized positions, shape (nq,).
            camera: the camera's id.
            width, height: the size of the image [px].

        Returns:
            The pixels, shape (height, width, 3), with the top row first.
        """
        model, data = self._model, self._data
        data.qpos[:] = qpos
        mujoco.mj_fwdPosition(model, data)
        self._view.fixedcamid = camera
        every = mujoco.mjtCatBit.mjCAT_ALL
        mujoco.mjv_updateScene(model, data, self._option, None, self._view, every, self._scene)
        whole, pixels = mujoco.MjrRect(0, 0, width, height), np.empty((height, width, 3), np.uint8)
        mujoco.mjr_render(whole, self._scene, self._context)
        mujoco.mjr_readPixels(pixels, None, whole, self._context)
        return np.ascontiguousarray(pixels[::-1])  # OpenGL counts rows from the bottom


def advice() -> str:
    """Return advice on how to make rendering work, as a sentence without its full stop."""
    return ON_DEBIAN if platform.system() == "Linux" else ELSEWHERE


def _gl_context(width: int, height: int) -> Any:
    """Make an OpenGL context. On Linux, use EGL, which needs no screen, unless MUJOCO_GL selects something else."""
    if platform.system() == "Linux" and not os.environ.get("MUJOCO_GL"):
        return importlib.import_module("mujoco.egl").GLContext(width, height)
    return mujoco.GLContext(width, height)
