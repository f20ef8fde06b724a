"""Who is waited for before anything is said about the node graph."""

from __future__ import annotations

import asyncio

import pytest

from tutorial.ros.node_thread import NodeThread
from tutorial.ros.topics import graph
from tutorial.ros.topics.graph import QUIET_READS, READ_EVERY, wait_for_graph

pytestmark = pytest.mark.pocket


@pytest.fixture
def asker(domain):
    with NodeThread("_asker") as thread:
        yield thread.node


def settle(asker, **how):
    return asyncio.run(wait_for_graph(asker, patience=4 * QUIET_READS * READ_EVERY, **how))


def test_a_ros_2_program_that_was_discovered_is_waited_for(asker, stranger):
    assert not settle(asker)


def test_it_is_waited_for_until_its_nodes_and_all_that_they_have_are_known(asker, stranger):
    async def told_in_the_meantime():
        waiting = asyncio.create_task(wait_for_graph(asker, patience=60.0))
        await asyncio.sleep(0)  # the first look
        stranger.announce(stranger.listing("late"))
        return await waiting

    assert asyncio.run(told_in_the_meantime())
    assert "late" in asker.get_node_names()
    stranger.announce(stranger.listing("late", writers=1))
    assert not settle(asker), "one of its publishers is still on its way"


def test_a_program_that_is_dds_alone_is_not_waited_for(asker, domain):
    from cyclonedds.domain import DomainParticipant

    other = DomainParticipant(domain)
    assert asyncio.run(wait_for_graph(asker, patience=60.0))
    del other


def test_what_is_asked_for_is_waited_for_a_little_longer(asker, monkeypatch):
    monkeypatch.setattr(graph, "DISCOVERY_TIMEOUT", 60.0)
    looks = iter([False, False, True])
    assert asyncio.run(wait_for_graph(asker, patience=60.0, wanted=lambda: next(looks)))
    assert next(looks, "all taken") == "all taken"
