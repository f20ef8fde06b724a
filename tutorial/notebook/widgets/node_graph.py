"""A live picture of the node graph, as ``rqt_graph`` shows it."""

from __future__ import annotations

import time
from collections.abc import Sequence

from tutorial.errors import printable
from tutorial.notebook.widgets import svg
from tutorial.notebook.widgets.graph_picture import picture
from tutorial.notebook.widgets.graph_watch import GraphWatch, Topology
from tutorial.notebook.widgets.live_picture import LivePicture

__all__ = ["NodeGraph"]

LOOK_EVERY = 1.0  # [s]
BREATH = 10  # times as long as a look took, before the next
FIRST_LOOKS = (0.2, 0.6)  # [s] after the beginning


class NodeGraph(LivePicture):
    """Draws nodes, topics, and who publishes and subscribes, once a second.

    Make it on the main thread, while its loop runs. Its own node is hidden, as are all whose names begin with an
    underscore, and the topics that every node has. The rates are those at which its own subscriptions receive: they
    count in ``ros2 topic info``.

    Args:
        ros_args: command line arguments, of which ROS 2 takes those after ``--ros-args``.
        rates: measure the rates, too.

    Raises:
        TutorialError: no event loop runs.
    """

    def __init__(self, ros_args: Sequence[str] | None = None, rates: bool = True) -> None:
        super().__init__("node graph", "_node_graph", ros_args)
        self._draw(Topology())
        self._watch = GraphWatch(self.node, rates)
        self._next_looks = [time.monotonic() + pause for pause in FIRST_LOOKS]
        self.node.create_timer(FIRST_LOOKS[0], self._look)

    def __repr__(self) -> str:
        return "NodeGraph()"

    def _look(self) -> None:
        """Ask for the graph when it is time to, post what there is, and return. The executor's thread."""
        began = time.monotonic()
        if began < self._next_looks[0]:
            return
        try:
            self.calls.call_latest("graph", self._draw, self._watch.look())
        except (RuntimeError, UnicodeDecodeError) as error:  # a real one lists nothing while a node's name is empty
            self.calls.call_latest("graph", self._say, f"ROS 2 says: {printable(str(error))}")
        took = time.monotonic() - began
        self._next_looks = self._next_looks[1:] or [time.monotonic() + max(LOOK_EVERY, BREATH * took)]

    def _say(self, text: str) -> None:
        """Show a sentence in the graph's place. Main thread."""
        self.show(svg.notice(480, 80, svg.shorten(text, 64)), text)

    def _draw(self, topology: Topology) -> None:
        """Draw the graph. Main thread."""
        self.show(*picture(topology))
