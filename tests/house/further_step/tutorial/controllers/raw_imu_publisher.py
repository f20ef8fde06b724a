"""Step N: publish what the simulated robot's inertial sensors measure."""

from __future__ import annotations

from geometry_msgs.msg import Vector3
from rclpy.time import Time
from sensor_msgs.msg import Imu

from tutorial.controller import ControllerConfig, ControllerIO, SimpleController

RATE = 50  # [Hz], in simulation time


class RawImuPublisher(SimpleController):
    """Publish acceleration [m/s^2] and angular velocity [rad/s] at 50 Hz."""

    def configure(self, config: ControllerConfig) -> None:  # main thread
        """Announce the topic, named after the body."""
        self.node = config.node
        self.publisher = self.node.create_publisher(Imu, f"{config.body.name}/raw_imu", 1)

    def initialize(self, io: ControllerIO) -> None:  # simulation thread, before the first step
        """Find the sensors of the simulated body."""
        self.io = io
        self.acceleration = io.body.data.sensor(f"{io.body.name}/ACCEL_SENSOR").data
        self.angular_velocity = io.body.data.sensor(f"{io.body.name}/GYRO").data
        self.steps_per_message = round(1 / (RATE * io.time_step))

    def control(self) -> None:  # simulation thread, every step
        """Publish, when it is time to."""
        if self.io.step % self.steps_per_message == 0:
            self.publisher.publish(self.imu())

    def imu(self) -> Imu:
        """Write the measurements down in one message, stamped with the simulation's time."""
        message = Imu()
        message.header.stamp = Time(nanoseconds=self.io.time_ns).to_msg()
        message.orientation_covariance[0] = -1.0  # ROS 2's way to say that the orientation is not measured
        message.linear_acceleration = Vector3(**dict(zip("xyz", self.acceleration.tolist())))
        message.angular_velocity = Vector3(**dict(zip("xyz", self.angular_velocity.tolist())))
        return message

    def unconfigure(self) -> None:  # main thread
        """Take the topic back."""
        self.node.destroy_publisher(self.publisher)
