"""``tank doctor TOPIC`` and ``why``, which print the same."""

import asyncio

import pytest
from sensor_msgs.msg import Joy

from tutorial.errors import TutorialError
from tutorial.notebook import close_all, topic_tools
from tutorial.ros.doctor import examine
from tutorial.ros.node_thread import NodeThread


async def why(topic: str) -> None:
    try:
        await topic_tools.why(topic)
    finally:
        close_all()


@pytest.fixture(params=["command", "cell"])
def answer(request, domain, capsys, tank):
    """Return a function that asks about a topic in a terminal or in a cell, and returns the text."""

    def ask(topic: str, status: int = 1) -> str:
        if request.param == "command":
            run = tank("doctor", topic, "--domain", 3)
            assert run.status == status
            return run.stdout
        asyncio.run(why(topic))
        return capsys.readouterr().out

    return ask


@pytest.mark.parametrize("error", [TutorialError("it is for a different Python"), ImportError("no module 'rclpy'")])
def test_no_ros(answer, monkeypatch, error):
    def refuse():
        raise error

    monkeypatch.setattr(examine, "ros_backend", refuse)
    assert answer("/joy").startswith(f"1. This Python cannot import ROS 2\n     saw   {error}\n")


@pytest.mark.parametrize("topic", ["/joy", "joy"])
def test_no_loopback(answer, monkeypatch, topic):
    monkeypatch.setattr(examine, "loopback_is_up", lambda: False)
    assert answer(topic).startswith("1. The loopback interface is down\n")


@pytest.mark.parametrize("topic", ["/joy", "joy"])
def test_all_is_well(answer, topic):
    with NodeThread("stick") as thread:
        publisher = thread.node.create_publisher(Joy, "/joy", 1)
        thread.node.create_timer(0.02, lambda: publisher.publish(Joy()))
        first, second = answer(topic, 0).splitlines()
    assert first.endswith(": 1 publisher (/stick), no subscription.")
    assert second.startswith("All is well: ")


def test_a_bad_name(tank, domain):
    assert "must not contain" in tank("doctor", "/a b").stderr
    with pytest.raises(TutorialError, match="must not contain"):
        asyncio.run(why("/a b"))
