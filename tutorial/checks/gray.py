"""The exercise `gray`: publish gray pictures.

Write the controller `GrayPublisher`. It publishes an `Image` on the topic `camera/gray` of its body, 5 times per
simulated second, as near as whole steps allow: what the camera `CAMERA` sees, in gray. For the body `Tank` the
topic is `Tank/camera/gray`, without a slash in front: so it is in the namespace of the node.

- A pixel is one byte, the mean of its red, green and blue, rounded or cut off. The encoding for that is called
  `mono8`; `step` says how many bytes a row has.
- The stamp is the simulated time at which the picture was taken, the frame is the camera's name. A picture may come
  after the next one was asked for, or not at all.
- It works with pictures of any size, on any body that has such a camera, and with any time step.
- When the simulation stops, `stop` closes the camera; `unconfigure` has the node destroy the publisher.

Hint 1: Look at who does what: control only asks for a picture, in every two hundredth step. What is done with it is the
business of the function that it is delivered to.

Hint 2: In control have the camera capture a picture, and hand over the function that is to get it, and the simulated
time. In that function, which is given the pixels and that time, fill the message: height and width from pixels.shape,
one byte per pixel in each row.

Hint 3: self.camera.capture(self.publish, self.io.time_ns); then message.height, message.width, _ = pixels.shape;
message.step = message.width; message.data = array("B", pixels.mean(axis=2).astype(np.uint8).tobytes()); the stamp is
Time(nanoseconds=time_ns).to_msg().

Notice that the control loop never waits for a picture, and that gray costs a sixth of what colour did.
"""

from __future__ import annotations

from array import array
from collections.abc import Callable
from functools import cache, partial
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray
from rclpy.time import Time
from sensor_msgs.msg import Image

from tutorial.body import Body
from tutorial.checks._cases import call
from tutorial.checks._diagnose import AT_ONCE, Misuse
from tutorial.checks._publishing import Publishing, Told, told_stamps
from tutorial.checks._rig import Rig, Sent
from tutorial.checks.exercise import Exercise
from tutorial.controller import ControllerConfig, ControllerIO, SimpleController
from tutorial.errors import TutorialError

__all__ = ["GrayPublisher", "gray"]


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


