"""The exercise `gray`: publish gray pictures.

Write the controller `GrayPublisher`. It publishes an `Image` on the topic `camera/gray` of its body, 5 times per
simulated second, as nearly as whole steps allow: what the camera `CAMERA` sees, in gray. For the body `Tank` the
topic is `Tank/camera/gray`, without a slash in front, so it is in the namespace of the node.

- A pixel is one byte, the average of its red, green and blue, rounded or cut off. That encoding is called `mono8`;
  `step` says how many bytes a row has.
- The stamp is the simulated time at the moment of asking. The frame is the camera's optical frame, for the body `Tank`
  `Tank/CAMERA_optical`. A picture may come after you have asked for the next one, or not at all.
- It works with pictures of any size, on any body that has such a camera, and with any time step.
- When the simulation stops, `stop` closes the camera. In `unconfigure`, the node destroys the publisher.

Hint 1: Look at who does what: control only asks for a picture, in every two hundredth step. The function that gets
the picture does the rest.

Hint 2: In control have the camera capture a picture; pass the function that gets it, and the simulated time. In that
function, which gets the pixels and that time, fill the message: height and width from pixels.shape, one byte per
pixel in each row.

Hint 3: self.camera.capture(self.publish, self.io.time_ns); then message.height, message.width, _ = pixels.shape;
message.step = message.width; message.data = array("B", pixels.mean(axis=2).astype(np.uint8).tobytes()); the stamp is
Time(nanoseconds=time_ns).to_msg().

Notice that the control loop never waits for a picture, and that gray, half as often, needs a sixth of the bytes per
second that colour needs.
"""

from array import array
from collections.abc import Callable
from functools import cache, partial
from itertools import zip_longest
from typing import Any

import numpy as np
from numpy.typing import NDArray
from rclpy.time import Time
from sensor_msgs.msg import Image

from tutorial.body import Body
from tutorial.checks.exercise import AT_ONCE, Exercise, Misuse, Publishing, Rig, Sent, call, compared, compared_stamps
from tutorial.controller import ControllerConfig, ControllerIO, SimpleController
from tutorial.errors import TutorialError


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
        message.header.frame_id = f"{self.io.body.name}/{self.camera.name}_optical"
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
message.data is given an array with rows: it takes one byte after the other, array('B', ....tobytes()).
    array("B", pixels.mean(axis=2).astype(np.uint8).tobytes()) => pixels.mean(axis=2).astype(np.uint8)

