"""rclpy's own node."""

import pytest
from sensor_msgs.msg import Joy

from tutorial.checks.engine import real_dds
from tutorial.errors import TutorialError


def test_a_message_arrives(domain):
    heard = []
    with real_dds.ros_node() as node:
        node.create_subscription(Joy, "joy", heard.append, 1)
        real_dds.send(node, "/joy", Joy(buttons=[1]), lambda: heard)
    assert [[*message.buttons] for message in heard] == [[1]]


def test_patience_ends(monkeypatch):
    monkeypatch.setattr(real_dds, "TIMEOUT", 0.0)
    with pytest.raises(TutorialError, match="nothing"):
        real_dds.wait(lambda: False, "nothing")
