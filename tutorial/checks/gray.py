"""The exercise `gray`: publish gray images.

Write the controller `GrayPublisher`. It publishes what the camera `CAMERA` sees, in gray: an `Image` on the topic
`camera/gray` of its body, 5 times per simulated second. For the body `Tank` the topic is `Tank/camera/gray`, without a
leading slash, so it is in the node's namespace.

- Request an image every 0.2 s, the first one at most 0.2 s after the start. If 0.2 s isn't a whole number of steps,
  either round the number of steps or keep the average rate exact. Publish every image that you get, even if it
  repeats the previous one.
- Each pixel is one byte: the average of its red, green and blue values, rounded or truncated. This encoding is called
  `mono8`. The field `step` is the number of bytes in a row.
- The stamp is the simulated time of the request. An image can arrive after the next request, or not at all. The frame
  is the camera's optical frame; for the body `Tank` it is `Tank/CAMERA_optical`.
- It works with images of any size, on any body that has such a camera, and with any time step.
- When the simulation stops, `stop` closes the camera. In `unconfigure`, the node destroys the publisher.

Hint 1: Look at who does what. control only requests an image, five times per simulated second. The function that
receives the image does everything else.

Hint 2: In control, have the camera capture an image. Call capture with two arguments: the function that will receive
the image, and the simulated time. That function receives the pixels and the time. It fills in the message's fields:
height and width come from pixels.shape, and each pixel is one byte.

Hint 3: self.camera.capture(self.publish, self.io.time_ns); then message.height, message.width, _ = pixels.shape;
message.step = message.width; message.data = array("B", pixels.mean(axis=2).astype(np.uint8).tobytes()); the stamp is
Time(nanoseconds=time_ns).to_msg().

Notice that the control loop never waits for an image. And gray images at half the rate need only a sixth of the
bandwidth of colour images.
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
from tutorial.checks.engine.cases import Case, Mistake, replace
from tutorial.checks.engine.exceptions import AT_ONCE
from tutorial.checks.engine.failure import Misuse
from tutorial.checks.engine.publishing import Publishing, compared, compared_stamps
from tutorial.checks.engine.rig import Rig, Sent
from tutorial.checks.engine.trial import Trial
from tutorial.checks.exercise import Exercise
from tutorial.controller import ControllerConfig, ControllerIO, SimpleController
from tutorial.errors import TutorialError


class GrayPublisher(SimpleController):
    """Publish the camera's images in gray, at 5 Hz."""

    def configure(self, config: ControllerConfig) -> None:
        """Create the publisher on a topic named after the body."""
        self.node = config.node
        self.publisher = self.node.create_publisher(Image, f"{config.body.name}/camera/gray", 1)

    def initialize(self, io: ControllerIO) -> None:
        """Look up the camera."""
        self.io = io
        self.camera = io.body.camera("CAMERA")
        self.steps_per_picture = round(1 / (5 * io.time_step))

    def control(self) -> None:
        """Request an image five times per simulated second."""
        if self.io.step % self.steps_per_picture == 0:
            self.camera.capture(self.publish, self.io.time_ns)

    def publish(self, pixels: NDArray[np.uint8], time_ns: int) -> None:
        """Publish an image. Called on the camera's thread."""
        message = Image()
        message.header.stamp = Time(nanoseconds=time_ns).to_msg()
        message.header.frame_id = f"{self.io.body.name}/{self.camera.name}_optical"
        message.height, message.width, _ = pixels.shape
        message.encoding = "mono8"
        message.step = message.width
        message.data = array("B", pixels.mean(axis=2).astype(np.uint8).tobytes())
        self.publisher.publish(message)

    def stop(self) -> None:
        """Close the camera, so that it delivers no more images."""
        self.camera.close()

    def unconfigure(self) -> None:
        """Destroy the publisher."""
        self.node.destroy_publisher(self.publisher)


