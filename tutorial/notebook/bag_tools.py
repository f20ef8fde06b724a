"""``ros2 bag play`` for a cell."""

import asyncio
import threading
from pathlib import Path

from tutorial.notebook.desk import keep
from tutorial.ros.bags import Bag, Player
from tutorial.ros.node_thread import NodeThread


async def bag_play(bag: Bag | Path | str, rate: float = 1.0, start_offset: float = 0.0) -> None:
    """Publish a bag's messages again, at the times at which they were received; to interrupt the kernel ends it.

    The kernel stays free meanwhile. The node that publishes is called as that of ``ros2 bag play``; it goes at the end.

    Args:
        bag: the bag, or where it is.
        rate: how fast, 2 for twice as fast.
        start_offset: how much to leave out at the beginning [s].

    Raises:
        TutorialError: there is no such bag, nothing to play, or a number makes no sense.
    """
    opened = bag if isinstance(bag, Bag) else Bag(bag)
    thread = keep("bag player", lambda: NodeThread("rosbag2_player"), NodeThread.close)
    stop = threading.Event()
    try:
        player = Player(thread.node, opened, rate=rate, start_offset=start_offset)
        playing = asyncio.ensure_future(asyncio.to_thread(player.run, stop))
        try:
            await asyncio.shield(playing)
        finally:
            stop.set()
            await playing  # it has its publishers to take back before the node may go
    finally:
        thread.close()
