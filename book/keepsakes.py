"""Save what a notebook's widgets show while it runs, for the book, which has no kernel to bring them to life.

``make notebooks`` makes every kernel call `keep`; ``conf.py`` replaces the widgets by the saved figures. A notebook's
n-th widget is saved as ``n.html``.
"""

import base64
import html
import re
import struct
import zlib
from pathlib import Path
from typing import Any

FOLDER = Path(__file__).parent / "shown"
WIDGET = re.compile(r"(SceneView|SideBySide|NodeGraph|JointPlot|Picture|ImageView)\(")
"""Matches the beginning of a saved widget's text output."""

LONGEST_PAUSE = 1.0  # [s] in a replay
PICTURE = '<figure class="tank-picture" role="img" aria-label="{alt}">{svg}</figure>'
IMAGE = '<figure class="tank-picture"><img alt="{alt}" src="data:image/png;base64,{image}"></figure>'
BESIDE = "<p><em>In the notebook, there is {} beside it.</em></p>"
BESIDES = {"ChaosPanel": "a slider for each fault", "Joystick": "a joystick", "SceneView": "another view"}


def keep(folder: Path) -> None:
    """Save all widgets that this kernel displays from now on, in a folder."""
    from IPython.core.getipython import get_ipython  # noqa: PLC0415  (the book itself does not need these)

    from tutorial.notebook.program import Program  # noqa: PLC0415
    from tutorial.notebook.widgets.image_view import ImageView  # noqa: PLC0415
    from tutorial.notebook.widgets.picture import Picture  # noqa: PLC0415
    from tutorial.notebook.widgets.scene_view import SceneView  # noqa: PLC0415
    from tutorial.notebook.widgets.side_by_side import SideBySide  # noqa: PLC0415

    folder.mkdir(parents=True, exist_ok=True)
    for old in folder.glob("*.html"):
        old.unlink()
    kept = _Kept(folder)
    _after(Program, "__init__", kept.know)
    _before(SceneView, "end", kept.stop)
    for kind in (SceneView, Picture, SideBySide):
        _before(kind, "_repr_mimebundle_", kept.show)
    _before(ImageView, "_repr_mimebundle_", kept.show_images)
    get_ipython().events.register("post_run_cell", lambda _: kept.draw())


class _Kept:
    """The displayed widgets, by number."""

    def __init__(self, folder: Path) -> None:
        self._folder = folder
        self._count = 0
        self._programs: dict[Any, Any] = {}
        self._running: dict[Any, tuple[int, Any, str]] = {}
        self._pictures: dict[int, Any] = {}
        self._drawn: dict[int, int] = {}
        self._image_views: dict[int, Any] = {}

    def know(self, program: Any) -> None:
        """Remember a program by its view."""
        self._programs[program.view] = program

    def show(self, widget: Any) -> None:
        """Start to save a displayed widget; if the same view was displayed before, finish that recording."""
        self._count += 1
        view, end = widget, ""
        if hasattr(widget, "children"):
            view, other = widget.children
            end = BESIDE.format(BESIDES[type(other).__name__])
        if view not in self._programs:
            self._pictures[self._count] = view
            return
        from tutorial.view.replay import ReplayRecorder  # noqa: PLC0415

        self.stop(view)
        host = self._programs[view].host
        recorder = ReplayRecorder(view.scene, host.shown_at, host.joint_positions, LONGEST_PAUSE)
        self._running[view] = self._count, recorder, end

    def show_images(self, view: Any) -> None:
        """Start to save the newest image on a topic."""
        self._count += 1
        self._image_views[self._count] = view

    def stop(self, view: Any) -> None:
        """Write the replay of a view, and stop recording it."""
        if view in self._running:
            number, recorder, end = self._running.pop(view)
            self._write(number, recorder.stop().figure(view.title) + end)

    def draw(self) -> None:
        """Write the pictures that have grown since the last time, and the newest images."""
        for number, picture in self._pictures.items():
            if len(picture.svg) > self._drawn.get(number, 0):
                self._drawn[number] = len(picture.svg)
                self._write(number, PICTURE.format(alt=html.escape(picture.alt), svg=picture.svg))
        for number, view in self._image_views.items():
            pixels, fields = view.newest
            if pixels:
                image = base64.b64encode(png(pixels, fields["width"], fields["height"])).decode()
                self._write(number, IMAGE.format(alt=html.escape(f"what came on {view.title}"), image=image))

    def _write(self, number: int, text: str) -> None:
        (self._folder / f"{number}.html").write_text(text + "\n", encoding="utf-8")


def _before(kind: type, name: str, call: Any) -> None:
    method = getattr(kind, name)

    def both(self: Any, *args: Any, **named: Any) -> Any:
        call(self)
        return method(self, *args, **named)

    setattr(kind, name, both)


def _after(kind: type, name: str, call: Any) -> None:
    method = getattr(kind, name)

    def both(self: Any, *args: Any, **named: Any) -> Any:
        result = method(self, *args, **named)
        call(self)
        return result

    setattr(kind, name, both)


def png(pixels: bytes, width: int, height: int) -> bytes:
    """Encode a colour image as PNG: three bytes per pixel, row by row from the top."""
    row = 3 * width
    lines = b"".join(b"\0" + pixels[i : i + row] for i in range(0, row * height, row))
    head = struct.pack(">IIBBBBB", width, height, 8, 2, 0, 0, 0)  # 8 bits each of red, green and blue
    chunks = ((b"IHDR", head), (b"IDAT", zlib.compress(lines, 9)), (b"IEND", b""))
    packed = (struct.pack(">I", len(c)) + k + c + struct.pack(">I", zlib.crc32(k + c)) for k, c in chunks)
    return b"\x89PNG\r\n\x1a\n" + b"".join(packed)
