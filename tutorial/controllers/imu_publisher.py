"""Step 4: publish what the inertial sensors of the simulated robot measure."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray
from rclpy.time import Time
from sensor_msgs.msg import Imu

from tutorial.controller import ControllerConfig, ControllerIO, SimpleController

RATE = 20  # [Hz], in simulation time


class ImuPublisher(SimpleController):
    """Publish the mean acceleration [m/s^2] and angular velocity [rad/s] since the last message, at 20 Hz."""

    def configure(self, config: ControllerConfig) -> None:  # main thread
        """Create the publisher. Its topic is named after the body."""
        self.node = config.node
        self.publisher = self.node.create_publisher(Imu, f"{config.body.name}/imu", 10)

    def initialize(self, io: ControllerIO) -> None:  # simulation thread, before the first step
        """Look up the sensors of the simulated body."""
        self.io = io
        self.sensors = io.body.sensor("ACCEL_SENSOR"), io.body.sensor("GYRO")
        self.samples: list[list[NDArray[np.float64]]] = []
        self.steps_per_message = round(1 / (RATE * io.time_step))

    def control(self) -> None:  # simulation thread, every step
        """Record the sensors' values; publish the averages when a message is due."""
        self.samples.append([sensor.value for sensor in self.sensors])
        if self.io.step % self.steps_per_message == 0:
            message = imu(*np.mean(self.samples, axis=0).tolist())
            message.header.stamp = Time(nanoseconds=self.io.time_ns).to_msg()
            message.header.frame_id = f"{self.io.body.name}/GYRO"
            self.publisher.publish(message)
            self.samples.clear()

    def unconfigure(self) -> None:  # main thread
        """Destroy the publisher."""
        self.node.destroy_publisher(self.publisher)


def imu(acceleration: Sequence[float], velocity: Sequence[float]) -> Imu:
    """Return a message with acceleration [m/s^2] and angular velocity [rad/s], each (3,), but no orientation."""
    message = Imu()
    a, w = message.linear_acceleration, message.angular_velocity
    a.x, a.y, a.z = acceleration
    w.x, w.y, w.z = velocity
    message.orientation.w = 0.0
    message.orientation_covariance[0] = -1.0
    return message
