"""The exercise `gray`: right answers in various styles, and wrong ones."""

import queue
import threading
from functools import partial

import numpy as np
from rclpy.time import Time
from sensor_msgs.msg import Image

from tutorial.checks.gray import GrayPublisher


class SumsOfThirds(GrayPublisher):
    """Add thirds, count steps, and keep everything about a picture in one call."""

    def initialize(self, io):
        self.io, self.camera, self.left = io, io.body.camera("CAMERA"), 0

    def control(self):
        if self.left == 0:
            self.left = int(0.2 / self.io.time_step + 0.5)
            stamp = Time(seconds=self.io.time).to_msg()
            self.camera.capture(partial(self.publish_at, stamp))
        self.left -= 1

    def publish_at(self, stamp, pixels):
        message = Image(height=len(pixels), width=self.camera.width, step=self.camera.width, encoding="mono8")
        message.header.stamp, message.header.frame_id = stamp, f"{self.io.body.name}/CAMERA_optical"
        message.data = (pixels / 3).sum(axis=2).astype(np.uint8).ravel().tolist()
        self.publisher.publish(message)


class OnAWorker(GrayPublisher):
    """Publish delivered pictures on a thread, joined in stop; round, and begin late."""

    def initialize(self, io):
        super().initialize(io)
        self.pictures, self.due_ns = queue.Queue(), io.time_ns + 100_000_000
        self.worker = threading.Thread(target=self.work)
        self.worker.start()

    def control(self):
        if self.io.time_ns >= self.due_ns:
            self.due_ns += 200_000_000
            self.camera.capture(lambda pixels, time_ns: self.pictures.put((pixels, time_ns)), self.io.time_ns)

    def work(self):
        while (taken := self.pictures.get()) is not None:
            super().publish(np.rint(taken[0].astype(float)), taken[1])

    def stop(self):
        self.camera.close()
        self.pictures.put(None)
        self.worker.join()


RIGHT = [GrayPublisher, SumsOfThirds, OnAWorker]


class AtOnce(GrayPublisher):
    def control(self):
        self.camera.capture(self.publish(None, 0), self.io.time_ns)

    def publish(self, pixels, time_ns):
        pass


class Squared(GrayPublisher):
    def publish(self, pixels, time_ns):
        super().publish(np.sqrt((pixels.astype(float) ** 2)[:, :, :1]).repeat(3, axis=2) / 2, time_ns)


WRONG = [(AtOnce, "Pass it without parentheses: self.publish"), (Squared, "Compare your bytes with array('B'")]
