"""Step 4: publish what the inertial sensors of the simulated robot measure."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from geometry_msgs.msg import Vector3
from numpy.typing import NDArray
from rclpy.time import Time
from sensor_msgs.msg import Imu

from tutorial.controller import ControllerConfig, ControllerIO, SimpleController

RATE = 20  # [Hz], in simulation time


class ImuPublisher(SimpleController):
    """Publish acceleration [m/s^2] and angular velocity [rad/s] at 20 Hz: means of the steps since the last message."""

    def configure(self, config: ControllerConfig) -> None:  # main thread
        """Announce the topic, named after the body."""
        self.node = config.node
        self.publisher = self.node.create_publisher(Imu, f"{config.body.name}/imu", 1)

    def initialize(self, io: ControllerIO) -> None:  # simulation thread, before the first step
        """Look up the sensors of the simulated body."""
        self.io = io
        self.accelerometer = io.body.sensor("ACCEL_SENSOR")
        self.gyroscope = io.body.sensor("GYRO")
        self.steps_per_message = round(1 / (RATE * io.time_step))
        self.accelerations: list[NDArray[np.float64]] = []
        self.velocities: list[NDArray[np.float64]] = []

    def control(self) -> None:  # simulation thread, every step
        """Note what is measured; publish the means, when it is time to."""
        self.accelerations.append(self.accelerometer.value)
        self.velocities.append(self.gyroscope.value)
        if self.io.step % self.steps_per_message == 0:
            self.publisher.publish(self.imu())
            self.accelerations, self.velocities = [], []

    def imu(self) -> Imu:
        """Write the means down in one message, stamped with the simulation's time."""
        message = Imu()
        message.header.stamp = Time(nanoseconds=self.io.time_ns).to_msg()
        message.header.frame_id = f"{self.io.body.name}/base_link"
        message.linear_acceleration = mean(self.accelerations)
        message.angular_velocity = mean(self.velocities)
        message.orientation.w = 0.0  # which way it looks is not measured, and -1 in the first covariance says so
        message.orientation_covariance[0] = -1.0
        return message

    def unconfigure(self) -> None:  # main thread
        """Take the topic back."""
        self.node.destroy_publisher(self.publisher)


def mean(samples: Sequence[NDArray[np.float64]]) -> Vector3:
    """Take the mean of some measurements, each along x, y and z."""
    x, y, z = np.mean(samples, axis=0).tolist()
    return Vector3(x=x, y=y, z=z)
