"""The exercise `thrift`: right answers in their styles, and what no edit of the solution tells."""

from itertools import count

import numpy as np
from rclpy.time import Time
from sensor_msgs.msg import JointState

from tutorial.checks.thrift import ThriftyPublisher


class WithArrays(ThriftyPublisher):
    """Compares arrays, of which the first is far away."""

    def initialize(self, io):
        self.io, self.names = io, np.array(io.body.joint_names)
        self.last = np.full(len(self.names), np.inf)

    def control(self):
        if self.io.step % np.int64(np.rint(0.02 / self.io.time_step)):
            return
        now = np.array([joint.position for joint in self.io.body.joints])
        news = abs(now - self.last) > 0.001
        if news.any():
            message = JointState(name=self.names[news].tolist(), position=now[news])
            message.header.stamp = Time(nanoseconds=self.io.time_ns).to_msg()
            self.publisher.publish(message)
            self.last[news] = now[news]


class Generator(ThriftyPublisher):
    """A generator holds the state, and the first look comes one period after the start."""

    def initialize(self, io):
        self.steps = self.live(io, round(1 / (50 * io.time_step)))

    def control(self):
        next(self.steps)

    def live(self, io, every):
        last = {}
        for step in count(1):
            news = [j for j in io.body.joints if j.name not in last or abs(j.position - last[j.name]) > 0.001]
            if step % every == 0 and news:
                message = JointState(name=[j.name for j in news], position=[j.position for j in news])
                message.header.stamp.sec, message.header.stamp.nanosec = divmod(io.time_ns, 10**9)
                last.update(zip(message.name, message.position))
                self.publisher.publish(message)
            yield


RIGHT = [WithArrays, Generator]
