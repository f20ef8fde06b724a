"""Who is waited for before anything is said about the node graph."""

from __future__ import annotations

import asyncio

import pytest

from tutorial.ros.node_thread import NodeThread
from tutorial.ros.topics import settled
from tutorial.ros.topics.settling import QUIET_READS, READ_EVERY

pytestmark = pytest.mark.embedded


@pytest.fixture
def asker(domain):
    with NodeThread("_asker") as thread:
        yield thread.node


def participant(domain, userdata):
    """A program that was discovered and has told nothing yet."""
    from cyclonedds.domain import DomainParticipant
    from cyclonedds.qos import Policy, Qos

    return DomainParticipant(domain, Qos(Policy.Userdata(userdata)))


def announce(other, node):
    """Tell of a node, as a ROS 2 program does."""
    from cyclonedds.pub import DataWriter
    from cyclonedds.topic import Topic
    from rclpy._graph import _WRITER_QOS
    from rclpy._wire import encode, payload_type
    from rmw_dds_common.msg import Gid, ParticipantEntitiesInfo

    kind = payload_type(ParticipantEntitiesInfo._definition.type_name)
    writer = DataWriter(other, Topic(other, "ros_discovery_info", kind), _WRITER_QOS)
    gid = Gid(data=list(other.guid.bytes))
    writer.write(kind(encode(ParticipantEntitiesInfo(gid=gid, node_entities_info_seq=[node]))))
    return writer


def settle(asker, **how):
    return asyncio.run(settled(asker, patience=4 * QUIET_READS * READ_EVERY, **how))


def test_a_ros_2_program_that_was_discovered_is_waited_for(asker, domain):
    other = participant(domain, b"enclave=/;")
    assert not settle(asker)
    del other


def test_it_is_waited_for_until_its_nodes_and_all_that_they_have_are_known(asker, domain):
    from rmw_dds_common.msg import Gid, NodeEntitiesInfo

    other = participant(domain, b"enclave=/;")
    node = NodeEntitiesInfo(node_namespace="/", node_name="late")

    async def told_in_the_meantime():
        waiting = asyncio.create_task(settled(asker, patience=60.0))
        await asyncio.sleep(0)  # the first look
        writers.append(announce(other, node))
        return await waiting

    writers = []
    assert asyncio.run(told_in_the_meantime())
    assert "late" in asker.get_node_names()
    node.writer_gid_seq = [Gid(data=[7] * 16)]
    writers.append(announce(other, node))
    assert not settle(asker), "one of its publishers is still on its way"


def test_a_program_that_is_dds_alone_is_not_waited_for(asker, domain):
    other = participant(domain, b"")
    assert asyncio.run(settled(asker, patience=60.0))
    del other


def test_what_is_asked_for_is_waited_for_a_little_longer(asker):
    looks = iter([False, False, True])
    assert asyncio.run(settled(asker, patience=60.0, wanted=lambda: next(looks)))
    assert next(looks, "all taken") == "all taken"
