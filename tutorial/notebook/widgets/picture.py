"""Vector pictures in cells: static pictures, and live pictures that nodes update."""

import traitlets

from tutorial.handoff import CallQueue
from tutorial.notebook.widgets.cell_widget import CellWidget, NodeWidget, kernel_loop
from tutorial.view.assets import read_static


class Picture(CellWidget):
    """Shows an SVG picture in a cell; `show` replaces it.

    Only shapes and text reach the page: everything else, such as scripts and links, is removed.

    Args:
        svg: the picture; empty if there is no picture yet.
        alt: a description of the picture for screen readers.
        name: the picture's subject, for the ``repr``.

    Attributes:
        svg: the visible picture.
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
        """Replace the picture and its description. Main thread only."""
        with self.hold_sync():  # sends both in one message
            self.svg, self.alt = svg, alt


class LivePicture(Picture, NodeWidget):
    """A picture that its node's callbacks update.

    Create the picture on the main thread while the kernel's event loop is running.

    Args:
        name: the picture's subject, for the ``repr``.

    Attributes:
        calls: the queue that the node's callbacks post to.

    Raises:
        TutorialError: no event loop is running.
    """

    def __init__(self, name: str) -> None:
        self.calls = CallQueue(kernel_loop()).scope(name)
        super().__init__(name=name)
