"""The exercise `gray`: every wrong answer is told its cause."""

from __future__ import annotations

import time
from array import array
from typing import ClassVar

import numpy as np
import pytest
from rclpy.time import Time
from sensor_msgs.msg import Image

from tutorial.checks.camera_publisher import GrayPublisher, gray
from tutorial.controller import SimpleController


class Base(SimpleController):
    """A right answer, cut so that each wrong one changes a line or two."""

    hz = 5

    def configure(self, config):
        self.node = config.node
        self.body = config.body
        self.publisher = self.node.create_publisher(Image, self.topic(config.body), 1)

    def topic(self, body):
        return f"{body.name}/camera/gray"

    def initialize(self, io):
        self.io = io
        self.camera = io.body.camera("CAMERA")
        self.steps_per_picture = round(1 / (self.hz * io.time_step))

    def control(self):
        if self.io.step % self.steps_per_picture == 0:
            self.camera.capture(self.publish, self.io.time_ns)

    def publish(self, pixels, time_ns):
        message = Image()
        message.header.stamp = Time(nanoseconds=self.stamp(time_ns)).to_msg()
        message.header.frame_id = self.camera.name
        message.height, message.width, _ = pixels.shape
        message.encoding = "mono8"
        message.step = message.width
        message.data = array("B", self.gray(pixels).astype(np.uint8).tobytes())
        self.change(message)
        self.publisher.publish(message)

    def stamp(self, time_ns):
        return time_ns

    def gray(self, pixels):
        return pixels.mean(axis=2)

    def change(self, message):
        pass

    def stop(self):
        self.camera.close()

    def unconfigure(self):
        self.node.destroy_publisher(self.publisher)


class Rounded(Base):
    def gray(self, pixels):
        return np.rint(pixels.mean(axis=2))


class WholeNumbers(Base):
    def gray(self, pixels):
        return pixels.sum(axis=2) // 3


class ByHand(Base):
    def change(self, message):
        message.data = array("B", list(message.data))


class KeepsTheTime(Base):
    """What was captured last is delivered next, as long as nothing is missed."""

    def control(self):
        if self.io.step % self.steps_per_picture == 0:
            self.time_ns = self.io.time_ns
            self.camera.capture(self.deliver)

    def deliver(self, pixels):
        self.publish(pixels, self.time_ns)


class Empty(Base):
    def change(self, message):
        message.data = array("B")


class InColour(Base):
    def gray(self, pixels):
        return pixels


class OnlyRed(Base):
    def gray(self, pixels):
        return pixels[:, :, 0]


class OnlyGreen(Base):
    def gray(self, pixels):
        return pixels[:, :, 1]


class Overflow(Base):
    def gray(self, pixels):
        return (pixels[:, :, 0] + pixels[:, :, 1] + pixels[:, :, 2]) // 3


class Sum(Base):
    def gray(self, pixels):
        return pixels.sum(axis=2)


class Brightest(Base):
    def gray(self, pixels):
        return pixels.max(axis=2)


class Median(Base):
    def gray(self, pixels):
        return np.median(pixels, axis=2)


class AsTheEye(Base):
    def gray(self, pixels):
        return pixels @ np.array([0.299, 0.587, 0.114])


class OfTheRows(Base):
    def gray(self, pixels):
        return pixels.mean(axis=0)


class OfAll(Base):
    def gray(self, pixels):
        return np.full(pixels.shape[:2], pixels.mean())


class Scaled(Base):
    def gray(self, pixels):
        return pixels.mean(axis=2) / 255


class Floats(Base):
    def publish(self, pixels, time_ns):
        self.floats = array("B", pixels.mean(axis=2).tobytes())
        super().publish(pixels, time_ns)

    def change(self, message):
        message.data = self.floats


class UpsideDown(Base):
    def gray(self, pixels):
        return pixels[::-1].mean(axis=2)


class Mirrored(Base):
    def gray(self, pixels):
        return pixels[:, ::-1].mean(axis=2)


class Transposed(Base):
    def gray(self, pixels):
        return pixels.mean(axis=2).T


class Negative(Base):
    def gray(self, pixels):
        return 255 - pixels.mean(axis=2)


class TheOneBefore(Base):
    before = None

    def gray(self, pixels):
        before, self.before = self.before, pixels
        return (pixels if before is None else before).mean(axis=2)


class NoEncoding(Base):
    def change(self, message):
        message.encoding = ""


class EncodingOfColour(Base):
    def change(self, message):
        message.encoding = "rgb8"


class CapitalLetters(Base):
    def change(self, message):
        message.encoding = "MONO8"


class StepOfColour(Base):
    def change(self, message):
        message.step = 3 * message.width


class NoStep(Base):
    def change(self, message):
        message.step = 0


class StepOfAll(Base):
    def change(self, message):
        message.step = message.width * message.height


