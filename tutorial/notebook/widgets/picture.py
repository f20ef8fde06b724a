"""A vector picture in a cell, which its program can redraw."""

from __future__ import annotations

import traitlets

from tutorial.notebook.widgets.cell_widget import CellWidget
from tutorial.view.assets import read_static

__all__ = ["Picture"]


class Picture(CellWidget):
    """Shows an SVG in a cell, and every later one in its place.

    What comes into the page is shapes and text: scripts, links and everything else are left out on the way.

    Args:
        svg: the picture; empty for none yet.
        alt: what is to be seen, in words, for those who don't see it.
        name: what the picture is of, for its ``repr``.

    Attributes:
        svg: the picture that is shown.
        alt: its description.
    """

    _esm = read_static("picture.js")

    svg = traitlets.Unicode().tag(sync=True)
    alt = traitlets.Unicode().tag(sync=True)

    def __init__(self, svg: str = "", alt: str = "", name: str = "") -> None:
        self._name = name
        super().__init__(svg=svg, alt=alt)

    def __repr__(self) -> str:
        return f"{type(self).__name__}({self._name!r})"

    def show(self, svg: str, alt: str) -> None:
        """Show another picture, with its description. Main thread."""
        with self.hold_sync():  # one message for both
            self.svg, self.alt = svg, alt
