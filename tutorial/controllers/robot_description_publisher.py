"""Step 7: tell other programs what the robot looks like, and how it moves."""

from rclpy.qos import DurabilityPolicy, QoSProfile
from std_msgs.msg import String

from tutorial.controller import ControllerConfig, SimpleController
from tutorial.description.urdf import robot_description

FOR_LATECOMERS = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)


class RobotDescriptionPublisher(SimpleController):
    """Publish the body's URDF once. The topic is transient local, so even late subscribers receive the URDF."""

    def configure(self, config: ControllerConfig) -> None:  # main thread
        """Create the publisher, and publish the URDF. The topic is named after the body."""
        self.node = config.node
        self.publisher = self.node.create_publisher(String, f"{config.body.name}/robot_description", FOR_LATECOMERS)
        self.publisher.publish(String(data=robot_description(config.body)))

    def unconfigure(self) -> None:  # main thread
        """Destroy the publisher."""
        self.node.destroy_publisher(self.publisher)
