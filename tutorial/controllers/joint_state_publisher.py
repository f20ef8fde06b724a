"""Step 2: publish the joint states of the simulated robot."""

from rclpy.time import Time
from sensor_msgs.msg import JointState

from tutorial.controller import ControllerConfig, ControllerIO, SimpleController

RATE = 50  # [Hz], in simulation time


class JointStatePublisher(SimpleController):
    """Publish the position [rad], velocity [rad/s] and effort [N.m] of every joint at 50 Hz."""

    def configure(self, config: ControllerConfig) -> None:  # main thread
        """Create the publisher. Its topic is named after the body."""
        self.node = config.node
        self.publisher = self.node.create_publisher(JointState, f"{config.body.name}/joint_state", 1)

    def initialize(self, io: ControllerIO) -> None:  # simulation thread, before the first step
        """Look up the joints of the simulated body."""
        self.io = io
        self.joints = io.body.joints
        self.steps_per_message = round(1 / (RATE * io.time_step))

    def control(self) -> None:  # simulation thread, every step
        """Publish when a message is due."""
        if self.io.step % self.steps_per_message == 0:
            self.publisher.publish(self.joint_state())

    def joint_state(self) -> JointState:
        """Return a message with the states of all joints, stamped with the simulated time."""
        message = JointState()
        message.header.stamp = Time(nanoseconds=self.io.time_ns).to_msg()
        message.name = [joint.name for joint in self.joints]
        message.position = [joint.position for joint in self.joints]
        message.velocity = [joint.velocity for joint in self.joints]
        message.effort = [joint.effort for joint in self.joints]
        return message

    def unconfigure(self) -> None:  # main thread
        """Destroy the publisher."""
        self.node.destroy_publisher(self.publisher)