class Exchanged(Base):
    def change(self, message):
        message.width, message.height = message.height, message.width


class TypedSize(Base):
    def change(self, message):
        message.width, message.height = 320, 240


class NoWidth(Base):
    def change(self, message):
        message.width = 0


class NoFrame(Base):
    def change(self, message):
        message.header.frame_id = ""


class NoStamp(Base):
    def stamp(self, time_ns):
        return 0


class Late(Base):
    def stamp(self, time_ns):
        return self.io.time_ns


class WallClock(Base):
    def stamp(self, time_ns):
        return time.time_ns()


class TenHertz(Base):
    hz = 10


class StepsForRate(Base):
    def initialize(self, io):
        super().initialize(io)
        self.steps_per_picture = 5


class TypedSteps(Base):
    def initialize(self, io):
        super().initialize(io)
        self.steps_per_picture = 200


class EveryStep(Base):
    def control(self):
        self.camera.capture(self.publish, self.io.time_ns)


class NeverCaptures(Base):
    def control(self):
        self.due = self.io.step % self.steps_per_picture == 0


class NeverPublishes(Base):
    def publish(self, pixels, time_ns):
        pass


class AtOnce(Base):
    def control(self):
        self.camera.capture(self.publish(None, 0), self.io.time_ns)

    def publish(self, pixels, time_ns):
        if pixels is not None:
            super().publish(pixels, time_ns)


class Displayed(Base):
    def initialize(self, io):
        super().initialize(io)
        self.camera = self.body.camera("CAMERA")


class TypedTopic(Base):
    def topic(self, body):
        return "Tank/camera/gray"


class Shared(Base):
    cameras: ClassVar[dict] = {}

    def initialize(self, io):
        super().initialize(io)
        self.cameras["steps"] = self.steps_per_picture

    def control(self):
        if self.io.step % self.cameras["steps"] == 0:
            self.camera.capture(self.publish, self.io.time_ns)


class NeverCloses(Base):
    def stop(self):
        pass


class StillThere(Base):
    def unconfigure(self):
        self.publisher = None


@pytest.mark.parametrize("answer", [GrayPublisher, Base, Rounded, WholeNumbers, ByHand, KeepsTheTime])
def test_right_answers_are_right(answer, domain):
    verdict = gray.judge(answer)
    assert verdict.right, str(verdict)


@pytest.mark.parametrize(
    ("answer", "cause"),
    [
        (Empty, "message.data is left out"),
        (InColour, "the picture is still in colour"),
        (OnlyRed, "only red is sent"),
        (OnlyGreen, "only green is sent"),
        (Overflow, "the sum is computed in bytes"),
        (Sum, "the sum is sent"),
        (Brightest, "the brightest of the three"),
        (Median, "the median of the three"),
        (AsTheEye, "the colours have weights"),
        (OfTheRows, "the mean is taken over the rows"),
        (OfAll, "the mean of the whole picture"),
        (Scaled, "divided by 255"),
        (Floats, "the bytes of floats, eight for a pixel"),
        (UpsideDown, "it is upside down"),
        (Mirrored, "left and right are exchanged"),
        (Transposed, "rows and columns are exchanged"),
        (Negative, "light and dark are exchanged"),
        (TheOneBefore, "it is the picture before"),
        (NoEncoding, "the encoding is left out"),
        (EncodingOfColour, "that of a picture in colour"),
        (CapitalLetters, "in small letters"),
        (StepOfColour, "the step of rgb8"),
        (NoStep, "message.step = message.width"),
        (StepOfAll, "that is the whole picture"),
        (Exchanged, "width and height are exchanged"),
        (TypedSize, "the size is typed"),
        (NoWidth, "one of them is left out"),
        (NoFrame, "message.header.frame_id = self.camera.name"),
        (NoStamp, "the stamp is left out"),
        (Late, "the time of delivery"),
        (WallClock, "the wall clock's time"),
        (TenHertz, "the rate of CameraPublisher"),
        (StepsForRate, "is taken for the number of steps"),
        (TypedSteps, "its time step"),
        (EveryStep, "publishes at every step"),
        (NeverCaptures, "capture is never called"),
        (NeverPublishes, "does not publish"),
        (AtOnce, "give it without parentheses, self.publish"),
        (TypedTopic, "The body's name is written into the topic"),
        (Shared, "shared by all objects of the class"),
        (NeverCloses, "in stop, self.camera.close()"),
        (StillThere, "unconfigure does not call"),
    ],
)
def test_a_wrong_answer_is_told_its_cause(answer, cause, domain):
    verdict = gray.judge(answer)
    assert not verdict.right
    assert cause in "\n".join(verdict.causes), str(verdict)


def test_the_displayed_bodys_camera_is_said_to_be_none(domain):
    assert "ask the simulated one, io.body" in str(gray.judge(Displayed))
