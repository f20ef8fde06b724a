"""Playing a bag from a cell."""

import asyncio

import pytest
from rclpy.serialization import serialize_message
from sensor_msgs.msg import JointState

from tutorial.controllers.bag_recorder import open_bag
from tutorial.errors import TutorialError
from tutorial.notebook import bag_play, open_node, until
from tutorial.ros.node_thread import NodeThread

TOPIC = "/Tank/joint_state"


@pytest.fixture
def drive(tmp_path):
    """A bag with two messages, 20 ms apart."""
    bag, connection = open_bag(tmp_path, TOPIC)
    for i in range(2):
        bag.write(connection, 20_000_000 * i, serialize_message(JointState(name=["TURRET_Y"], position=[float(i)])))
    bag.close()
    return bag.path


async def test_a_bag_plays_until_it_is_interrupted(drive, domain):
    heard = []
    ear = open_node("ear")
    ear.create_subscription(JointState, TOPIC, lambda message: heard.append(message.position[0]), 100)
    with pytest.raises(TutorialError, match="rate"):
        await bag_play(drive, rate=0.0)
    playing = asyncio.ensure_future(bag_play(drive, rate=0.001))
    await until(lambda: heard)
    playing.cancel()
    with pytest.raises(asyncio.CancelledError):
        await playing
    assert heard == [0.0]
    assert [thread.full_name for thread in NodeThread.alive] == ["/ear"], "the player's node was closed"
