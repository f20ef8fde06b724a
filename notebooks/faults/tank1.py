"""Fault 1: the topic has a different name."""

import math
from contextlib import suppress

import tutorial  # comes before rclpy, and makes it importable
import rclpy
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from sensor_msgs.msg import JointState


class Tank1(Node):
    def __init__(self):
        super().__init__("tank1")
        self.publisher = self.create_publisher(JointState, "/Tank1/joint_state", 10)
        self.timer = self.create_timer(0.05, self.on_timer)
        self.get_logger().info("started")

    def on_timer(self):
        now = self.get_clock().now()
        angle = math.sin(now.nanoseconds / 1e9)
        message = JointState(name=["TURRET_Y", "TURRET_P"], position=[angle, 0.3 + 0.3 * angle])
        message.header.stamp = now.to_msg()
        self.publisher.publish(message)


if __name__ == "__main__":
    with suppress(KeyboardInterrupt, ExternalShutdownException):
        rclpy.init()
        rclpy.spin(Tank1())
