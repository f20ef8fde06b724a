"""A driver that finishes: it lowers the camera, follows the nearest piece of the line, and then sweeps the barrel."""

import numpy as np
import rclpy
from rclpy.node import Node
from sensor_msgs.msg import Image, Joy

LOWER = 2  # pictures until the barrel, which carries the camera, is down
AHEAD = 8  # pictures from the last sight of the line to its end
SWEEP = 10  # pictures for a sweep of the turret to one side


class Good(Node):
    def __init__(self):
        super().__init__("driver")
        self.pictures = 0
        self.blind = 0  # pictures since the line was last seen
        self.publisher = self.create_publisher(Joy, "/joy", 1)
        self.subscription = self.create_subscription(Image, "/Tank/camera/image", self.on_image, 1)

    def on_image(self, message):
        pixels = np.frombuffer(message.data, np.uint8).reshape(message.height, message.width, 3)
        self.publisher.publish(Joy(axes=self.steer(pixels)))

    def steer(self, pixels):
        self.pictures += 1
        if self.pictures <= LOWER:
            return [0.0, 0.0, 0.0, -1.0]
        height, width, _ = pixels.shape
        red, green, blue = pixels.astype(int).transpose(2, 0, 1)
        yellow = (red > 150) & (green > 0.65 * red) & (blue < 0.3 * red)
        rows, columns = np.nonzero(yellow[height // 3 :])
        near = rows > rows.max(initial=0) - height // 10
        if near.sum() >= 5 and self.blind < AHEAD:
            self.blind = 0
            error = 1 - 2 * float(columns[near].mean()) / width  # 1 at the left edge, -1 at the right edge
            turn = min(max(2 * error, -1.0), 1.0)
            return [turn, 0.35 - 0.1 * abs(turn), 0.0, 0.0]
        self.blind += 1
        if self.blind < AHEAD:
            return [0.0, 0.25, 0.0, 0.0]
        side = -1.0 if self.blind < AHEAD + SWEEP else 1.0
        return [0.0, 0.0, side, 0.0]


def main():
    rclpy.init()
    rclpy.spin(Good())


if __name__ == "__main__":
    main()
