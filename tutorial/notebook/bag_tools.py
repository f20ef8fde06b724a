"""``ros2 bag play`` as a function for cells."""

import asyncio
import threading
from pathlib import Path

from tutorial.notebook.desk import keep
from tutorial.ros.bags import Bag, Player
from tutorial.ros.node_thread import NodeThread


async def bag_play(bag: Bag | Path | str, rate: float = 1.0, start_offset: float = 0.0) -> None:
    """Publish a bag's messages with their original timing. Interrupt the kernel to stop early.

    The kernel stays responsive during playback. The publishing node has the name that ``ros2 bag play`` uses and is
    destroyed at the end.

    Args:
        bag: the bag, or its path.
        rate: the playback speed; 2 means twice as fast as recorded.
        start_offset: the time to skip at the beginning [s].

    Raises:
        TutorialError: there is no such bag, the bag has nothing to play, or `rate` or `start_offset` is invalid.
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
            await playing  # the player has to destroy its publishers before the node closes
    finally:
        thread.close()
