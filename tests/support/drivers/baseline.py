"""The notebook's baseline: it steers towards the yellow at the bottom of the picture, and does nothing else."""

import numpy as np
import rclpy
from rclpy.node import Node
from sensor_msgs.msg import Image, Joy


class Baseline(Node):
    def __init__(self):
        super().__init__("driver")
        self.publisher = self.create_publisher(Joy, "/joy", 1)
        self.subscription = self.create_subscription(Image, "/Tank/camera/image", self.on_image, 1)

    def on_image(self, message):
        pixels = np.frombuffer(message.data, np.uint8).reshape(message.height, message.width, 3)
        self.publisher.publish(Joy(axes=self.steer(pixels)))

    def yellow(self, pixels):
        red, green, blue = pixels.astype(int).transpose(2, 0, 1)
        return (red > 150) & (green > 0.7 * red) & (blue < 0.25 * red)

    def steer(self, pixels):
        height, width, _ = pixels.shape
        columns = np.nonzero(self.yellow(pixels)[3 * height // 4 :])[1]
        if len(columns) == 0:
            return [0.0, 0.0, 0.0, 0.0]
        error = 1 - 2 * float(columns.mean()) / width  # 1 at the left edge, -1 at the right edge
        return [error, 0.25, 0.0, 0.0]


if __name__ == "__main__":
    rclpy.init()
    rclpy.spin(Baseline())
