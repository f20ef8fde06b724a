"""Step 7: publish the pose of the simulated robot."""

from geometry_msgs.msg import TransformStamped, Vector3
from nav_msgs.msg import Odometry
from rclpy.time import Time
from tf2_msgs.msg import TFMessage

from tutorial.controller import ControllerConfig, ControllerIO, SimpleController

RATE = 50  # [Hz], in simulation time


class PosePublisher(SimpleController):
    """Publish the pose of the body's root in the frame ``odom`` at 50 Hz, both as a transform and as odometry."""

    def configure(self, config: ControllerConfig) -> None:  # main thread
        """Create a publisher for ``/tf``, which all robots share, and one for the body's own topic."""
        self.node = config.node
        self.tf_publisher = self.node.create_publisher(TFMessage, "/tf", 100)
        self.odom_publisher = self.node.create_publisher(Odometry, f"{config.body.name}/odom", 10)

    def initialize(self, io: ControllerIO) -> None:  # simulation thread, before the first step
        """Store `io`, and compute the number of steps per message."""
        self.io = io
        self.steps_per_message = round(1 / (RATE * io.time_step))

    def control(self) -> None:  # simulation thread, every step
        """Publish when a message is due."""
        if self.io.step % self.steps_per_message == 0:
            message = odometry(self.io)
            self.odom_publisher.publish(message)
            self.tf_publisher.publish(TFMessage(transforms=[transform(message)]))

    def unconfigure(self) -> None:  # main thread
        """Destroy the publishers."""
        self.node.destroy_publisher(self.tf_publisher)
        self.node.destroy_publisher(self.odom_publisher)


def odometry(io: ControllerIO) -> Odometry:
    """Return the pose and the velocity of the body's root, stamped with the simulated time.

    As the message's definition requires, the pose [m] is in the parent frame, and the velocity [m/s, rad/s] is in the
    child frame. The covariances stay zero, because the simulated pose and velocity are exact.
    """
    message = Odometry()
    message.header.stamp = Time(nanoseconds=io.time_ns).to_msg()
    message.header.frame_id, message.child_frame_id = "odom", f"{io.body.name}/base_link"
    p, q = message.pose.pose.position, message.pose.pose.orientation
    p.x, p.y, p.z = io.body.position.tolist()
    q.w, q.x, q.y, q.z = io.body.orientation_wxyz.tolist()
    v, w = message.twist.twist.linear, message.twist.twist.angular
    v.x, v.y, v.z, w.x, w.y, w.z = io.body.twist.tolist()
    return message


def transform(message: Odometry) -> TransformStamped:
    """Return the pose of an odometry message as a transform from its child frame to its parent frame."""
    p, q = message.pose.pose.position, message.pose.pose.orientation
    stamped = TransformStamped(header=message.header, child_frame_id=message.child_frame_id)
    stamped.transform.translation = Vector3(x=p.x, y=p.y, z=p.z)
    stamped.transform.rotation = q
    return stamped
