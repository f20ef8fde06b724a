"""The exercise `gray`: publish gray pictures."""

from __future__ import annotations

from array import array
from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from typing import Any

import numpy as np
from numpy.typing import NDArray
from rclpy.time import Time
from sensor_msgs.msg import Image

from tutorial.body import Body
from tutorial.checks._cases import Cases, call
from tutorial.checks._diagnose import AT_ONCE, Misuse
from tutorial.checks._publishing import NOTHING, Publishing, Told, say, stamps_of
from tutorial.checks._rig import Rig, elsewhere
from tutorial.checks._world import World
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

only red is sent: take the mean of all three, pixels.mean(axis=2).
    pixels.mean(axis=2) => pixels[:, :, 0]

only green is sent: take the mean of all three, pixels.mean(axis=2).
    pixels.mean(axis=2) => pixels[:, :, 1]

only blue is sent: take the mean of all three, pixels.mean(axis=2).
    pixels.mean(axis=2) => pixels[:, :, 2]

the sum is computed in bytes, which begin at 0 again after 255: pixels.mean(axis=2) is not.
    pixels.mean(axis=2) => (pixels.sum(axis=2, dtype=np.uint8) / 3)

the sum is sent, and a byte holds no more than 255: take the mean, pixels.mean(axis=2).
    pixels.mean( => pixels.sum(

that is the brightest of the three: here the mean is asked for.
    pixels.mean( => pixels.max(

that is the darkest of the three: here the mean is asked for.
    pixels.mean( => pixels.min(

that is halfway between the darkest and the brightest of the three: here the mean of all three is asked for.
    pixels.mean(axis=2) => (pixels.max(axis=2) / 2 + pixels.min(axis=2) / 2)

that is the median of the three: here the mean is asked for.
    pixels.mean(axis=2) => np.median(pixels, axis=2)

the colours have weights, as the eye has: here the plain mean is asked for.
    pixels.mean(axis=2) => (pixels @ np.array([0.299, 0.587, 0.114]))

the colours have weights, as the eye has: here the plain mean is asked for.
    pixels.mean(axis=2) => (pixels @ np.array([0.2126, 0.7152, 0.0722]))

the mean is taken over the rows: the colours are the last axis, pixels.mean(axis=2).
    axis=2 => axis=0

the mean is taken over the rows: the colours are the last axis, pixels.mean(axis=2).
    axis=2 => axis=0
    message.height, message.width, _ = pixels.shape => message.height, message.width = pixels.shape[1:]

the mean is taken over the columns: the colours are the last axis, axis=2.
    axis=2 => axis=1

the mean is taken over the columns: the colours are the last axis, axis=2.
    axis=2 => axis=1
    message.height, message.width, _ = pixels.shape => message.height, message.width = pixels.shape[::2]

that is the mean of the whole picture: pixels.mean(axis=2) takes it pixel by pixel.
    pixels.mean(axis=2) => pixels.mean()

that is the mean of the whole picture: pixels.mean(axis=2) takes it pixel by pixel.
    pixels.mean(axis=2) => np.full(pixels.shape[:2], pixels.mean())

that is the mean of the whole picture: pixels.mean(axis=2) takes it pixel by pixel.
    message.height, message.width, _ = pixels.shape => message.height, message.width = pixels.mean().shape

it is divided by 255: mono8 goes from 0 to 255, as the pixels do.
    pixels.mean(axis=2) => (pixels.mean(axis=2) / 255)

these are the bytes of floats, eight for a pixel: .astype(np.uint8) comes before .tobytes().
    .astype(np.uint8) => .astype(np.float64)

these are the bytes of floats, four for a pixel: .astype(np.uint8) comes before .tobytes().
    .astype(np.uint8) => .astype(np.float32)

it is upside down: the topmost row comes first, here and in the message.
    pixels.mean(axis=2) => pixels[::-1].mean(axis=2)

left and right are exchanged: a row begins on the left.
    pixels.mean(axis=2) => pixels[:, ::-1].mean(axis=2)

it is turned round: the topmost row comes first, and begins on the left.
    pixels.mean(axis=2) => pixels[::-1, ::-1].mean(axis=2)

rows and columns are exchanged: a picture is written row by row.
    pixels.mean(axis=2) => pixels.mean(axis=2).T

light and dark are exchanged: 255 is white.
    pixels.mean(axis=2) => (255 - pixels.mean(axis=2))

it is the picture before: send what is delivered, when it is.
    message = Image() => last, self.last = getattr(self, "last", pixels), pixels // message = Image()
    pixels.mean( => last.mean(

it is the first picture, again and again: send what is delivered, when it is.
    pixels.mean( => self.__dict__.setdefault("first", pixels).mean(

the encoding is left out: message.encoding = "mono8".
    message.encoding = => encoding =

it is that of a picture in colour: of one byte for a pixel it is called "mono8".
    "mono8" => "rgb8"

it is that of a picture in colour: of one byte for a pixel it is called "mono8".
    "mono8" => "bgr8"

width and height are exchanged: pixels.shape is (height, width, 3).
    message.height, message.width, _ => message.width, message.height, _

width and height are exchanged: pixels.shape is (height, width, 3).
    message.height, message.width, _ => message.width, message.height, _
    message.step = message.width => message.step = message.height

the width is left out: message.height, message.width, _ = pixels.shape.
    self.publisher.publish(message) => message.width = 0 // self.publisher.publish(message)

the height is left out: message.height, message.width, _ = pixels.shape.
    message.height, message.width, _ => _, message.width, _

the size is typed: take it from pixels.shape, which is (height, width, 3).
    message.width, _ = pixels.shape => message.width = 240, 320

the size is typed: take it from pixels.shape, which is (height, width, 3).
    self.publisher.publish(message) => message.height, message.width = 240, 320 // self.publisher.publish(message)

that is the step of rgb8, three bytes for a pixel: mono8 has one, message.width in a row.
    message.step = message.width => message.step = 3 * message.width

step is left out: message.step = message.width.
    message.step = => step =

that is the whole picture: step is how many bytes a row has, message.width.
    message.step = message.width => message.step = message.width * message.height

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

the frame is left out: message.header.frame_id = self.camera.name.
    message.header.frame_id = => frame_id =

the frame is the body's: message.header.frame_id = self.camera.name.
    message.header.frame_id = self.camera.name => message.header.frame_id = f"{self.io.body.name}/base_link"

the camera is not closed: in stop, self.camera.close().
    self.camera.close() => pass

the publisher is destroyed in stop, but made in configure: after a restart there is none. Destroy it in unconfigure.
    self.camera.close() => self.camera.close() // self.node.destroy_publisher(self.publisher)

the camera of the run before is kept: initialize is called at every start, and looks it up anew.
    io.body.camera("CAMERA") => self.__dict__.get("camera") or io.body.camera("CAMERA")
"""

STEPS = (
    "Compare with io.step % steps_per_picture == 0, in control, and steps_per_picture = round(1 / (5 * io.time_step))."
)
STAMP = "Compare with Time(nanoseconds=time_ns).to_msg(), where time_ns is self.io.time_ns at the time of capture."
OTHERWISE = {
    "": "Compare with array('B', pixels.mean(axis=2).astype(np.uint8).tobytes()), one byte for each pixel, row by row.",
    "on the body Rover": 'Compare with config.node.create_publisher(Image, f"{config.body.name}/camera/gray", 1).',
    "what is asked for": "Most likely capture is never called: in control, when it is time to, "
    "self.camera.capture(self.publish, self.io.time_ns).",
    "what is delivered": "Most likely the function that pictures are delivered to does not publish: "
    "self.publisher.publish(message).",
    "with steps of 1 ms": STEPS,
    "with steps of 2 ms": "Most likely the number of steps is written down for 1 ms: compute it from io.time_step.",
    "with steps of 3 ms": STEPS,
    "with steps of 6 ms": STEPS,
    "the encoding": 'ROS 2 knows it by the name "mono8", in small letters.',
    "the size": "Compare with message.height, message.width, _ = pixels.shape.",
    "the row": "A row has as many bytes as pixels: message.step = message.width.",
    "the stamp": STAMP,
    "pictures that come late, or not at all": STAMP,
    "the frame": "Compare with message.header.frame_id = self.camera.name.",
    "two robots in turns": "Most likely what is kept belongs to the class: make it in initialize, for each body.",
    "after a restart": "Most likely something of the run before is kept: initialize is called at every start.",
    "after stop": "Most likely the camera is not closed: in stop, self.camera.close().",
    "after unconfigure": "Compare with self.node.destroy_publisher(self.publisher), in unconfigure.",
}

SIZES = {"Rover": (8, 6), "Lift": (5, 7)}  # [px]


@cache
def picture(number: int, width: int, height: int) -> NDArray[np.uint8]:
    """Make a picture: no two pixels are alike, the means are whole, and most of three together are more than 255."""
    random = np.random.default_rng(number)
    grays = random.permutation(width * height) * 3 + 60
    tints = random.permuted([[40, -10, -30]] * len(grays), axis=1)  # their sum is 0
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
        self.name, (self.width, self.height), self.missed = name, SIZES[body.name], 0
        self._take, self._is_open = take, True

    def capture(self, deliver: Any, *arguments: object) -> None:
        """Take an order."""
        if not callable(deliver):
            text = f"capture is given {deliver!r} in place of a function"
            raise Misuse(text, AT_ONCE.format(name="publish"))
        self._take(self, deliver, arguments)

    def close(self) -> None:
        """Deliver nothing more."""
        self._is_open = False


@dataclass(frozen=True)
class Order:
    """A picture that was asked for, at a step and a time [ns]."""

    step: int
    time_ns: int
    camera: Camera
    deliver: Callable[..., None]
    arguments: tuple[object, ...]
    pixels: NDArray[np.uint8]


class Scene(Rig):
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
        super().__init__(answer, after=self._deliver, keep=keep, **options)
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
        self.orders.append(Order(self.io.step, self.io.time_ns, camera, deliver, arguments, pixels))
        if len(self.orders) - 1 not in self._missed:
            self._waiting.append(self.orders[-1])

    def _deliver(self) -> None:
        while self._waiting and self.io.step >= self._waiting[0].step + self._delay:
            order = self._waiting.pop(0)
            if order.camera._is_open:
                self.delivered.append(order)
                call(order.deliver, order.pixels.copy(), *order.arguments)


@dataclass(frozen=True)
class Kept:
    """What is looked at of a message."""

    size: tuple[int, int]
    encoding: str
    row: int
    frame: str
    data: tuple[float, ...]


def keep(message: Any) -> Kept | None:
    """Keep what is looked at of a message; nothing of any other kind."""
    if not isinstance(message, Image):
        return None
    size, frame = (message.width, message.height), message.header.frame_id
    return Kept(size, message.encoding, message.step, frame, tuple(message.data))


class Bytes:
    """The bytes of a message, equal to others that differ by no more than rounding."""

    __hash__ = None  # type: ignore[assignment]

    def __init__(self, data: Any) -> None:
        self.data = np.asarray(data, dtype=float)

    def __eq__(self, other: object) -> bool:
        return (
            isinstance(other, Bytes)
            and self.data.shape == other.data.shape
            and bool((abs(self.data - other.data) <= 1).all())
        )

    def __str__(self) -> str:
        return (
            f"{len(self.data)} bytes ({', '.join(f'{each:g}' for each in self.data[:6])}{', …' * (len(self.data) > 6)})"
        )


def pictures(rig: Scene) -> Any:
    """Observe whether each message holds the picture that was delivered, in gray."""
    seen = [Bytes(each.message.data) for each in PUBLISHING.messages(rig)]
    wanted = [Bytes(each.pixels.mean(axis=2).ravel()) for each in rig.delivered]
    if seen == wanted:
        return "the pictures in gray" if seen else NOTHING
    odd = next((i for i, (a, b) in enumerate(zip(seen, wanted)) if a != b), None)
    if odd is None:
        return f"{len(seen)} messages for {len(wanted)} pictures"
    return Told(f"message {odd + 1} has {seen[odd]}, and the picture {wanted[odd]}", seen)


NAMES = {"steps": "steps_per_picture", "time": "time_ns", "lesson": "CameraPublisher", "lesson_hz": 10}
PUBLISHING = Publishing(Image, "camera/gray", 5, Scene, pictures, NAMES)


def last(look: Callable[[Kept], str]) -> Callable[[type], str]:
    """Observe something of the last message."""

    def observe(answer: type) -> str:
        messages = PUBLISHING.messages(PUBLISHING.play(answer, 0.3))
        return look(messages[-1].message) if messages else NOTHING

    return observe


def stamps(answer: type, **options: Any) -> Any:
    """Observe the stamps of pictures that were taken with steps of 7 ms, 29 steps after each other."""
    rig = PUBLISHING.play(answer, 1.6, 7, begins=(1,), **options)
    return stamps_of((sent.stamp_ns, order.time_ns) for sent, order in zip(PUBLISHING.messages(rig), rig.delivered))


def asked(answer: type) -> str:
    """Observe whether pictures are asked for."""
    return "pictures" if PUBLISHING.play(answer, 0.5).orders else "no picture"


def sent(answer: type) -> Any:
    """Observe whether what is delivered is published."""
    rig = PUBLISHING.play(answer, 0.5)
    return "pictures are published" if PUBLISHING.messages(rig) or not rig.delivered else "nothing is published"


def left_open(answer: type) -> str:
    """Observe whether cameras are open after the simulation has stopped."""
    number = sum(camera._is_open for camera in PUBLISHING.play(answer, 0.3).cameras)
    return f"pictures of {number or 'no'} camera are still delivered"


def on_ros(answer: type) -> str:
    """Observe whether messages are sent, with rclpy's own node and another thread."""

    def take(camera: Camera, deliver: Callable[..., None], arguments: tuple[object, ...]) -> None:
        elsewhere(deliver, picture(0, camera.width, camera.height).copy(), *arguments)

    def prepare(world: World) -> None:
        world.body.find_camera = lambda body, name: Camera(body, name, take)

    return PUBLISHING.on_ros(answer, prepare)


CASES = Cases(
    GrayPublisher,
    {
        "on the body Rover": PUBLISHING.topics("/"),
        "in the namespace /lab": PUBLISHING.topics("/lab"),
        "what is asked for": asked,
        "what is delivered": sent,
        "with steps of 1 ms": PUBLISHING.rate(1),
        "what is sent": lambda answer: pictures(PUBLISHING.play(answer, 0.7)),
        "the size": last(lambda kept: "width {}, height {}".format(*kept.size)),
        "the encoding": last(lambda kept: repr(kept.encoding)),
        "the row": last(lambda kept: f"{kept.row} bytes"),
        "the frame": last(lambda kept: repr(kept.frame)),
        "the stamp": lambda answer: stamps(answer, delay=3),
        "pictures that come late, or not at all": lambda answer: stamps(answer, delay=40, missed=(2,)),
        "with steps of 2 ms": PUBLISHING.rate(2),
        "with steps of 3 ms": PUBLISHING.rate(3),
        "with steps of 6 ms": PUBLISHING.rate(6),
        "two robots in turns": PUBLISHING.two,
        "after a restart": PUBLISHING.restarted,
        "after stop": left_open,
        "after unconfigure": PUBLISHING.left,
        "on ROS 2": on_ros,
    },
    PUBLISHING.mistakes(MISTAKES),
    say,
    OTHERWISE,
)

gray = Exercise(
    name="gray",
    statement="""
    Write the controller `GrayPublisher`. It publishes an `Image` on the topic `camera/gray` of its body, 5 times per
    simulated second, as near as whole steps allow: what the camera `CAMERA` sees, in gray. For the body `Tank` the
    topic is `Tank/camera/gray`, without a slash in front: so it is in the namespace of the node.

    - A pixel is one byte, the mean of its red, green and blue, rounded or cut off. The encoding for that is called
      `mono8`; `step` says how many bytes a row has.
    - The stamp is the simulated time at which the picture was taken, the frame is the camera's name. A picture may come
      after the next one was asked for, or not at all.
    - It works with pictures of any size, on any body that has such a camera, and with any time step.
    - When the simulation stops, `stop` closes the camera; `unconfigure` destroys the publisher.
    """,
    judge=CASES.judge,
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
