"""A node in memory."""

import pytest
from rclpy.qos import QoSProfile
from sensor_msgs.msg import Imu, Joy

from tutorial.checks.engine.failure import Failure, Misuse
from tutorial.checks.engine.memory_node import MemoryNode
from tutorial.checks.engine.trial import Trial


def made(**options):
    return MemoryNode(Trial(test_topics), **options)


def test_topics():
    node = made(namespace="/lab")
    subscription = node.create_subscription(Joy, "joy", print, 3)
    node.create_publisher(Imu, "/imu", 1)
    assert node.on(Joy, "joy") == "Joy on /lab/joy"
    assert node.on(Imu, "imu") == "Imu on /imu"
    assert (node.listeners(Joy()), node.listeners(Imu()), subscription.depth) == ([print], [], 3)


def test_undestroyed_topics_are_reported():
    node = made()
    publisher = node.create_publisher(Imu, "imu", 1)
    publisher.destroy()
    with pytest.raises(Failure, match="unconfigure") as info:
        node.check_left()
    assert str(info.value.error) == "the node still has 1 of 1 topics and was not notified that they were destroyed"
    assert node.destroy_publisher(publisher)
    assert node.check_left() == "nothing is left"
    with pytest.raises(Misuse, match="with a destroyed publisher"):
        publisher.publish(Imu())


async def coroutine(message):
    pass


@pytest.mark.parametrize(("callback", "said"), [(None, "gets None instead"), (coroutine, "nobody awaits it")])
def test_callbacks_that_cannot_work(callback, said):
    with pytest.raises(Misuse, match=said):
        made().create_subscription(Joy, "joy", callback, 1)


def test_a_profile_can_change_later():
    qos = QoSProfile(depth=2)
    publisher = made().create_publisher(Joy, "joy", qos)
    qos.depth = 3
    assert publisher.qos.depth == 2


@pytest.mark.parametrize("count", [0, 1])
def test_subscribers_are_counted(count):
    node = made()
    node.subscribers = count
    publisher = node.create_publisher(Joy, "joy", 1)
    assert publisher.get_subscription_count() == node.count_subscribers("joy") == count
    assert publisher.get_publisher_count() == 1


def test_timers_can_be_canceled():
    node = made()
    timer = node.create_timer(timer_period_sec=0.1, callback=print)
    assert node.timers == [timer]
    assert (timer.callback, timer.is_canceled()) == (print, False)
    timer.cancel()
    assert timer.is_canceled()
    timer.reset()
    assert not timer.is_canceled()
    assert node.destroy_timer(timer)
    assert timer.is_canceled()
