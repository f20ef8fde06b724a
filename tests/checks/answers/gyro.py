"""The exercise `gyro`: right answers in various styles, and wrong ones."""

import threading

import numpy as np
from rclpy.time import Time
from sensor_msgs.msg import Imu

from tutorial.checks.gyro import GyroPublisher, gyro

from . import edited


class CountsItsSteps(GyroPublisher):
    """Keep a running sum, reuse one message, and measure in the frame of the chassis that holds the sensor."""

    def initialize(self, io):
        self.io, self.sensor, self.message = io, io.body.sensor("GYRO"), Imu()
        self.message.header.frame_id = f"{io.body.name}/{'base_link' if 'TURRET_Y' in io.body.joint_names else 'GYRO'}"
        self.message.orientation_covariance[0] = self.message.linear_acceleration_covariance[0] = -1
        self.sum, self.count = np.zeros(3), np.int64(0)

    def control(self):
        self.sum = self.sum + self.sensor.value / 3
        self.count += 1
        if self.count == np.rint(0.1 / self.io.time_step):
            v = self.message.angular_velocity
            v.x, v.y, v.z = map(float, 3 * self.sum / self.count)
            self.message.header.stamp = Time(seconds=self.io.time).to_msg()
            self.publisher.publish(self.message)
            self.sum, self.count = np.zeros(3), 0


class AtATime(GyroPublisher):
    """Send every tenth of a second, at times computed by adding floats."""

    def initialize(self, io):
        super().initialize(io)
        self.due, self.steps_per_message = io.time + 0.05, 1

    def control(self):
        self.samples.append(self.sensor.value)
        if self.io.time >= self.due:
            self.due += 0.1
            kept, self.samples = self.samples, []
            self.publisher.publish(self.filled(kept))

    def filled(self, samples):
        message = Imu()
        message.header.stamp = Time(nanoseconds=self.io.time_ns).to_msg()
        message.header.frame_id = f"{self.io.body.name}/GYRO"
        v = message.angular_velocity
        v.x, v.y, v.z = (sum(each) / len(samples) for each in zip(*samples))
        message.orientation_covariance = [-1.0, *[0.0] * 8]
        message.linear_acceleration_covariance = np.full(9, -1.0)
        return message


RIGHT = [CountsItsSteps, AtATime]


class OnItsOwnThread(AtATime):
    def initialize(self, io):
        super().initialize(io)
        self.end = threading.Event()
        threading.Thread(target=self.work, daemon=True).start()

    def work(self):
        while not self.end.wait(0.1):
            self.publisher.publish(self.filled([self.sensor.value]))

    def control(self):
        self.last = self.sensor.value

    def stop(self):
        self.end.set()


WRONG = [
    (edited(gyro, ("{self.io.body.name}", "odom")), "omits the name of the body or the sensor"),
    (OnItsOwnThread, "publishes from a timer or a thread"),
]
