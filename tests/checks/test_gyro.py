"""The exercise `gyro`: every wrong answer is told its cause."""

from __future__ import annotations

import time
from typing import ClassVar

import numpy as np
import pytest
from rclpy.time import Time
from sensor_msgs.msg import Imu

from tutorial.checks.imu_publisher import GyroPublisher, gyro
from tutorial.controller import SimpleController


class Base(SimpleController):
    """A right answer, cut so that each wrong one changes a line or two."""

    hz = 10

    def configure(self, config):
        self.node = config.node
        self.body = config.body
        self.publisher = self.node.create_publisher(Imu, self.topic(config.body), 1)

    def topic(self, body):
        return f"{body.name}/gyro"

    def initialize(self, io):
        self.io = io
        self.sensor = io.body.sensor("GYRO")
        self.samples = []
        self.steps_per_message = round(1 / (self.hz * io.time_step))

    def control(self):
        self.samples.append(self.sensor.value)
        if self.due():
            self.publisher.publish(self.message())
            self.samples = []

    def due(self):
        return self.io.step % self.steps_per_message == 0

    def message(self):
        message = Imu()
        message.header.stamp = Time(nanoseconds=self.io.time_ns).to_msg()
        message.header.frame_id = self.frame()
        v = message.angular_velocity
        v.x, v.y, v.z = map(float, self.velocity())
        self.mark(message)
        return message

    def frame(self):
        return f"{self.io.body.name}/base_link"

    def velocity(self):
        return np.mean(self.samples, axis=0)

    def mark(self, message):
        message.orientation_covariance[0] = -1.0
        message.linear_acceleration_covariance[0] = -1.0

    def unconfigure(self):
        self.node.destroy_publisher(self.publisher)


class RunningSum(Base):
    """Adds up instead of keeping a list."""

    def initialize(self, io):
        super().initialize(io)
        self.sum, self.count = np.zeros(3), 0

    def control(self):
        self.sum += self.sensor.value
        self.count += 1
        if self.due():
            self.publisher.publish(self.message())
            self.sum, self.count = np.zeros(3), 0

    def velocity(self):
        return self.sum / self.count


class CountsSamples(Base):
    def due(self):
        return len(self.samples) == self.steps_per_message


class Statistics(Base):
    def velocity(self):
        return [sum(sample[i] for sample in self.samples) / len(self.samples) for i in range(3)]


class FixedDivisor(Base):
    """The first measurement is 0, so its message is right, too."""

    def velocity(self):
        return np.sum(self.samples, axis=0) / self.steps_per_message


class Newest(Base):
    def velocity(self):
        return self.samples[-1]


class Oldest(Base):
    def velocity(self):
        return self.samples[0]


class Sum(Base):
    def velocity(self):
        return np.sum(self.samples, axis=0)


class Median(Base):
    def velocity(self):
        return np.median(self.samples, axis=0)


class NeverCleared(Base):
    def control(self):
        self.samples.append(self.sensor.value)
        if self.due():
            self.publisher.publish(self.message())


class MeasuresAfterwards(Base):
    def control(self):
        if self.due():
            self.publisher.publish(self.message())
            self.samples = []
        self.samples.append(self.sensor.value)

    def velocity(self):
        return np.mean(self.samples, axis=0) if self.samples else self.sensor.value


class Accelerometer(Base):
    def initialize(self, io):
        super().initialize(io)
        self.sensor = io.body.sensor("ACCEL_SENSOR")


class Exchanged(Base):
    def velocity(self):
        return super().velocity()[::-1]


class OnlyZ(Base):
    def velocity(self):
        return 0.0, 0.0, super().velocity()[2]


class Negated(Base):
    def velocity(self):
        return -super().velocity()


class Degrees(Base):
    def velocity(self):
        return np.degrees(super().velocity())


class NothingIn(Base):
    def velocity(self):
        return np.zeros(3)


class MeanOfAll(Base):
    def velocity(self):
        return [np.mean(self.samples)] * 3


