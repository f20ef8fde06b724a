"""Fault 5: the publisher is best effort."""

import math
from contextlib import suppress

import tutorial  # comes before rclpy, and makes it importable
import rclpy
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from rclpy.qos import qos_profile_sensor_data
from sensor_msgs.msg import JointState


class Tank5(Node):
    def __init__(self):
        super().__init__("tank5")
        self.publisher = self.create_publisher(JointState, "/tank5/joint_state", qos_profile_sensor_data)
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
        rclpy.spin(Tank5())
