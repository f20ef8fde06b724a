"""The static files of the 3D view and the widgets: the tutorial's own files, and meshcat's viewer."""

import gzip
from functools import cache
from importlib.metadata import distribution
from pathlib import Path

STATIC = Path(__file__).parent / "static"
"""The folder with the tutorial's own scripts, styles and pages."""

VIEW = ("make.js", "camera.js", "scene.js", "viewer.js")
"""The parts of the script that all views use: in a cell, on a page, in a replay and on the book's page `drive`."""


def meshcats_viewer() -> Path:
    """Return the folder with meshcat's ``main.min.js``, without importing meshcat, which would take 0.3 s."""
    return Path(str(distribution("meshcat").locate_file("meshcat/viewer/dist")))


@cache
def zipped_viewer() -> bytes:
    """Return the script of meshcat's viewer, compressed with gzip to a quarter of its size."""
    return gzip.compress((meshcats_viewer() / "main.min.js").read_bytes(), 6, mtime=0)


def read_static(*names: str) -> str:
    """Return the concatenated text of files in ``static/``, as one script or style sheet."""
    return "\n".join((STATIC / name).read_text(encoding="utf-8") for name in names)