class OrientationUnmarked(Base):
    def mark(self, message):
        message.linear_acceleration_covariance[0] = -1.0


class AccelerationUnmarked(Base):
    def mark(self, message):
        message.orientation_covariance[0] = -1.0


class AllMarked(Base):
    def mark(self, message):
        super().mark(message)
        message.angular_velocity_covariance[0] = -1.0


class NoFrame(Base):
    def frame(self):
        return ""


class TypedFrame(Base):
    def frame(self):
        return "Tank/base_link"


class TypedTopic(Base):
    def topic(self, body):
        return "Tank/gyro"


class TwentyHertz(Base):
    hz = 20


class StepsForRate(Base):
    def initialize(self, io):
        super().initialize(io)
        self.steps_per_message = 10


class TypedSteps(Base):
    def initialize(self, io):
        super().initialize(io)
        self.steps_per_message = 100


class WallClock(Base):
    def message(self):
        message = super().message()
        message.header.stamp = Time(nanoseconds=time.time_ns()).to_msg()
        return message


class Shared(Base):
    samples: ClassVar[list] = []

    def initialize(self, io):
        kept = type(self).samples
        super().initialize(io)
        self.samples = kept

    def control(self):
        self.samples.append(self.sensor.value)
        if self.due():
            self.publisher.publish(self.message())
            self.samples.clear()


class KeptFromTheRunBefore(Base):
    def configure(self, config):
        super().configure(config)
        self.kept = []

    def initialize(self, io):
        super().initialize(io)
        self.samples = self.kept

    def control(self):
        self.samples.append(self.sensor.value)
        if self.due():
            self.publisher.publish(self.message())
            self.samples.clear()


class EveryStep(Base):
    def due(self):
        return True


class Displayed(Base):
    def initialize(self, io):
        super().initialize(io)
        self.sensor = self.body.sensor("GYRO")


class StillThere(Base):
    def unconfigure(self):
        self.publisher = None


@pytest.mark.parametrize("answer", [GyroPublisher, Base, RunningSum, CountsSamples, Statistics, FixedDivisor])
def test_right_answers_are_right(answer, domain):
    verdict = gyro.judge(answer)
    assert verdict.right, str(verdict)


@pytest.mark.parametrize(
    ("answer", "cause"),
    [
        (Newest, "the newest measurement alone is sent"),
        (Oldest, "the oldest measurement alone is sent"),
        (Sum, "the sum is sent"),
        (Median, "that is the median"),
        (NeverCleared, "measurements of the messages before count, too"),
        (MeasuresAfterwards, "the step's own measurement comes too late"),
        (Accelerometer, "that is the accelerometer"),
        (Exchanged, "x, y and z are exchanged"),
        (OnlyZ, "only z is sent"),
        (Negated, "the sign is turned round"),
        (Degrees, "it is in degrees"),
        (NothingIn, "message.angular_velocity is left out"),
        (MeanOfAll, "component by component"),
        (OrientationUnmarked, "orientation_covariance[0] is still 0"),
        (AccelerationUnmarked, "linear_acceleration_covariance[0] is still 0"),
        (AllMarked, "all three are marked"),
        (NoFrame, "the frame is left out"),
        (TypedFrame, "the body's name is typed"),
        (TypedTopic, "The body's name is written into the topic"),
        (TwentyHertz, "the rate of ImuPublisher"),
        (StepsForRate, "is taken for the number of steps"),
        (TypedSteps, "its time step"),
        (WallClock, "the wall clock's time"),
        (Shared, "shared by all objects of the class"),
        (KeptFromTheRunBefore, "measurements of the run before are kept"),
        (EveryStep, "publishes at every step"),
        (Displayed, "the displayed copy"),
        (StillThere, "unconfigure does not call"),
    ],
)
def test_a_wrong_answer_is_told_its_cause(answer, cause, domain):
    verdict = gyro.judge(answer)
    assert not verdict.right
    assert cause in "\n".join(verdict.causes), str(verdict)