MISTAKES = [
    Mistake("your code assigns a two-dimensional array to message.data, which "
            "has to be a flat array of bytes: array('B', ....tobytes()).",
            replace('array("B", pixels.mean(axis=2).astype(np.uint8).tobytes())',
                    "pixels.mean(axis=2).astype(np.uint8)")),
    Mistake("your code uses one colour, the sum or the wrong mean, or computes with "
            "bytes, which overflow and drop fractions: use pixels.mean(axis=2).",
            replace("pixels.mean(axis=2)", "pixels[:, :, 0]", "pixels[:, :, 1]", "pixels[:, :, 2]",
                    "pixels.sum(axis=2)", "(pixels.sum(axis=2, dtype=np.uint8) / 3)", "(pixels//3).sum(axis=2)",
                    "pixels.max(axis=2)", "pixels.min(axis=2)", "(pixels.max(axis=2) / 2 + pixels.min(axis=2) / 2)")),
    Mistake("your code weights the colours, as the eye does. This exercise "
            "asks for the plain mean, pixels.mean(axis=2).",
            replace("pixels.mean(axis=2)", "(pixels @ [0.299, 0.587, 0.114])",
                    "np.rint(pixels @ [0.299, 0.587, 0.114])")),
    Mistake("your code divides by 255. In mono8, white is 255, as in the camera's pixels.",
            replace("pixels.mean(axis=2)", "(pixels.mean(axis=2) / 255)")),
    Mistake("your code turns the image upside down, mirrors it, or swaps rows "
            "and columns: send the top row first, and each row from left to right.",
            replace("pixels.mean(axis=2)", "pixels[::-1].mean(axis=2)", "pixels[:, ::-1].mean(axis=2)",
                    "pixels[::-1, ::-1].mean(axis=2)", "pixels.mean(axis=2).T")),
]  # fmt: skip
MEANING = ("Compare your bytes with array('B', pixels.mean(axis=2).astype(np.uint8).tobytes()). "
           "The last axis holds the colours, and each pixel becomes one byte, row by row.")  # fmt: skip

Pixels = NDArray[np.uint8]  # (height, width, 3)
SIZES = {"Rover": (8, 6), "Lift": (5, 7)}  # [px]


@cache
def picture(number: int, width: int, height: int) -> Pixels:
    """Make an image whose pixels all differ; each pixel's mean is a whole number plus one third."""
    random = np.random.default_rng(number)
    grays = random.permutation(width * height) * 3 + 60
    tints = random.permuted([[40, -10, -29]] * len(grays), axis=1)
    made: Pixels = (grays[:, np.newaxis] + tints).reshape(height, width, 3).astype(np.uint8)
    return made


class Camera:
    """A stand-in for `tutorial.view.camera.Camera`.

    Attributes that a real camera lacks begin with an underscore, so that no error message suggests them to a learner.

    Args:
        rig: the camera's rig.
        body: the camera's body.
        name: must be ``"CAMERA"``.
    """

    def __init__(self, rig: "CameraRig", body: Body, name: str) -> None:
        if name != "CAMERA":
            raise TutorialError(f"the body {body.name!r} has no camera {name!r}. Known: 'CAMERA'.")
        self.name, (self.width, self.height) = name, SIZES[body.name]
        self._rig, self._is_open = rig, True
        rig.cameras.append(self)

    def capture(self, deliver: Any, *arguments: object) -> None:
        """Record the request and the call that will deliver its image."""
        if not callable(deliver):
            raise Misuse(f"capture gets {deliver!r} instead of a function", AT_ONCE.format("publish"))
        pixels = picture(0 if self._rig.is_still else len(self._rig.orders), self.width, self.height)
        self._rig.orders.append(
            (self._rig.io.step, self, pixels, partial(self._rig.trial.call, deliver, pixels.copy(), *arguments))
        )

    def close(self) -> None:
        """Stop delivering images."""
        self._is_open = False


class CameraRig(Rig):
    """A rig with a camera. Images can be late, and one of them can be missing.

    Args:
        trial: the trial that the rig belongs to.
        delay: the number of steps from a request to the delivery of its image.
        missed: the number of the image that is never delivered.
        is_still: whether all images are identical.
        options: the options for `Rig`.

    Attributes:
        cameras: the cameras that the learner has looked up.
        orders: the requests since the start, each with its step, its camera, the pixels, and a function that delivers
            the pixels.
        delivered: the delivered images, each with the step of its request.
    """

    def __init__(self, trial: Trial, delay: int = 0, missed: int = -1, is_still: bool = False, **options: Any) -> None:
        self.is_still = is_still
        super().__init__(trial, after=self._deliver, **options)
        self._delay, self._missed, self.cameras = delay, missed, list[Camera]()
        self.body.find_camera = partial(Camera, self)

    def start(self, step: int = 0) -> None:
        """Forget all requests and delivered images, and start the simulation."""
        self.orders = list[tuple[int, Camera, Pixels, Callable[[], None]]]()
        self.delivered = list[tuple[int, Pixels]]()
        super().start(step)

    def _deliver(self) -> None:
        for number, (step, camera, pixels, deliver) in enumerate(self.orders):
            if self.io.step == step + self._delay and number != self._missed and camera._is_open:
                self.delivered.append((step, pixels))
                deliver()


