"""Guard conditions."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import TYPE_CHECKING

from rclpy._rclpy_pybind11 import Destroyable

if TYPE_CHECKING:
    from rclpy.node import Node


class GuardCondition(Destroyable):
    """Lets any thread make the executor run a callback; created by ``Node.create_guard_condition``.

    Args:
        node: the guard condition's node.
        callback: called without arguments, on the thread that spins.
    """

    def __init__(self, node: Node, callback: Callable[[], object]) -> None:
        self._node = node
        self.callback = callback
        self._triggered = False

    def trigger(self) -> None:
        """Make the executor run the callback. Further triggers before the callback runs have no effect.

        Raises:
            InvalidHandle: the guard condition has been destroyed.
        """
        self._require_handle()
        self._triggered = True
        self._node.wake_executor()

    def destroy(self) -> None:
        """Destroy the guard condition. Idempotent. As in rclpy, ``Node.guards`` still includes the guard condition."""
        self._node._remove(self, keep=True)

    def close(self) -> None:
        """Disable the guard condition permanently. Called by the node."""
        self._destroyed = True

    def wait_time(self) -> float:
        """Return how long the executor can wait before it has to run the callback [s]."""
        return 0.0 if self._triggered and not self._destroyed else math.inf

    def execute(self) -> bool:
        """Run the callback if the condition has been triggered. Called by the executor.

        Returns:
            Whether the callback was called.
        """
        if self.wait_time() > 0:
            return False
        self._triggered = False
        self.callback()
        return True
