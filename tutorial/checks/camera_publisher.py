"""The exercise of step 6: publish gray pictures."""

from __future__ import annotations

from array import array

import numpy as np
from numpy.typing import NDArray
from rclpy.time import Time
from sensor_msgs.msg import Image

from tutorial.checks._gray import judge_gray
from tutorial.checks.exercise import Exercise
from tutorial.controller import ControllerConfig, ControllerIO, SimpleController

__all__ = ["gray"]


class GrayPublisher(SimpleController):
    """Publish what the camera sees in gray, at 5 Hz: a third of the bytes, and half as often."""

    def configure(self, config: ControllerConfig) -> None:
        """Announce the topic, named after the body."""
        self.node = config.node
        self.publisher = self.node.create_publisher(Image, f"{config.body.name}/camera/gray", 1)

    def initialize(self, io: ControllerIO) -> None:
        """Look up the camera."""
        self.io = io
        self.camera = io.body.camera("CAMERA")
        self.steps_per_picture = round(1 / (5 * io.time_step))

    def control(self) -> None:
        """Have a picture taken, when it is time to."""
        if self.io.step % self.steps_per_picture == 0:
            self.camera.capture(self.publish, self.io.time_ns)

    def publish(self, pixels: NDArray[np.uint8], time_ns: int) -> None:
        """Publish a picture, on the camera's thread."""
        message = Image()
        message.header.stamp = Time(nanoseconds=time_ns).to_msg()
        message.header.frame_id = self.camera.name
        message.height, message.width, _ = pixels.shape
        message.encoding = "mono8"
        message.step = message.width
        message.data = array("B", pixels.mean(axis=2).astype(np.uint8).tobytes())
        self.publisher.publish(message)

    def stop(self) -> None:
        """Have no picture delivered any more."""
        self.camera.close()

    def unconfigure(self) -> None:
        """Take the topic back."""
        self.node.destroy_publisher(self.publisher)


gray = Exercise(
    name="gray",
    statement="""
    Write the controller `GrayPublisher`. It publishes an `Image` on the topic `camera/gray` of its body, which for the
    body `Tank` is `/Tank/camera/gray`, 5 times per simulated second: what the camera `CAMERA` sees, in gray.

    - A pixel is one byte, the mean of its red, green and blue. The encoding for that is called `mono8`; `step` says how
      many bytes a row has.
    - The stamp is the simulated time at which the picture was taken, the frame is the camera's name.
    - It works with pictures of any size, on any body that has such a camera, and with any time step.
    - When the simulation stops, `stop` closes the camera; `unconfigure` destroys the publisher.
    """,
    judge=judge_gray,
    solution=(GrayPublisher,),
    base=SimpleController,
    parts=("configure", "initialize", "control", "publish", "stop", "unconfigure"),
    requires=("configure", "initialize"),
    hints=(
        "Look at who does what: control only asks for a picture, in every two hundredth step. What is done with it is "
        "the business of the function that it is delivered to.",
        "In control have the camera capture a picture, and hand over the function that is to get it, and the simulated "
        "time. In that function, which is given the pixels and that time, fill the message: height and width from "
        "pixels.shape, one byte per pixel in each row.",
        "self.camera.capture(self.publish, self.io.time_ns); then message.height, message.width, _ = pixels.shape; "
        "message.step = message.width; message.data = "
        'array("B", pixels.mean(axis=2).astype(np.uint8).tobytes()); the stamp is Time(nanoseconds=time_ns).to_msg().',
    ),
    notice="Notice that the control loop never waits for a picture, and that gray costs a sixth of what colour did.",
)
