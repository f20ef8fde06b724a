"""What the topic functions wait for before they print."""

import asyncio
from unittest.mock import Mock

from std_msgs.msg import String

from tutorial.notebook import close_all, open_node, topic_list
from tutorial.ros.node_thread import NodeThread


async def test_they_wait_for_late_nodes_of_their_own_kernel(domain, monkeypatch, capsys):
    monkeypatch.setattr(NodeThread, "alive", set())
    late = Mock(full_name="/late", node=open_node("early"))
    NodeThread.alive.add(late)
    asyncio.get_running_loop().call_later(1.0, lambda: open_node("late").create_publisher(String, "words", 1))
    await topic_list()
    close_all()
    assert "/words\n" in capsys.readouterr().out
    assert NodeThread.alive == {late}, "closed nodes are not waited for"
