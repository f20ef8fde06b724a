"""A live picture of the node graph, as in ``rqt_graph``."""

import time

from rclpy.node import Node

from tutorial.errors import printable
from tutorial.notebook.widgets import svg
from tutorial.notebook.widgets.graph_picture import picture
from tutorial.notebook.widgets.graph_watch import GraphWatch, Topology
from tutorial.notebook.widgets.picture import LivePicture

LOOK_EVERY = 0.5  # [s]
BREATH = 10  # the pause before the next query, as a multiple of the last query's duration


class NodeGraph(LivePicture):
    """Draws nodes, topics, publishers and subscribers twice a second.

    Create the picture on the main thread while the kernel's event loop is running. The picture omits nodes whose names
    begin with an underscore, such as its own, and the topics that every node has. To measure rates, the picture's node
    subscribes to the topics, so ``ros2 topic info`` counts these subscriptions.

    Raises:
        TutorialError: no event loop is running.
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
        """Query the graph if a query is due, draw it, and post the picture. Runs on the executor's thread."""
        began = time.monotonic()
        if began < self._next_look:
            return
        try:
            self.calls.call_latest("graph", self.show, *picture(self._watch.look()))
        except (RuntimeError, UnicodeDecodeError) as error:  # the real rclpy lists nothing while a node's name is empty
            text = f"ROS 2 reports: {printable(str(error))}"
            self.calls.call_latest("graph", self.show, svg.notice(480, 80, svg.shorten(text, 64)), text)
        ended = time.monotonic()
        self._next_look = ended + BREATH * (ended - began)
