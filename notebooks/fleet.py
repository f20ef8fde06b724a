"""A node that swings the turrets of a fleet: it publishes for Tank_1, Tank_2 and so on, 50 times a second each."""

import math
import sys

import tutorial  # comes first: it makes rclpy and the messages importable

# isort: split
import rclpy
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from sensor_msgs.msg import JointState


class Fleet(Node):
    def __init__(self, count):
        super().__init__("fleet")
        topics = [f"/Tank_{number}/joint_state" for number in range(1, count + 1)]
        self.turrets = [self.create_publisher(JointState, topic, 1) for topic in topics]
        self.timer = self.create_timer(0.02, self.on_timer)

    def on_timer(self):
        now = self.get_clock().now()
        message = JointState(name=["TURRET_Y", "TURRET_P"])
        message.header.stamp = now.to_msg()
        for i, turret in enumerate(self.turrets):
            angle = math.sin(now.nanoseconds / 1e9 + 0.3 * i)  # each a little ahead of the one before it
            message.position = [angle, 0.1 * angle]
            turret.publish(message)


def main():
    try:
        rclpy.init()
        rclpy.spin(Fleet(int(sys.argv[1])))
    except (KeyboardInterrupt, ExternalShutdownException):
        pass


if __name__ == "__main__":
    main()
