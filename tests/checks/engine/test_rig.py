"""A controller on a simulated body."""

import pytest
from sensor_msgs.msg import Joy

from tutorial.checks.engine.failure import Failure
from tutorial.checks.engine.rig import Rig
from tutorial.checks.engine.trial import Trial
from tutorial.controller import SimpleController


class Repeats(SimpleController):
    def configure(self, config):
        self.publisher = config.node.create_publisher(Joy, "out", 1)
        config.node.create_subscription(Joy, "in", self.on_joy, 1)

    def on_joy(self, message):
        self.message = message

    def initialize(self, io):
        self.io = io

    def control(self):
        self.message.header.stamp.sec = self.io.step
        self.publisher.publish(self.message)


def test_published_messages_are_recorded():
    rig = Rig(Trial(Repeats), time_step=0.5)
    rig.hear(Joy())
    rig.start(3)
    rig.advance(2)
    rig.stop()
    assert [(each.topic, each.step, each.stamp_ns) for each in rig.sent] == [
        ("/out", 3, 3 * 10**9),
        ("/out", 4, 4 * 10**9),
    ]
    assert not rig.has_threads
    with pytest.raises(Failure):
        rig.leave()