def pictures(rig: CameraRig, sent: list[Sent]) -> Any:
    """Observe whether each message contains the delivered image in gray."""
    seen = [[*each.message.data] for each in sent]
    wanted = [pixels.mean(axis=2).astype(np.uint8).ravel().tolist() for _, pixels in rig.delivered]
    return compared([*zip_longest(seen, wanted, fillvalue=[])], "the images in gray", word)


def word(data: list[int]) -> str:
    """Describe image data: the number of bytes, and the first six bytes."""
    return f"{len(data)} bytes ({', '.join(map(str, data[:6]))}{', …' * (len(data) > 6)})"


PUBLISHING = Publishing(Image, "camera/gray", 5, CameraRig, pictures, "time_ns")


def stamps(trial: Trial, **options: Any) -> Any:
    """Compare the stamps with the times of the requests, using steps of 7 ms."""
    rig = PUBLISHING.play(trial, 1.6, 7, (1,), **options)
    if len(rig.orders) < 7:
        return f"{len(rig.orders)} of 8 images are requested"
    pairs = zip(PUBLISHING.messages(rig), rig.delivered)
    return compared_stamps([(each.stamp_ns, step * 7_000_000) for each, (step, _) in pairs])


def left_open(trial: Trial) -> str:
    """Observe how many cameras are open after the simulation has stopped."""
    number = sum(camera._is_open for camera in PUBLISHING.play(trial, 0.3).cameras)
    is_or_are = "camera is" if number == 1 else "cameras are"
    return f"{number} {is_or_are} open" if number else "the camera is closed"


def still(trial: Trial) -> Any:
    """Observe how often identical images are sent."""
    return PUBLISHING.often(PUBLISHING.play(trial, 0.9, is_still=True))


def frame(frame_id: str) -> str:
    """Return the name of an image's frame. The camera's name alone is accepted instead of the optical frame's name."""
    return repr("Rover/CAMERA_optical" if frame_id == "CAMERA" else frame_id)


CASES = [
    Case("the content", PUBLISHING.sent(0.7)),
    Case("the size", PUBLISHING.sent(0.3, lambda _, sent: f"{sent[-1].message.width} x {sent[-1].message.height}"),
         "Your code probably swaps, omits or hard-codes width and height: "
         "message.height, message.width, _ = pixels.shape."),
    Case("the encoding", PUBLISHING.sent(0.3, lambda _, sent: repr(sent[-1].message.encoding)),
         "Your code probably omits the encoding, or sets the wrong one: "
         'the encoding with one byte per pixel is called "mono8", in lower case.'),
    Case("the row", PUBLISHING.sent(0.3, lambda _, sent: f"{sent[-1].message.step} bytes"),
         "Your code probably omits step, or counts three bytes per pixel: "
         "a row has message.step = message.width bytes."),
    Case("the frame", PUBLISHING.sent(0.3, lambda _, sent: frame(sent[-1].message.header.frame_id)),
         "Your code probably hard-codes or omits the body's name, or uses "
         'the wrong frame: f"{self.io.body.name}/{self.camera.name}_optical".'),
    Case("the stamp", stamps,
         "Your code probably doesn't stamp the image with the time of its request, or sets only sec or only nanosec. "
         "Call self.camera.capture(self.publish, self.io.time_ns), then set both sec and nanosec of the stamp."),
    Case("late and missing images", lambda trial: stamps(trial, delay=40, missed=2),
         "Your code probably skips some requests, or doesn't stamp each image with the time "
         "of its request. Pass that time along: self.camera.capture(self.publish, self.io.time_ns)."),
    Case("nothing moves, so all images are identical", still,
         "Your code probably skips an image that is identical to an earlier one. "
         "Publish every image: a repeated message is still a message."),
    Case("after stop", left_open, "Your code probably doesn't close the camera in stop, or looks it up more "
         "than once. Look up the camera once, in initialize, and call self.camera.close() in stop."),
]  # fmt: skip
PARTS = ("configure", "initialize", "control", "publish", "stop", "unconfigure")
gray = Exercise("gray", __doc__, PUBLISHING.cases(GrayPublisher, CASES, MISTAKES, MEANING), PARTS)
