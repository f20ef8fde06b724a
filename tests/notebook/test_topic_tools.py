"""What the tools for topics wait for before they print."""

from __future__ import annotations

import asyncio

from std_msgs.msg import String

from tutorial.notebook import close_all, open_node, topic_list
from tutorial.ros.node_thread import NodeThread


class Late:
    """Stands for a node that has been opened, and that no other has met yet."""

    full_name = "/late"


async def test_they_wait_for_a_node_of_their_own_kernel_that_is_met_late(domain, monkeypatch, capsys):
    monkeypatch.setattr(NodeThread, "alive", {Late})
    asyncio.get_running_loop().call_later(1.0, lambda: open_node("late").create_publisher(String, "words", 1))
    await topic_list()
    close_all()
    assert "/words\n" in capsys.readouterr().out
    assert NodeThread.alive == {Late}, "what is closed is not waited for"
