"""A pytest plugin: speed up the start of the hundreds of processes that the tests start."""

import os
import sys
from importlib.util import find_spec
from pathlib import Path

sys.modules["rfc3987_syntax"] = None  # takes a second to import, and checks a kind of address that no notebook has
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")  # numpy starts a thread per core, and they spin before they sleep

_glfw = find_spec("glfw")
if _glfw is not None and _glfw.origin is not None:
    _library = Path(_glfw.origin).parent / "x11" / "libglfw.so"
    if _library.exists():  # otherwise glfw, which mujoco imports, starts a Python to find its version
        os.environ.setdefault("PYGLFW_LIBRARY", str(_library))
