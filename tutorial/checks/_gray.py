"""Looking at an answer to `gray`: whether each message holds the picture that was taken, in gray."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray
from sensor_msgs.msg import Image

from tutorial.checks._explain import Mistake, explain
from tutorial.checks._node import WatchedPublisher
from tutorial.checks._rate import SECOND, Rate, judge_source
from tutorial.checks._shared import SharedState
from tutorial.checks._studio import DELAY, Shot, Studio
from tutorial.checks._topics import endpoint, endpoint_on, judge_leaving
from tutorial.checks._verdict import Finding, judged, right, wrong
from tutorial.checks._watch import Failure
from tutorial.checks._world import World
from tutorial.controller import SimpleController
from tutorial.errors import TutorialError

__all__ = ["judge_gray"]

SIZE, OTHER_SIZE = (8, 6), (5, 7)  # [px]
SHOWN = 6  # bytes of a picture that are printed
RATE = Rate(
    hz=5,
    several="Most likely there are several messages for one picture: publish it once.",
    others={10: "Most likely that is the rate of CameraPublisher; here it is 5 Hz."},
)
MADE = "config.node.create_publisher(Image, topic, 1)"
NO_PICTURE = (
    "Most likely capture is never called: in control, when it is time to, "
    "self.camera.capture(self.publish, self.io.time_ns)."
)
NOT_SENT = "Most likely the function that pictures are delivered to does not publish: self.publisher.publish(message)."

BYTE = "array('B', pixels.mean(axis=2).astype(np.uint8).tobytes())"
MISTAKES = (
    Mistake("form", "empty", f"message.data is left out: {BYTE}."),
    Mistake("form", "colour", "the picture is still in colour: take the mean over the last axis, pixels.mean(axis=2)."),
    Mistake("form", "red", "only red is sent: take the mean of all three, pixels.mean(axis=2)."),
    Mistake("form", "green", "only green is sent: take the mean of all three, pixels.mean(axis=2)."),
    Mistake("form", "blue", "only blue is sent: take the mean of all three, pixels.mean(axis=2)."),
    Mistake(
        "form",
        "overflow",
        "the sum is computed in bytes, which begin at 0 again after 255: pixels.mean(axis=2) is not.",
    ),
    Mistake("form", "sum", "the sum is sent, and a byte holds no more than 255: take the mean, pixels.mean(axis=2)."),
    Mistake("form", "largest", "that is the brightest of the three: here the mean is asked for."),
    Mistake("form", "smallest", "that is the darkest of the three: here the mean is asked for."),
    Mistake("form", "median", "that is the median of the three: here the mean is asked for."),
    Mistake("form", "weighted", "the colours have weights, as the eye has: here the plain mean is asked for."),
    Mistake("form", "rows", "the mean is taken over the rows: the colours are the last axis, pixels.mean(axis=2)."),
    Mistake("form", "columns", "the mean is taken over the columns: the colours are the last axis, axis=2."),
    Mistake("form", "one", "that is the mean of the whole picture: pixels.mean(axis=2) takes it pixel by pixel."),
    Mistake("form", "scaled", "it is divided by 255: mono8 goes from 0 to 255, as the pixels do."),
    Mistake("wide", 8, "these are the bytes of floats, eight for a pixel: .astype(np.uint8) comes before .tobytes()."),
    Mistake("wide", 4, "these are the bytes of floats, four for a pixel: .astype(np.uint8) comes before .tobytes()."),
    Mistake("order", "flipped", "it is upside down: the topmost row comes first, here and in the message."),
    Mistake("order", "mirrored", "left and right are exchanged: a row begins on the left."),
    Mistake("order", "turned", "it is turned round: the topmost row comes first, and begins on the left."),
    Mistake("order", "transposed", "rows and columns are exchanged: a picture is written row by row."),
    Mistake("shown", "negative", "light and dark are exchanged: 255 is white."),
    Mistake("shot", "before", "it is the picture before: send what is delivered, when it is."),
    Mistake("shot", "first", "it is the first picture, again and again: send what is delivered, when it is."),
)
OTHERWISE = f"Compare with {BYTE}, which writes one byte for each pixel, row by row."

NO_ENCODING = 'Most likely the encoding is left out: message.encoding = "mono8".'
IN_COLOUR = 'Most likely it is that of a picture in colour: of one byte for a pixel it is called "mono8".'
OTHER_ENCODING = 'ROS 2 knows it by the name "mono8", in small letters.'
EXCHANGED = "Most likely width and height are exchanged: pixels.shape is (height, width, 3)."
NO_SIZE = "Most likely one of them is left out: message.height, message.width, _ = pixels.shape."
TYPED_SIZE = "Most likely the size is typed: take it from pixels.shape, which is (height, width, 3)."
STEP_OF_COLOUR = "Most likely that is the step of rgb8, three bytes for a pixel: mono8 has one, message.width in a row."
NO_STEP = "Most likely it is left out: message.step = message.width."
STEP_OF_ALL = "Most likely that is the whole picture: step is how many bytes a row has, message.width."
OTHER_STEP = "A row has as many bytes as pixels: message.step = message.width."
STAMP = "message.header.stamp = Time(nanoseconds=time_ns).to_msg()"
NO_STAMP = f"Most likely the stamp is left out: {STAMP}."
LATE_STAMP = (
    "Most likely that is the time of delivery: the world has gone on meanwhile. Hand the time on, "
    "self.camera.capture(self.publish, self.io.time_ns)."
)
WALL_CLOCK = "Most likely that is the wall clock's time: hand on the simulation's, self.io.time_ns."
OTHER_STAMP = f"Compare with {STAMP}, where time_ns is self.io.time_ns at the time of capture."
FRAME = "message.header.frame_id = self.camera.name"
NOT_CLOSED = "Most likely the camera is not closed: in stop, self.camera.close()."
TYPED = "Most likely something of the tank is typed, its name, its time step or its picture's size."
RESTART = "Most likely the camera of the run before is kept: initialize is called at every start, and looks it up anew."

Sent = Sequence[tuple[Image, Shot]]


class _Scene(World):
    """A world with a made-up camera."""

    def __init__(self, answer: type[SimpleController], size: tuple[int, int], **options: Any) -> None:
        self.studio = Studio(*size)
        super().__init__(answer, before=[self.studio], **options)
        self.body.find_camera = self.studio.camera

    def watch(self, publisher: WatchedPublisher) -> None:
        self.studio.sent = lambda: len(publisher.sent)

    def sent(self, publisher: WatchedPublisher) -> Sent:
        """Pair what was sent with the pictures in whose delivery it was."""
        return [(publisher.sent[s.first][0], s) for s in self.studio.shots if s.first < len(publisher.sent)]


def judge_gray(answer: type[SimpleController]) -> Iterator[Finding]:
    """Look at an answer to `gray`."""
    shared = SharedState(answer)
    with _Scene(answer, SIZE, name="Rover") as world:
        publisher = yield from endpoint_on(world.ros.node, WatchedPublisher, "/Rover/camera/gray", Image, MADE)
        if publisher is None:
            return
        world.watch(publisher)
        world.advance(1200)
        odd = judge_source(answer, world)
        if odd is not None:
            yield odd
            return
        if not publisher.sent:
            yield wrong("in 1.2 s, no message was sent", NOT_SENT if world.studio.shots else NO_PICTURE)
            return
        rate = RATE.judge(publisher, 0.001)
        yield rate
        all_right = yield from judged(_judge_messages(world.sent(publisher)))
        if not (all_right and rate.right):
            other = _Scene(answer, SIZE, name="Rover", time_step=0.002)
            yield from RATE.judge_step(other, "/Rover/camera/gray", Image, publisher, rate)
            return
        all_right = yield from judged(_judge_crane(answer, world, publisher, shared))
        if all_right:
            yield _judge_restart(world, publisher)
        yield from _judge_leaving(answer, world, publisher)


def _judge_messages(sent: Sent) -> Iterator[Finding]:
    if not sent:
        yield wrong("no message is sent when a picture is delivered", NOT_SENT)
        return
    message, shot = sent[-1]
    yield _judge_size(message, shot)
    yield _judge_encoding(message.encoding)
    yield _judge_row(message, shot)
    yield _judge_pixels(sent)
    yield _judge_stamps(sent)
    yield _judge_frame(message.header.frame_id)


def _judge_size(message: Image, shot: Shot) -> Finding:
    height, width, _ = shot.pixels.shape
    said = f"width {message.width}, height {message.height}"
    if (message.width, message.height) == (width, height):
        return right(said)
    text = f"{said}, of a picture that is {width} wide and {height} high"
    if (message.width, message.height) == (height, width):
        return wrong(text, EXCHANGED)
    return wrong(text, NO_SIZE if not message.width or not message.height else TYPED_SIZE)


def _judge_encoding(encoding: str) -> Finding:
    if encoding == "mono8":
        return right("the encoding is mono8")
    cause = NO_ENCODING if not encoding else IN_COLOUR if encoding in ("rgb8", "bgr8") else OTHER_ENCODING
    return wrong(f"the encoding is {encoding!r}, not 'mono8'", cause)


def _judge_row(message: Image, shot: Shot) -> Finding:
    height, width, _ = shot.pixels.shape
    if message.step == width:
        return right(f"a row has {message.step} bytes")
    known = {0: NO_STEP, 3 * width: STEP_OF_COLOUR, width * height: STEP_OF_ALL, 3 * width * height: STEP_OF_ALL}
    return wrong(
        f"step is {message.step}; a row of {width} pixels has {width} bytes", known.get(message.step, OTHER_STEP)
    )


def _judge_pixels(sent: Sent) -> Finding:
    """Compare what was sent with what was delivered."""
    pictures = [shot.pixels for _, shot in sent]
    seen = [tuple(map(float, message.data)) for message, _ in sent]
    expected = list(grays(pictures))
    odd = next((i for i, (got, wanted) in enumerate(zip(seen, expected)) if got != wanted), None)
    if odd is None:
        return right("each message holds the picture that was delivered, in gray")
    found = explain(seen, lambda **mistakes: grays(pictures, **mistakes), MISTAKES)
    text = f"message {odd + 1} has {_say(seen[odd])}; expected: {_say(expected[odd])}"
    return wrong(text, " ".join(f"Most likely {each.cause}" for each in found) if found else OTHERWISE)


def grays(
    pictures: Sequence[NDArray[np.uint8]],
    form: str = "mean",
    wide: int = 1,
    order: str = "right",
    shown: str = "as it is",
    shot: str = "newest",
) -> Iterator[tuple[float, ...]]:
    """Compute the bytes that are sent, right or with some mistakes.

    Args:
        pictures: what was delivered, each of the shape (height, width, 3).
        form, wide, order, shown, shot: the mistakes.
    """
    for i, newest in enumerate(pictures):
        pixels = {"newest": newest, "before": pictures[max(i - 1, 0)], "first": pictures[0]}[shot]
        turned = {
            "right": pixels,
            "flipped": pixels[::-1],
            "mirrored": pixels[:, ::-1],
            "turned": pixels[::-1, ::-1],
            "transposed": pixels.transpose(1, 0, 2),
        }[order]
        values = _formed(turned, form)
        if shown == "negative":
            values = 255 - values
        kind = {1: np.uint8, 4: np.float32, 8: np.float64}[wide]
        yield tuple(map(float, values.astype(kind).tobytes()))


def _formed(pixels: NDArray[np.uint8], form: str) -> NDArray[Any]:
    whole = pixels.astype(np.int64)
    forms: dict[str, Callable[[], NDArray[Any]]] = {
        "mean": lambda: whole.mean(axis=2),
        "empty": lambda: whole[:0],
        "colour": lambda: whole,
        "red": lambda: whole[:, :, 0],
        "green": lambda: whole[:, :, 1],
        "blue": lambda: whole[:, :, 2],
        "overflow": lambda: whole.sum(axis=2) % 256 // 3,
        "sum": lambda: whole.sum(axis=2),
        "largest": lambda: whole.max(axis=2),
        "smallest": lambda: whole.min(axis=2),
        "median": lambda: np.median(whole, axis=2),
        "weighted": lambda: whole @ np.array([0.299, 0.587, 0.114]),
        "rows": lambda: whole.mean(axis=0),
        "columns": lambda: whole.mean(axis=1),
        "one": lambda: np.full(whole.shape[:2], whole.mean()),
        "scaled": lambda: whole.mean(axis=2) / 255,
    }
    return forms[form]()


def _judge_stamps(sent: Sent) -> Finding:
    stamps = [m.header.stamp.sec * SECOND + m.header.stamp.nanosec for m, _ in sent]
    late = [stamp - shot.taken_ns for stamp, (_, shot) in zip(stamps, sent)]
    if all(abs(each) <= 2 for each in late):
        return right("the stamps are the simulated times at which the pictures were taken")
    if not any(stamps):
        return wrong("the stamps are 0", NO_STAMP)
    if min(stamps) > 1_000_000 * SECOND:
        return wrong("the stamps are not simulated time", WALL_CLOCK)
    if len(set(late)) == 1 and 0 < late[0] <= 2 * DELAY * 1_000_000:
        return wrong(f"the stamps are {late[0] / 1e6:g} ms too late", LATE_STAMP)
    return wrong("the stamps are not the times at which the pictures were taken", OTHER_STAMP)


def _judge_frame(frame: str) -> Finding:
    if frame == "CAMERA":
        return right("its frame is CAMERA")
    return wrong(f"the frame is {frame!r}, not 'CAMERA'", f"Compare with {FRAME}.")


def _judge_crane(
    answer: type[SimpleController], world: _Scene, publisher: WatchedPublisher, shared: SharedState
) -> Iterator[Finding]:
    """Look whether it works on another robot with another camera and time step, beside the first one."""
    when = "on the crane Lift, with another camera and steps of 2 ms"
    try:
        with _Scene(answer, OTHER_SIZE, model="crane", name="Lift", time_step=0.002) as lift:
            second = endpoint(lift.ros.node, WatchedPublisher, "/Lift/camera/gray", Image)
            if second is not None:
                lift.watch(second)
            for each, steps in ((lift, 130), (world, 130), (lift, 450)):
                each.advance(steps)
            if second is None or not second.sent:
                yield wrong(f"{when}, nothing is published on /Lift/camera/gray", shared.cause(TYPED))
                return
            findings = [RATE.judge(second, 0.002), *_judge_messages(lift.sent(second))]
    except Failure as failure:
        typed = isinstance(failure.error, (TutorialError, LookupError, ValueError))
        yield failure.finding(shared.cause(TYPED) if typed else None, when)
        return
    odd = [wrong(f"{when}, {each.text}", shared.cause(TYPED)) for each in findings if not each.right]
    first = (RATE.judge(publisher, 0.001), *_judge_messages(world.sent(publisher)))
    mixed = [each for each in first if not each.right]
    if odd:
        yield odd[0]
    elif mixed:
        yield wrong(f"two robots at the same time: {mixed[0].text}", shared.cause(mixed[0].cause))
    else:
        yield right(f"it works {when}, too")


def _judge_restart(world: _Scene, publisher: WatchedPublisher) -> Finding:
    """Look whether it goes on when the simulation begins anew."""
    when = "after a restart of the simulation"
    world.restart()
    publisher.sent.clear()
    world.studio.shots.clear()
    world.advance(250)
    if len(publisher.sent) < 2:
        return wrong(f"{when}, {('no message', '1 message')[len(publisher.sent)]} in 0.25 s", RESTART)
    odd = next((finding for finding in _judge_messages(world.sent(publisher)) if not finding.right), None)
    return right(f"{when} it begins anew") if odd is None else wrong(f"{when}, {odd.text}", RESTART)


def _judge_leaving(answer: type[SimpleController], world: _Scene, publisher: WatchedPublisher) -> Iterator[Finding]:
    """Look whether the camera is closed, too: its pictures would come to a publisher that is gone."""
    yield judge_leaving(answer, world.leave, publisher)
    if world.studio.open:
        yield wrong("after the simulation has stopped, pictures are still delivered", NOT_CLOSED)
    else:
        yield right("after the simulation has stopped, no picture is delivered")


def _say(numbers: tuple[float, ...]) -> str:
    first = ", ".join(f"{number:g}" for number in numbers[:SHOWN])
    return f"{len(numbers)} bytes" + (f" ({first}{', …' * (len(numbers) > SHOWN)})" if numbers else "")
