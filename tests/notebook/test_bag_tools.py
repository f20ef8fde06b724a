"""A bag that is played from a cell."""

from __future__ import annotations

import asyncio

import pytest
from rclpy.serialization import serialize_message
from rclpy.time import Time
from sensor_msgs.msg import JointState

from tutorial.controllers.bag_recorder import open_bag
from tutorial.errors import TutorialError
from tutorial.notebook import bag_play, open_node, until
from tutorial.ros.bags import Bag
from tutorial.ros.node_thread import NodeThread

TOPIC = "/Tank/joint_state"
PERIOD = 20_000_000  # [ns]
SINCE_1970 = 1_750_000_000_000_000_000  # [ns]


@pytest.fixture
def drive(tmp_path):
    """A bag of 25 messages, half a second of them, stamped from 0 on."""
    bag, connection = open_bag(tmp_path, TOPIC)
    for i in range(25):
        message = JointState(name=["TURRET_Y"], position=[i / 100])
        message.header.stamp = Time(nanoseconds=i * PERIOD).to_msg()
        bag.write(connection, SINCE_1970 + i * PERIOD, serialize_message(message))
    bag.close()
    return bag.path


async def test_it_is_heard_whole_faster_and_from_the_middle_until_it_is_interrupted(drive, domain):
    heard = []
    ear = open_node("ear")
    ear.create_subscription(JointState, TOPIC, lambda message: heard.append(message.position[0]), 100)
    await bag_play(drive, rate=5.0)
    await until(lambda: len(heard) == 25)
    assert heard == [i / 100 for i in range(25)]
    heard.clear()
    await bag_play(Bag(drive), rate=5.0, start_offset=0.4, topics=[TOPIC])
    await until(lambda: len(heard) == 5)
    assert heard == [i / 100 for i in range(20, 25)]
    with pytest.raises(TutorialError, match="there is no topic '/joy' in this bag"):
        await bag_play(drive, topics=["/joy"])
    heard.clear()
    playing = asyncio.ensure_future(bag_play(drive, rate=0.001))
    await until(lambda: heard)
    playing.cancel()
    with pytest.raises(asyncio.CancelledError):
        await playing
    assert heard == [0.0]
    assert [thread.full_name for thread in NodeThread.alive] == ["/ear"], "the player's node has gone"