it is one colour, the sum or another mean, or is cut off or computed in bytes before: take pixels.mean(axis=2).
    pixels.mean(axis=2) => pixels[:, :, 0] => pixels[:, :, 1] => pixels[:, :, 2] => pixels.sum(axis=2)
    => (pixels.sum(axis=2, dtype=np.uint8) / 3) => (pixels//3).sum(axis=2) => pixels.max(axis=2) => pixels.min(axis=2)
    => (pixels.max(axis=2) / 2 + pixels.min(axis=2) / 2)

it is weighted, as by the eye: here the plain mean is asked for, pixels.mean(axis=2).
    pixels.mean(axis=2) => (pixels @ [0.299, 0.587, 0.114]) => np.rint(pixels @ [0.299, 0.587, 0.114])

it is divided by 255: mono8 goes from 0 to 255, as the pixels do.
    pixels.mean(axis=2) => (pixels.mean(axis=2) / 255)

it is upside down or mirrored, or rows and columns are exchanged: the topmost row comes first, and begins on the left.
    pixels.mean(axis=2) => pixels[::-1].mean(axis=2) => pixels[:, ::-1].mean(axis=2) => pixels[::-1, ::-1].mean(axis=2)
    => pixels.mean(axis=2).T

#
Compare with array('B', pixels.mean(axis=2).astype(np.uint8).tobytes()): the last axis has the colours, and then each
pixel is one byte, row by row.

# the size
Width and height are exchanged, left out or typed: message.height, message.width, _ = pixels.shape.

# the encoding
The encoding is left out, or another: one byte for a pixel is called "mono8", in small letters.

# the row
Most likely step is left out, or that of colours: a row has message.step = message.width bytes.

# the stamp
Hand on the time of asking, self.camera.capture(self.publish, self.io.time_ns): the stamp is all of it, sec and nanosec.

# pictures that come late, or not at all
Ask for each at its time, and hand that time on: self.camera.capture(self.publish, self.io.time_ns).

# the frame
Most likely the body is typed, or it is no optical frame: it is f"{self.io.body.name}/{self.camera.name}_optical".

# after stop
Most likely the camera is not closed, or closed too late: in stop, self.camera.close().
"""

Pixels = NDArray[np.uint8]  # (height, width, 3)
SIZES = {"Rover": (8, 6), "Lift": (5, 7)}  # [px]


@cache
def picture(number: int, width: int, height: int) -> Pixels:
    """Make a picture of which no two pixels are alike, and whose means have a third behind the point."""
    random = np.random.default_rng(number)
    grays = random.permutation(width * height) * 3 + 60
    tints = random.permuted([[40, -10, -29]] * len(grays), axis=1)
    made: Pixels = (grays[:, np.newaxis] + tints).reshape(height, width, 3).astype(np.uint8)
    return made


class Camera:
    """Stands for a `tutorial.view.camera.Camera`.

    What a camera has not begins with an underscore, so that no learner is told of it.

    Args:
        rig: what it belongs to.
        body: the body that it is on.
        name: must be ``"CAMERA"``.
    """

    def __init__(self, rig: "CameraRig", body: Body, name: str) -> None:
        if name != "CAMERA":
            raise TutorialError(f"the body {body.name!r} has no camera {name!r}. Known are 'CAMERA'.")
        self.name, (self.width, self.height) = name, SIZES[body.name]
        self._rig, self._is_open = rig, True
        rig.cameras.append(self)

    def capture(self, deliver: Any, *arguments: object) -> None:
        """Take an order."""
        if not callable(deliver):
            raise Misuse(f"capture is given {deliver!r} in place of a function", AT_ONCE.format("publish"))
        pixels = picture(len(self._rig.orders), self.width, self.height)
        self._rig.orders.append((self._rig.io.step, self, pixels, partial(call, deliver, pixels.copy(), *arguments)))

    def close(self) -> None:
        """Deliver nothing more."""
        self._is_open = False


class CameraRig(Rig):
    """A rig with a camera, whose pictures come later, and on which some are missed.

    Args:
        answer: the learner's class.
        delay: how many steps a picture takes.
        missed: the number of one that never comes.
        options: of `Rig`.

    Attributes:
        cameras: those that were asked for.
        orders: the pictures that were asked for since the start: at which step, from which camera, the pixels, and what
            delivers them.
        delivered: those that have come, each with the step at which it was asked for.
    """

    def __init__(self, answer: type, delay: int = 0, missed: int = -1, **options: Any) -> None:
        super().__init__(answer, after=self._deliver, **options)
        self._delay, self._missed, self.cameras = delay, missed, list[Camera]()
        self.body.find_camera = partial(Camera, self)

    def start(self, step: int = 0) -> None:
        """Begin to simulate."""
        self.orders = list[tuple[int, Camera, Pixels, Callable[[], None]]]()
        self.delivered = list[tuple[int, Pixels]]()
        super().start(step)

    def _deliver(self) -> None:
        for number, (step, camera, pixels, deliver) in enumerate(self.orders):
            if self.io.step == step + self._delay and number != self._missed and camera._is_open:
                self.delivered.append((step, pixels))
                deliver()


def pictures(rig: CameraRig, sent: list[Sent]) -> Any:
    """Observe whether each message holds the picture that was delivered, in gray."""
    seen = [[*each.message.data] for each in sent]
    wanted = [pixels.mean(axis=2).astype(np.uint8).ravel().tolist() for _, pixels in rig.delivered]
    return compared([*zip_longest(seen, wanted, fillvalue=[])], "the pictures in gray", word)


def word(data: list[int]) -> str:
    """Put bytes into words."""
    return f"{len(data)} bytes ({', '.join(map(str, data[:6]))}{', …' * (len(data) > 6)})"


PUBLISHING = Publishing(Image, "camera/gray", 5, CameraRig, pictures, "time_ns")


def stamps(answer: type, **options: Any) -> Any:
    """Observe the stamps, with steps of 7 ms, beside the times of asking."""
    rig = PUBLISHING.play(answer, 1.6, 7, (1,), **options)
    if len(rig.orders) < 7:
        return f"{len(rig.orders)} of 8 are asked for"
    pairs = zip(PUBLISHING.messages(rig), rig.delivered)
    return compared_stamps([(each.stamp_ns, step * 7_000_000) for each, (step, _) in pairs])


def left_open(answer: type) -> str:
    """Observe whether cameras are open after the simulation has stopped."""
    number = sum(camera._is_open for camera in PUBLISHING.play(answer, 0.3).cameras)
    return f"pictures of {number or 'no'} camera are still delivered"


def frame(frame_id: str) -> str:
    """Say in which frame a picture is; the camera's name alone counts, too."""
    return repr("Rover/CAMERA_optical" if frame_id == "CAMERA" else frame_id)


TRIED = {
    "what is sent": PUBLISHING.sent(0.7),
    "the size": PUBLISHING.sent(0.3, lambda _, sent: f"{sent[-1].message.width} x {sent[-1].message.height}"),
    "the encoding": PUBLISHING.sent(0.3, lambda _, sent: repr(sent[-1].message.encoding)),
    "the row": PUBLISHING.sent(0.3, lambda _, sent: f"{sent[-1].message.step} bytes"),
    "the frame": PUBLISHING.sent(0.3, lambda _, sent: frame(sent[-1].message.header.frame_id)),
    "the stamp": stamps,
    "pictures that come late, or not at all": lambda answer: stamps(answer, delay=40, missed=2),
    "after stop": left_open,
}
PARTS = ("configure", "initialize", "control", "publish", "stop", "unconfigure")
gray = Exercise("gray", __doc__, PUBLISHING.cases(GrayPublisher, TRIED, MISTAKES), PARTS)
