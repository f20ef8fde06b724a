"""Step 6: publish what the camera of the simulated robot sees."""

from array import array

import numpy as np
from numpy.typing import NDArray
from rclpy.time import Time
from sensor_msgs.msg import Image

from tutorial.controller import ControllerConfig, ControllerIO, SimpleController

RATE = 10  # [Hz], in simulation time


class CameraPublisher(SimpleController):
    """Publish images at 10 Hz. The control loop only requests images; another thread renders and publishes them."""

    def configure(self, config: ControllerConfig) -> None:  # main thread
        """Create the publisher. Its topic is named after the body."""
        self.node = config.node
        self.publisher = self.node.create_publisher(Image, f"{config.body.name}/camera/image", 1)

    def initialize(self, io: ControllerIO) -> None:  # simulation thread, before the first step
        """Look up the camera of the simulated body."""
        self.io = io
        self.camera = io.body.camera("CAMERA")
        self.steps_per_picture = round(1 / (RATE * io.time_step))

    def control(self) -> None:  # simulation thread, every step
        """Request an image when one is due."""
        if self.io.step % self.steps_per_picture == 0:
            self.camera.capture(self.publish, self.io.time_ns)

    def publish(self, pixels: NDArray[np.uint8], time_ns: int) -> None:  # camera's thread
        """Publish an image, stamped with the simulated time of its request [ns]."""
        message = image(pixels)
        message.header.stamp = Time(nanoseconds=time_ns).to_msg()
        message.header.frame_id = f"{self.io.body.name}/{self.camera.name}_optical"
        self.publisher.publish(message)

    def stop(self) -> None:  # one of the simulation's threads, after the last step
        """Close the camera, so that no more images arrive."""
        self.camera.close()

    def unconfigure(self) -> None:  # main thread
        """Destroy the publisher."""
        self.node.destroy_publisher(self.publisher)


def image(pixels: NDArray[np.uint8]) -> Image:
    """Return an image message with the pixels, shape (height, width, 3), row by row from the top."""
    message = Image()
    message.height, message.width, _ = pixels.shape
    message.encoding = "rgb8"
    message.step = 3 * message.width
    message.data = array("B", pixels.tobytes())
    return message
