"""The exercise `publish`: right answers in various styles, and wrong ones."""

from array import array

from rclpy.qos import qos_profile_sensor_data
from sensor_msgs.msg import JointState

from tutorial.checks.publish import SlowPublisher, publish

from . import edited


class OneMessage(SlowPublisher):
    """Refill one message with arrays, and publish with best effort."""

    def configure(self, config):
        self.node, self.message = config.node, JointState(name=list(config.body.joint_names))
        topic = "/".join([config.body.name, "turret"])
        self.publisher = self.node.create_publisher(JointState, topic, qos_profile_sensor_data)

    def control(self):
        if self.io.step % self.steps_per_message:
            return
        stamp = self.message.header.stamp
        stamp.sec, stamp.nanosec = divmod(self.io.time_ns, 10**9)
        for field in ("position", "velocity", "effort"):
            setattr(self.message, field, array("d", (getattr(joint, field) for joint in self.joints)))
        self.publisher.publish(self.message)


RIGHT = [OneMessage]


class OneForEachJoint(SlowPublisher):
    def control(self):
        for joint in self.io.body.joints:
            self.joints = [joint]
            super().control()


class DestroysInStop(SlowPublisher):
    stop = SlowPublisher.unconfigure


OTHER = "self.node.create_publisher(JointState, 'other', 1)"
WRONG = [
    (edited(publish, ('f"', 'f"/')), "without a leading slash"),
    (edited(publish, ("self.publisher =", f"{OTHER}\nself.publisher =")), "each time the simulation starts"),
    (edited(publish, ("self.io = io", "self.io = io\nself.node.create_timer(0.04, print)")), "a timer or a thread"),
    (type("A", (SlowPublisher,), {"unconfigure": lambda a: a.node.destroy_subscription(a.publisher)}), "destroy_publ"),
    (DestroysInStop, "destroys the publisher in stop"),
    (OneForEachJoint, "a message for each joint"),
]
