"""``tank run --bag``: records a program's topics while it runs."""

import asyncio
import os
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager, suppress
from pathlib import Path

from tutorial.commands.asking import named_node
from tutorial.program.host import Host
from tutorial.ros.bags import Recorder

LOOK_EVERY = 0.02  # [s]
MEET_FOR = 5.0  # [s] maximum time to wait for the publishers before the program runs


@asynccontextmanager
async def bag_of(host: Host, path: Path) -> AsyncIterator[Recorder]:
    """Record what a program publishes and receives, for the duration of the context.

    The recorder uses a separate node, so it does not affect the program's message counts. The context starts when the
    recorder is matched with all of the program's publishers, so that the bag contains the whole run. After 5 s, it
    starts in any case.

    Args:
        host: the program.
        path: the bag's folder, which must not exist yet.

    Raises:
        TutorialError: the bag cannot be written.
    """
    topics = {meter.topic for meter in host.node.meters}
    with named_node(f"_tank_bag_{os.getpid()}", ()) as thread, Recorder(thread.node, path, topics) as recorder:
        published = {meter.topic for meter in host.node.meters if meter.direction == "published"}
        with suppress(TimeoutError):  # topics of unknown types are not recorded; the log reports them
            async with asyncio.timeout(MEET_FOR):
                while not all(
                    publisher.get_subscription_count() > 0 and recorder.hears(publisher.topic_name)
                    for publisher in host.node.publishers
                    if publisher.topic_name in published
                ):
                    await asyncio.sleep(LOOK_EVERY)
        yield recorder