MISTAKES = """
the camera is that of config.body, the displayed copy, of which no pictures are taken: ask the simulated one, io.body.
    self.node = config.node => self.node, self.shown = config.node, config.body
    io.body.camera( => self.shown.camera(

there are several messages for one picture: publish it once.
    self.publisher.publish(message) => self.publisher.publish(message) // self.publisher.publish(message)

message.data is left out: array('B', pixels.mean(axis=2).astype(np.uint8).tobytes()).
    message.data = => data =

message.data is given an array with rows: it takes one byte after the other, array('B', ....tobytes()).
    array("B", pixels.mean(axis=2).astype(np.uint8).tobytes()) => pixels.mean(axis=2).astype(np.uint8)

the picture is still in colour: take the mean over the last axis, pixels.mean(axis=2).
    pixels.mean(axis=2).astype => pixels.astype

only one colour is sent: take the mean of all three, pixels.mean(axis=2).
    pixels.mean(axis=2) => pixels[:, :, 0] => pixels[:, :, 1] => pixels[:, :, 2]

the sum is sent, or computed in bytes, which hold no more than 255: take the mean, pixels.mean(axis=2).
    pixels.mean(axis=2) => (pixels.sum(axis=2, dtype=np.uint8) / 3) => pixels.sum(axis=2)

that is the brightest, the darkest, halfway between them or the median of the three: here the mean is asked for.
    pixels.mean(axis=2) => pixels.max(axis=2) => pixels.min(axis=2) => np.median(pixels, axis=2)
    => (pixels.max(axis=2) / 2 + pixels.min(axis=2) / 2)

the colours have weights, as the eye has: here the plain mean is asked for.
    pixels.mean(axis=2) => (pixels @ np.array([0.299, 0.587, 0.114])) => (pixels @ np.array([0.2126, 0.7152, 0.0722]))
    => np.rint(pixels @ np.array([0.299, 0.587, 0.114]))

the mean is taken over the rows or columns: the colours are the last axis, pixels.mean(axis=2).
    axis=2 => axis=0 => axis=1

the mean is taken over the rows or columns: the colours are the last axis, pixels.mean(axis=2).
    message.height, message.width, _ = pixels.shape => message.height, message.width = pixels.mean(axis=2).shape
    axis=2 => axis=0 => axis=1

that is the mean of the whole picture: pixels.mean(axis=2) takes it pixel by pixel.
    pixels.mean(axis=2) => pixels.mean() => np.full(pixels.shape[:2], pixels.mean())

it is divided by 255: mono8 goes from 0 to 255, as the pixels do.
    pixels.mean(axis=2) => (pixels.mean(axis=2) / 255)

these are the bytes of floats, several for a pixel: .astype(np.uint8) comes before .tobytes().
    .astype(np.uint8) => .astype(np.float64) => .astype(np.float32)

it is upside down, or left and right are exchanged: the topmost row comes first, and begins on the left.
    pixels.mean(axis=2) => pixels[::-1].mean(axis=2) => pixels[:, ::-1].mean(axis=2) => pixels[::-1, ::-1].mean(axis=2)

rows and columns are exchanged: a picture is written row by row.
    pixels.mean(axis=2) => pixels.mean(axis=2).T

light and dark are exchanged: 255 is white.
    pixels.mean(axis=2) => (255 - pixels.mean(axis=2))

it is the picture before, or the first, again and again: send what is delivered, when it is.
    message = Image() => first, self.first = getattr(self, "first", pixels), pixels // message = Image()
    pixels.mean( => first.mean( => self.__dict__.setdefault("kept", pixels).mean(

the encoding is left out: message.encoding = "mono8".
    message.encoding = => encoding =

it is that of a picture in colour: of one byte for a pixel it is called "mono8".
    "mono8" => "rgb8" => "bgr8"

width and height are exchanged: pixels.shape is (height, width, 3).
    message.height, message.width, _ => message.width, message.height, _

width and height are exchanged: pixels.shape is (height, width, 3).
    message.height, message.width, _ => message.width, message.height, _
    message.step = message.width => message.step = message.height

width or height is left out: message.height, message.width, _ = pixels.shape.
    self.publisher.publish(message) => message.width = 0 // self.publisher.publish(message)
    => message.height = 0 // self.publisher.publish(message)

the size is typed: take it from pixels.shape, which is (height, width, 3).
    message.width, _ = pixels.shape => message.width = 240, 320

the size is typed: take it from pixels.shape, which is (height, width, 3).
    self.publisher.publish(message) => message.height, message.width = 240, 320 // self.publisher.publish(message)

step is that of rgb8, of the whole picture, or left out: it says how many bytes a row has, message.width.
    message.step = message.width => message.step = 3 * message.width => message.step = message.width * message.height
    => step = message.width

that is the time of delivery: the world has gone on meanwhile. Hand the time on, self.camera.capture(self.publish,
self.io.time_ns).
    nanoseconds=time_ns => nanoseconds=self.io.time_ns

the time is kept in one attribute, which the next request overwrites while a picture still waits. Hand the time on,
self.camera.capture(self.publish, self.io.time_ns).
    self.camera.capture(self => self.asked_ns = self.io.time_ns // self.camera.capture(self
    nanoseconds=time_ns => nanoseconds=self.asked_ns

the times wait in a row of their own, which is longer than that of the pictures when one is missed. Hand the time on,
self.camera.capture(self.publish, self.io.time_ns).
    self.io = io => self.io, self.times = io, []
    self.camera.capture(self => self.times.append(self.io.time_ns) // self.camera.capture(self
    nanoseconds=time_ns => nanoseconds=self.times.pop(0)

the pictures are counted for the stamp: one may be missed, so hand the time on, self.camera.capture(self.publish,
self.io.time_ns).
    self.io = io => self.io, self.count = io, -200_000_000
    message = Image() => message = Image() // self.count += 200_000_000
    nanoseconds=time_ns => nanoseconds=self.count

the frame is left out, or the body's: message.header.frame_id = self.camera.name.
    message.header.frame_id = self.camera.name => pass => message.header.frame_id = f"{self.io.body.name}/base_link"

the camera is not closed: in stop, self.camera.close().
    self.camera.close() => pass

the publisher is destroyed in stop, but made in configure: after a restart there is none. Destroy it in unconfigure.
    self.camera.close() => self.camera.close() // self.node.destroy_publisher(self.publisher)

the camera of the run before is kept: initialize is called at every start, and looks it up anew.
    io.body.camera("CAMERA") => self.__dict__.get("camera") or io.body.camera("CAMERA")
"""
STAMP = "Compare with Time(nanoseconds=time_ns).to_msg(), where time_ns is self.io.time_ns at the time of capture."
OTHERWISE = {
    "": "Compare with array('B', pixels.mean(axis=2).astype(np.uint8).tobytes()), one byte for each pixel, row by row.",
    "with steps of 1 ms": "Compare with self.camera.capture(self.publish, self.io.time_ns), in control, when io.step % "
    "steps_per_picture == 0, every round(1 / (5 * io.time_step)) steps. In publish, self.publisher.publish(message).",
    "the encoding": 'ROS 2 knows it by the name "mono8", in small letters.',
    "the size": "Compare with message.height, message.width, _ = pixels.shape.",
    "the row": "A row has as many bytes as pixels: message.step = message.width.",
    "the stamp": STAMP,
    "pictures that come late, or not at all": STAMP,
    "the frame": "Compare with message.header.frame_id = self.camera.name.",
    "after stop": "Most likely the camera is not closed: in stop, self.camera.close().",
}

