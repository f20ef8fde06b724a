"""A vector picture in a cell, which its program can redraw; also one that a node of its own keeps up to date."""

import traitlets

from tutorial.handoff import CallQueue
from tutorial.notebook.widgets.cell_widget import CellWidget, NodeWidget, kernel_loop
from tutorial.view.assets import read_static


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


class LivePicture(Picture, NodeWidget):
    """A picture that callbacks of a node of its own keep up to date. Make it on the main thread, while its loop runs.

    Args:
        name: what the picture is of, for its ``repr``.

    Attributes:
        calls: what the node's callbacks post with.

    Raises:
        TutorialError: no event loop runs.
    """

    def __init__(self, name: str) -> None:
        self.calls = CallQueue(kernel_loop()).scope(name)
        super().__init__(name=name)
