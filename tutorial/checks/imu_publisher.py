"""The exercise of step 4: publish means of what a sensor measures."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from rclpy.time import Time
from sensor_msgs.msg import Imu

from tutorial.checks._mean import judge_gyro
from tutorial.checks.exercise import Exercise
from tutorial.controller import ControllerConfig, ControllerIO, SimpleController

__all__ = ["gyro"]


class GyroPublisher(SimpleController):
    """Publish the angular velocity at 10 Hz, the mean of the steps since the last message."""

    def configure(self, config: ControllerConfig) -> None:
        """Announce the topic, named after the body."""
        self.node = config.node
        self.publisher = self.node.create_publisher(Imu, f"{config.body.name}/gyro", 1)

    def initialize(self, io: ControllerIO) -> None:
        """Begin with nothing measured."""
        self.io = io
        self.sensor = io.body.sensor("GYRO")
        self.samples: list[NDArray[np.float64]] = []
        self.steps_per_message = round(1 / (10 * io.time_step))

    def control(self) -> None:
        """Note what is measured; publish the mean, when it is time to."""
        self.samples.append(self.sensor.value)
        if self.io.step % self.steps_per_message == 0:
            message = Imu()
            message.header.stamp = Time(nanoseconds=self.io.time_ns).to_msg()
            message.header.frame_id = f"{self.io.body.name}/base_link"
            velocity = message.angular_velocity
            velocity.x, velocity.y, velocity.z = np.mean(self.samples, axis=0).tolist()
            message.orientation_covariance[0] = -1.0
            message.linear_acceleration_covariance[0] = -1.0
            self.publisher.publish(message)
            self.samples.clear()

    def unconfigure(self) -> None:
        """Take the topic back."""
        self.node.destroy_publisher(self.publisher)


gyro = Exercise(
    name="gyro",
    statement="""
    Write the controller `GyroPublisher`, for a robot that has a gyroscope and no accelerometer. It publishes an `Imu`
    on the topic `gyro` of its body, which for the body `Tank` is `/Tank/gyro`, 10 times per simulated second.

    - Its angular velocity is the mean of what the sensor `GYRO` has measured, one value per step, since the last
      message; the first message has what there is.
    - What is not measured says so: -1 is the first number in the covariances of orientation and linear acceleration.
    - Its stamp is the simulated time at which it is sent, its frame `Tank/base_link`, with the body's name.
    - It works on any body that has such a sensor, and with any time step.
    - When it leaves the body it destroys its publisher, in `unconfigure`.
    """,
    judge=judge_gyro,
    solution=(GyroPublisher,),
    base=SimpleController,
    parts=("configure", "initialize", "control", "unconfigure"),
    requires=("configure", "initialize"),
    hints=(
        "Look at what happens how often: measuring in every step, sending in every hundredth. What is measured has to "
        "be kept from the one to the other.",
        "In initialize look up the sensor, and begin with an empty list. In control append the sensor's value, in "
        "every step; when it is time to, send the mean of the list, and empty it. Mark what is not measured.",
        "self.samples.append(self.sensor.value); then, if self.io.step % self.steps_per_message == 0, x, y, z = "
        "np.mean(self.samples, axis=0).tolist() go into message.angular_velocity, -1.0 into both covariances, "
        "message.orientation_covariance[0] = -1.0, and so on. Publish, then self.samples.clear().",
    ),
    notice="Notice that the mean of many measurements shakes less than any of them, and nothing between them is lost.",
)