SIZES = {"Rover": (8, 6), "Lift": (5, 7)}  # [px]


@cache
def picture(number: int, width: int, height: int) -> NDArray[np.uint8]:
    """Make a picture of which no two pixels are alike, and whose means have a third behind the point."""
    random = np.random.default_rng(number)
    grays = random.permutation(width * height) * 3 + 60
    tints = random.permuted([[40, -10, -29]] * len(grays), axis=1)
    made: NDArray[np.uint8] = (grays[:, np.newaxis] + tints).reshape(height, width, 3).astype(np.uint8)
    return made


class Camera:
    """Stands for a `tutorial.view.camera.Camera`.

    What a camera has not begins with an underscore, so that no learner is told of it.

    Args:
        body: the body that it is on.
        name: must be ``"CAMERA"``.
        take: is given the camera, a function and arguments whenever a picture is asked for.
    """

    def __init__(self, body: Body, name: str, take: Callable[..., None]) -> None:
        if name != "CAMERA":
            raise TutorialError(f"the body {body.name!r} has no camera {name!r}. Known are 'CAMERA'.")
        self.name, (self.width, self.height) = name, SIZES[body.name]
        self._take, self._is_open = take, True

    def capture(self, deliver: Any, *arguments: object) -> None:
        """Take an order."""
        if not callable(deliver):
            text = f"capture is given {deliver!r} in place of a function"
            raise Misuse(text, AT_ONCE.format("publish"))
        self._take(self, deliver, arguments)

    def close(self) -> None:
        """Deliver nothing more."""
        self._is_open = False


class Order(NamedTuple):
    """A picture that was asked for, at a step and a time [ns]."""

    step: int
    time_ns: int
    camera: Camera
    pixels: NDArray[np.uint8]
    deliver: Callable[[], None]


