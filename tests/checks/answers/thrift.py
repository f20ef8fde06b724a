"""The exercise `thrift`: right answers in various styles."""

import numpy as np
from rclpy.time import Time
from sensor_msgs.msg import JointState

from tutorial.checks.thrift import ThriftyPublisher


class WithArrays(ThriftyPublisher):
    """Compare arrays, the first of which is far away."""

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


RIGHT = [WithArrays]
