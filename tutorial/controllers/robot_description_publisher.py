"""Beside step 7: tell other programs what the robot looks like, and how it moves."""

from __future__ import annotations

from rclpy.qos import DurabilityPolicy, QoSProfile
from std_msgs.msg import String

from tutorial.controller import ControllerConfig, SimpleController
from tutorial.description.urdf import robot_description

FOR_LATECOMERS = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)


class RobotDescriptionPublisher(SimpleController):
    """Publish the body as URDF. Once: whoever subscribes later is sent the last message, which is the only one."""

    def configure(self, config: ControllerConfig) -> None:  # main thread
        """Announce the topic, named after the body, and publish."""
        self.node = config.node
        self.publisher = self.node.create_publisher(String, f"{config.body.name}/robot_description", FOR_LATECOMERS)
        self.publisher.publish(String(data=robot_description(config.body)))

    def unconfigure(self) -> None:  # main thread
        """Take the topic back."""
        self.node.destroy_publisher(self.publisher)
