"""A picture that a node of its own keeps up to date."""

from __future__ import annotations

from tutorial.errors import running_loop
from tutorial.handoff import CallQueue
from tutorial.notebook.widgets.cell_widget import NodeWidget
from tutorial.notebook.widgets.picture import Picture

__all__ = ["LivePicture"]

NO_LOOP = "a live picture is redrawn by an event loop, and none runs here. Make it in a cell."


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
        self.calls = CallQueue(running_loop(NO_LOOP)).scope(name)
        super().__init__(name=name)
