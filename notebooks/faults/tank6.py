"""Fault 6: the publisher sends a single message, and keeps it for late subscribers."""

from contextlib import suppress

import tutorial  # comes before rclpy, and makes it importable
import rclpy
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile
from sensor_msgs.msg import JointState


class Tank6(Node):
    def __init__(self):
        super().__init__("tank6")
        kept = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
        self.publisher = self.create_publisher(JointState, "/tank6/joint_state", kept)
        self.publisher.publish(JointState(name=["TURRET_Y", "TURRET_P"], position=[1.0, 0.5]))
        self.get_logger().info("started")


if __name__ == "__main__":
    with suppress(KeyboardInterrupt, ExternalShutdownException):
        rclpy.init()
        rclpy.spin(Tank6())
