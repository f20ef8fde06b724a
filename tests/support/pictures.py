"""Helpers for tests of rendered images."""

import functools
import os
from pathlib import Path

import mujoco
import pytest

from tutorial.view.offscreen import Offscreen

RED_BLOCK = """
<mujoco model="Block">
  <worldbody>
    <light pos="0 0 3" diffuse="0.6 0.6 0.6"/>
    <geom name="WALL" type="box" pos="4 0 0" size="0.1 4 4" rgba="0.2 0.2 0.9 1"/>
    <body name="BLOCK" pos="2 0 0">
      <joint name="ASIDE" type="slide" axis="0 1 0"/>
      <geom type="box" size="0.3 0.3 0.3" rgba="0.9 0.1 0.1 1"/>
    </body>
    <body name="STAND">
      <geom type="sphere" size="0.05" pos="0 0 -0.2"/>
      <camera name="CAMERA" xyaxes="0 -1 0 0 0 1" fovy="60"/>
      <camera name="SMALL" xyaxes="0 -1 0 0 0 1" fovy="60" resolution="64 48"/>
    </body>
  </worldbody>
</mujoco>
"""
"""A camera that looks along x at a red block in front of a blue wall."""


@functools.cache
def problem() -> str:
    """Return why this machine cannot render, or ""."""
    try:
        with Offscreen(mujoco.MjModel.from_xml_string(RED_BLOCK)):
            return ""
    except Exception as error:  # noqa: BLE001 - PyOpenGL, MuJoCo and the driver raise any exception
        return f"nothing renders here ({type(error).__name__}: {error}): apt-get install libegl1 libgl1"


def need_pictures() -> None:
    """Skip the test if this machine cannot render, with the reason; in CI (CI=true) fail it."""
    if problem():
        (pytest.fail if os.environ.get("CI") == "true" else pytest.skip)(problem())


def red_block(folder: Path) -> Path:
    """Write the model file."""
    path = folder / "block.xml"
    path.write_text(RED_BLOCK, encoding="utf-8")
    return path


def is_red(pixel) -> bool:
    """Return whether a pixel, red, green and blue, is clearly red."""
    red, green, blue = (int(each) for each in pixel)
    return red > 100 and red > 2 * max(green, blue)
