"""Fault 2: the messages have a different type."""

import math
from contextlib import suppress

import tutorial  # comes before rclpy, and makes it importable
import rclpy
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from std_msgs.msg import Float64MultiArray


class Tank2(Node):
    def __init__(self):
        super().__init__("tank2")
        self.publisher = self.create_publisher(Float64MultiArray, "/tank2/joint_state", 10)
        self.timer = self.create_timer(0.05, self.on_timer)
        self.get_logger().info("started")

    def on_timer(self):
        now = self.get_clock().now()
        angle = math.sin(now.nanoseconds / 1e9)
        message = Float64MultiArray(data=[angle, 0.3 + 0.3 * angle])
        self.publisher.publish(message)


if __name__ == "__main__":
    with suppress(KeyboardInterrupt, ExternalShutdownException):
        rclpy.init()
        rclpy.spin(Tank2())
