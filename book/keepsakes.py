"""Save what a notebook's widgets show while the notebook runs, because the book has no kernel to update its widgets.

When ``make notebooks`` runs the notebooks, every kernel calls `keep`; ``conf.py`` then replaces the widgets with the
saved figures. A notebook's n-th widget is saved as ``n.html``.
"""

import base64
import html
import re
import struct
import zlib
from collections.abc import Iterator
from pathlib import Path
from typing import Any

FOLDER = Path(__file__).parent / "shown"
WIDGET = re.compile(r"(SceneView|SideBySide|NodeGraph|JointPlot|Picture|ImageView)\(")
"""Matches the beginning of a saved widget's text output."""

LONGEST_PAUSE = 1.0  # [s]; replays shorten longer pauses to this length
MOVED = 0.1  # [rad]; if the joints have moved less than this, the picture looks the same
PICTURE = '<figure class="tank-picture" role="img" aria-label="{alt}">{svg}</figure>'
IMAGE = '<figure class="tank-picture"><img alt="{alt}" src="data:image/png;base64,{image}"></figure>'
BESIDE = "<p><em>In the notebook, there is {} next to this picture.</em></p>"
BESIDES = {"ChaosPanel": "a slider for each fault", "Joystick": "a joystick"}


def keep(folder: Path) -> None:
    """From now on, whenever this kernel displays a widget, save the widget to a folder."""
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
    for kind in (SceneView, Picture, ImageView, SideBySide):
        _before(kind, "_repr_mimebundle_", kept.show)
    get_ipython().events.register("post_run_cell", lambda _: kept.draw())


class _Kept:
    """The displayed widgets, by number. The widgets in a row share a number, and each has its place in the row."""

    def __init__(self, folder: Path) -> None:
        self._folder = folder
        self._parts: list[list[str]] = []  # the saved parts of each row
        self._programs: dict[Any, Any] = {}
        self._running: dict[Any, tuple[list[str], int, Any]] = {}
        self._telling: dict[Any, float] = {}
        self._drawn: list[tuple[list[str], int, Any]] = []

    def know(self, program: Any) -> None:
        """Remember the program that a view belongs to."""
        self._programs[program.view] = program

    def show(self, widget: Any) -> None:
        """Start saving a displayed widget. If it is a view that was displayed before, end the earlier recording."""
        shown = list(_leaves(widget))
        parts = [""] * len(shown)
        self._parts.append(parts)
        for place, each in enumerate(shown):
            if each in self._programs:
                self._record(each, parts, place)
            elif hasattr(each, "svg") or hasattr(each, "newest"):
                self._drawn.append((parts, place, each))
            else:
                parts[place] = BESIDE.format(BESIDES[type(each).__name__])

    def _record(self, view: Any, parts: list[str], place: int) -> None:
        from tutorial.view.replay import ReplayRecorder  # noqa: PLC0415

        self.stop(view)
        host = self._programs[view].host
        recorder = ReplayRecorder(view.scene, host.shown_at, host.joint_positions, LONGEST_PAUSE)
        self._running[view] = parts, place, recorder

    def stop(self, view: Any) -> None:
        """Stop recording a view, and write the replay."""
        if view in self._running:
            parts, place, recorder = self._running.pop(view)
            figure = recorder.stop().figure(view.title)
            if recorder in self._telling:
                figure = figure.replace("<figure", f'<figure data-at="{self._telling.pop(recorder):.3f}"', 1)
            parts[place] = figure
            self._write()

    def draw(self) -> None:
        """Choose the frames that show the effect of the last cell, and write the pictures that have changed."""
        for view, (_, _, recorder) in list(self._running.items()):
            if recorder not in self._telling:
                self._programs[view].host.refresh()
                self._telling[recorder] = _telling_time(recorder)
        for parts, place, widget in self._drawn:
            if hasattr(widget, "newest"):
                parts[place] = _image(widget) or parts[place]
            elif len(picture := _picture(widget)) > len(parts[place]):
                parts[place] = picture
        self._write()

    def _write(self) -> None:
        for number, parts in enumerate(self._parts, 1):
            if any(parts):
                (self._folder / f"{number}.html").write_text("".join(parts) + "\n", encoding="utf-8")


def _leaves(widget: Any) -> Iterator[Any]:
    """If a widget is a row, yield the widgets in it; otherwise, yield the widget itself."""
    if hasattr(widget, "children"):
        for child in widget.children:
            yield from _leaves(child)
    else:
        yield widget


def _picture(picture: Any) -> str:
    return PICTURE.format(alt=html.escape(picture.alt), svg=picture.svg) if picture.svg else ""


def _image(view: Any) -> str:
    """Return a figure that shows the newest image on a topic, or "" if there is no image yet."""
    pixels, fields = view.newest
    if not pixels:
        return ""
    image = base64.b64encode(png(pixels, fields["width"], fields["height"])).decode()
    return IMAGE.format(alt=html.escape(f"what came on {view.title}"), image=image)


def _telling_time(recorder: Any) -> float:
    """Return the time [s] when the joints were farthest from where they began, or the last one if they hardly moved."""
    first = recorder._positions[0]
    best, farthest = recorder._times[-1], MOVED
    for time, positions in zip(recorder._times, recorder._positions):
        distance = sum(abs(position - first.get(name, position)) for name, position in positions.items())
        if distance > farthest:
            best, farthest = time, distance
    return float(best)


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
    head = struct.pack(">IIBBBBB", width, height, 8, 2, 0, 0, 0)  # 8 bits each for red, green and blue
    chunks = ((b"IHDR", head), (b"IDAT", zlib.compress(lines, 9)), (b"IEND", b""))
    packed = (struct.pack(">I", len(c)) + k + c + struct.pack(">I", zlib.crc32(k + c)) for k, c in chunks)
    return b"\x89PNG\r\n\x1a\n" + b"".join(packed)
