"""A live picture of the node graph, as ``rqt_graph`` shows it."""

import time

from rclpy.node import Node

from tutorial.errors import printable
from tutorial.notebook.widgets import svg
from tutorial.notebook.widgets.graph_picture import picture
from tutorial.notebook.widgets.graph_watch import GraphWatch, Topology
from tutorial.notebook.widgets.picture import LivePicture

LOOK_EVERY = 0.5  # [s]
BREATH = 10  # times as long as a look took, before the next


class NodeGraph(LivePicture):
    """Draws nodes, topics, and who publishes and subscribes, twice a second.

    Make it on the main thread, while its loop runs. Its own node is hidden, as are all whose names begin with an
    underscore, and the topics that every node has. The rates are those at which its own subscriptions receive: they
    count in ``ros2 topic info``.

    Raises:
        TutorialError: no event loop runs.
    """

    def __init__(self) -> None:
        super().__init__("node graph")
        self.show(*picture(Topology()))
        self._next_look = 0.0
        self.open_node("_node_graph", self._set_up)

    def __repr__(self) -> str:
        return "NodeGraph()"

    def _set_up(self, node: Node) -> None:
        self._watch = GraphWatch(node)
        node.create_timer(LOOK_EVERY, self._look)

    def _look(self) -> None:
        """Ask for the graph when it is time to, draw it, post the picture, and return. The executor's thread."""
        began = time.monotonic()
        if began < self._next_look:
            return
        try:
            self.calls.call_latest("graph", self.show, *picture(self._watch.look()))
        except (RuntimeError, UnicodeDecodeError) as error:  # a real one lists nothing while a node's name is empty
            text = f"ROS 2 says: {printable(str(error))}"
            self.calls.call_latest("graph", self.show, svg.notice(480, 80, svg.shorten(text, 64)), text)
        ended = time.monotonic()
        self._next_look = ended + BREATH * (ended - began)
