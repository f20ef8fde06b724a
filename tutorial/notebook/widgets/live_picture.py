"""A picture that a node of its own keeps up to date."""

from __future__ import annotations

from collections.abc import Sequence

from tutorial.errors import running_loop
from tutorial.handoff import CallQueue, CallScope
from tutorial.notebook.widgets.picture import Picture
from tutorial.ros.node_thread import MeteredNode, NodeThread

__all__ = ["LivePicture"]

NO_LOOP = "a live picture is redrawn by an event loop, and none runs here. Make it in a cell."


class LivePicture(Picture):
    """A picture that callbacks of a node of its own keep up to date. Make it on the main thread, while its loop runs.

    Args:
        name: what the picture is of, for its ``repr``.
        node_name: what its node is called.
        ros_args: command line arguments, of which ROS 2 takes those after ``--ros-args``.

    Attributes:
        loop: of the main thread.
        calls: what the node's callbacks post with.
        node: its node, whose callbacks run on a thread of their own.

    Raises:
        TutorialError: no event loop runs.
    """

    _queue: CallQueue | None = None  # also in a picture whose making failed: Python closes it
    _ros: NodeThread | None = None

    def __init__(self, name: str, node_name: str, ros_args: Sequence[str] | None = None) -> None:
        self.loop = running_loop(NO_LOOP)
        super().__init__(name=name)
        self._queue = CallQueue(self.loop)
        self.calls: CallScope = self._queue.scope(repr(self))
        try:
            self._ros = NodeThread(node_name, ros_args)
        except BaseException:
            self.close()
            raise
        self.node: MeteredNode = self._ros.node

    def end(self) -> None:
        """Take the node away; the picture stays as it is. Idempotent, main thread."""
        if self._queue is not None:
            self._queue.close()
        if self._ros is not None:
            self._ros.close()
        super().end()

    def close(self) -> None:
        """Take the picture and its node away. Idempotent, main thread."""
        self.end()
        super().close()