class CameraRig(Rig):
    """A rig with a camera, whose pictures come later, and on which some are missed.

    Args:
        answer: the learner's class.
        delay: how many steps a picture takes.
        missed: the numbers of those that never come.
        options: of `Rig`.

    Attributes:
        cameras: those that were asked for.
        orders: the pictures that were asked for since the start.
        delivered: those that have come.
    """

    def __init__(self, answer: type, delay: int = 0, missed: tuple[int, ...] = (), **options: Any) -> None:
        super().__init__(answer, after=self._deliver, **options)
        self._delay, self._missed = delay, missed
        self.cameras: list[Camera] = []
        self.body.find_camera = self._find

    def start(self, step: int = 0) -> None:
        """Begin to simulate."""
        self.orders: list[Order] = []
        self.delivered: list[Order] = []
        self._waiting: list[Order] = []
        super().start(step)

    def _find(self, body: Body, name: str) -> Camera:
        self.cameras.append(Camera(body, name, self._take))
        return self.cameras[-1]

    def _take(self, camera: Camera, deliver: Callable[..., None], arguments: tuple[object, ...]) -> None:
        pixels = picture(len(self.orders), camera.width, camera.height)
        order = Order(self.io.step, self.io.time_ns, camera, pixels, partial(call, deliver, pixels.copy(), *arguments))
        self._waiting += [order] * (len(self.orders) not in self._missed)
        self.orders.append(order)

    def _deliver(self) -> None:
        while self._waiting and self.io.step >= self._waiting[0].step + self._delay:
            order = self._waiting.pop(0)
            if order.camera._is_open:
                self.delivered.append(order)
                order.deliver()


def pictures(rig: CameraRig, sent: list[Sent]) -> Any:
    """Observe whether each message holds the picture that was delivered, in gray."""
    seen = [[*each.message.data] for each in sent]
    wanted = [order.pixels.mean(axis=2).astype(np.uint8).ravel().tolist() for order in rig.delivered]
    if seen == wanted:
        return "the pictures in gray"
    odd = next((i for i, (a, b) in enumerate(zip(seen, wanted)) if a != b), -1)
    return Told(f"{len(seen)} messages; one has {say(seen[odd])}, and the picture {say(wanted[odd])}", seen)


def say(data: list[int]) -> str:
    """Put bytes into words."""
    return f"{len(data)} bytes ({', '.join(map(str, data[:6]))}{', …' * (len(data) > 6)})"


PUBLISHING = Publishing(Image, "camera/gray", 5, CameraRig, pictures, "steps_per_picture", "time_ns")


def late(answer: type) -> Any:
    """Observe the stamps of pictures that come after the next one was asked for, or not at all."""
    rig = PUBLISHING.play(answer, 1.6, 7, (1,), delay=40, missed=(2,))
    times = [order.time_ns for order in rig.delivered]
    return told_stamps([(each.stamp_ns, time) for each, time in zip(PUBLISHING.messages(rig), times)])


def left_open(answer: type) -> str:
    """Observe whether cameras are open after the simulation has stopped."""
    number = sum(camera._is_open for camera in PUBLISHING.play(answer, 0.3).cameras)
    return f"pictures of {number or 'no'} camera are still delivered"


def last(look: Callable[[Any], str]) -> Callable[[Rig, list[Sent]], str]:
    """Look at the last message."""
    return lambda _rig, sent: look(sent[-1].message)


TRIED = {
    "what is sent": PUBLISHING.sent(0.7),
    "the size": PUBLISHING.sent(0.3, look=last(lambda message: f"width {message.width}, height {message.height}")),
    "the encoding": PUBLISHING.sent(0.3, look=last(lambda message: repr(message.encoding))),
    "the row": PUBLISHING.sent(0.3, look=last(lambda message: f"{message.step} bytes")),
    "the frame": PUBLISHING.sent(0.3, look=last(lambda message: repr(message.header.frame_id))),
    "pictures that come late, or not at all": late,
    "after stop": left_open,
}
CASES = PUBLISHING.cases(GrayPublisher, TRIED, MISTAKES, OTHERWISE)

PARTS = ("configure", "initialize", "control", "publish", "stop", "unconfigure")
gray = Exercise("gray", __doc__, CASES.judge, GrayPublisher, PARTS)
