"""A pytest plugin: what the tests start, hundreds of processes, leaves out what it needs for nothing here."""

import os
import sys
from importlib.util import find_spec
from pathlib import Path

sys.modules["rfc3987_syntax"] = None  # takes a second to import, and checks a kind of address that no notebook has
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")  # numpy makes one for each core, and they spin before they sleep

_glfw = find_spec("glfw")
if _glfw is not None and _glfw.origin is not None:
    _library = Path(_glfw.origin).parent / "x11" / "libglfw.so"
    if _library.exists():  # mujoco imports glfw, which looks for its library, and asks another Python for the version
        os.environ.setdefault("PYGLFW_LIBRARY", str(_library))
