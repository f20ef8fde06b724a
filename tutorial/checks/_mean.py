"""Looking at an answer to `gyro`: whether each message holds the mean of what was measured since the one before."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from math import sin
from typing import Any

import numpy as np
from numpy.typing import NDArray
from sensor_msgs.msg import Imu

from tutorial.checks._explain import Mistake, Probe, judge_probes
from tutorial.checks._node import WatchedPublisher
from tutorial.checks._rate import Rate, judge_source, judge_stamps, steps_of
from tutorial.checks._shared import SharedState
from tutorial.checks._topics import endpoint, endpoint_on, judge_leaving
from tutorial.checks._verdict import Finding, judged, right, wrong
from tutorial.checks._watch import Failure
from tutorial.checks._world import World
from tutorial.controller import ControllerIO, SimpleController
from tutorial.errors import TutorialError

__all__ = ["judge_gyro"]

Samples = dict[str, list[NDArray[np.float64]]]

SENSORS = ("GYRO", "ACCEL_SENSOR")
DISPLAYED = (0.7, 0.8, 0.9)  # [rad/s] what the displayed copy's gyroscope says
SHOWN = 6  # messages that are looked at
RATE = Rate(
    hz=10,
    several="Most likely there is a message for each measurement: one holds the mean of them all.",
    others={20: "Most likely that is the rate of ImuPublisher; here it is 10 Hz."},
)
MADE = "config.node.create_publisher(Imu, topic, 1)"

CLEAR = "begin anew after each message, self.samples.clear()"
MISTAKES = (
    Mistake("sent", "nothing", "message.angular_velocity is left out."),
    Mistake("method", "last", "the newest measurement alone is sent: note one in every step, and take their mean."),
    Mistake("method", "first", "the oldest measurement alone is sent: take the mean of all since the last message."),
    Mistake("method", "sum", "the sum is sent: divide it by how many measurements it has."),
    Mistake("method", "median", "that is the median: here the mean is asked for."),
    Mistake("method", "largest", "that is the largest: here the mean is asked for."),
    Mistake("window", "all", f"measurements of the messages before count, too: {CLEAR}."),
    Mistake("window", "late", "the step's own measurement comes too late: note it before the message is sent."),
    Mistake("window", "before", "the mean is that of the message before: compute it when it is sent."),
    Mistake("sensor", "ACCEL_SENSOR", 'that is the accelerometer: the gyroscope is io.body.sensor("GYRO").'),
    Mistake(
        "sensor", "displayed", "the sensor is that of config.body, the displayed copy: what is simulated is io.body."
    ),
    Mistake("axes", (2, 1, 0), "x, y and z are exchanged: the sensor's value has them in this order."),
    Mistake("axes", (1, 0, 2), "x and y are exchanged: the sensor's value has x, y, z in this order."),
    Mistake("axes", (0, 2, 1), "y and z are exchanged: the sensor's value has x, y, z in this order."),
    Mistake("axes", (None, None, 2), "only z is sent: the tank also rolls and pitches, x and y."),
    Mistake("factor", -1.0, "the sign is turned round: send what the sensor says."),
    Mistake("factor", np.degrees(1.0), "it is in degrees: ROS 2 uses rad/s."),
)
OTHERWISE = "Compare with the mean, component by component, of the measurements since the last message."
MARK = "Most likely {0}_covariance[0] is still {1:g}: -1 says that {0} is not measured, 0 that nobody knows how well."
MARKED_TOO_MUCH = (
    "Most likely all three are marked: angular_velocity is measured, so its covariance stays 0, which means unknown."
)
NOT_MEASURED = "Most likely the accelerometer is sent, too: this robot's message only has what its gyroscope measures."
FRAME = 'message.header.frame_id = f"{self.io.body.name}/base_link"'
NO_FRAME = f"Most likely the frame is left out, of which x, y and z are the axes: {FRAME}."
TYPED_FRAME = f"Most likely the body's name is typed: {FRAME}."
OTHER_FRAME = f"Compare with {FRAME}."
TYPED = (
    "Most likely something of the tank is typed, its name or its time step: take it from config.body, io.body and io."
)
SHARED = "Most likely what is kept belongs to the class, and so to all bodies: make it in initialize."
RESTART = "Most likely measurements of the run before are kept: initialize is called at every start, and begins anew."


class _Shaker(SimpleController):
    """Turns every joint to and fro, so that no two measurements are alike."""

    def initialize(self, io: ControllerIO) -> None:
        self._io = io

    def control(self) -> None:
        for i, joint in enumerate(self._io.body.joints):
            joint.effort = (6.0 + 3.0 * i) * sin((11.0 + 7.0 * i) * self._io.time) + 0.5


class _Recorder(SimpleController):
    """Notes what the sensors say before every step."""

    def initialize(self, io: ControllerIO) -> None:
        self._sensors = {name: io.body.sensor(name) for name in SENSORS}
        self.samples: Samples = {name: [] for name in (*SENSORS, "displayed")}

    def control(self) -> None:
        self.samples["displayed"].append(np.array(DISPLAYED))
        for name, sensor in self._sensors.items():
            self.samples[name].append(sensor.value)


def judge_gyro(answer: type[SimpleController]) -> Iterator[Finding]:
    """Look at an answer to `gyro`."""
    shared, recorder = SharedState(answer), _Recorder()
    with World(answer, name="Rover", before=[_Shaker(), recorder]) as world:
        publisher = yield from endpoint_on(world.ros.node, WatchedPublisher, "/Rover/gyro", Imu, MADE)
        if publisher is None:
            return
        world.displayed.sensor("GYRO").value = DISPLAYED
        world.advance(1200)
        odd = judge_source(answer, world)
        if odd is not None:
            yield odd
            return
        rate = RATE.judge(publisher, 0.001)
        yield rate
        if not publisher.sent:
            return
        all_right = yield from judged(_judge_messages(publisher, recorder.samples, "Rover"))
        if not (all_right and rate.right):
            other = World(answer, name="Rover", time_step=0.002, before=[_Shaker()])
            yield from RATE.judge_step(other, "/Rover/gyro", Imu, publisher, rate)
            return
        all_right = yield from judged(_judge_crane(answer, world, publisher, recorder, shared))
        if all_right:
            yield _judge_restart(world, publisher, recorder)
        yield judge_leaving(answer, world.leave, publisher)


def _judge_messages(publisher: WatchedPublisher, samples: Samples, body: str) -> Iterator[Finding]:
    yield judge_stamps(publisher.sent)
    messages, steps = [message for message, _ in publisher.sent], steps_of(publisher)
    yield from _judge_means(messages, steps, samples)
    yield _judge_marks(messages[-1])
    yield _judge_frame(messages[-1].header.frame_id, f"{body}/base_link")


def _judge_means(messages: Sequence[Any], steps: Sequence[int], samples: Samples) -> Iterator[Finding]:
    """Compare what was sent with what was measured."""

    def predict(**mistake: Any) -> Iterator[tuple[float, ...]]:
        return means(samples, steps[:SHOWN], **mistake)

    vectors = [message.angular_velocity for message in messages[:SHOWN]]
    labels = [f"message {i + 1}" for i in range(len(vectors))]
    probes = [Probe(label, (v.x, v.y, v.z), _say) for label, v in zip(labels, vectors)]
    findings = tuple(judge_probes(probes, predict, MISTAKES, OTHERWISE))
    if all(finding.right for finding in findings):
        yield right("each message holds the mean of what was measured since the one before")
    else:
        yield from findings


def means(
    samples: Samples,
    steps: Sequence[int],
    sent: str = "all",
    method: str = "mean",
    window: str = "since",
    sensor: str = "GYRO",
    axes: tuple[int | None, ...] = (0, 1, 2),
    factor: float = 1.0,
) -> Iterator[tuple[float, ...]]:
    """Compute what is sent, right or with some mistakes.

    Args:
        samples: by sensor, what it said before each step.
        steps: those at which a message was sent.
        sent, method, window, sensor, axes, factor: the mistakes.
    """
    measured = np.array(samples[sensor])
    begin, before = 0, np.zeros(3)
    for step in steps:
        end = step + (window != "late")
        part = measured[0 if window == "all" else max(begin, 0) : max(end, 1)]
        begin = end
        value = {
            "mean": part.mean(axis=0),
            "last": part[-1],
            "first": part[0],
            "sum": part.sum(axis=0),
            "median": np.median(part, axis=0),
            "largest": part.max(axis=0),
        }[method]
        shown, before = (before, value) if window == "before" else (value, before)
        if sent == "nothing":
            shown = np.zeros(3)
        yield tuple(factor * (0.0 if axis is None else float(shown[axis])) for axis in axes)


def _judge_marks(message: Any) -> Finding:
    """Look whether the message says what was not measured."""
    for field in ("orientation", "linear_acceleration"):
        covariance = float(getattr(message, f"{field}_covariance")[0])
        if covariance != -1.0:
            return wrong(f"nothing says that {field} is not measured", MARK.format(field, covariance))
    if float(message.angular_velocity_covariance[0]) == -1.0:
        return wrong("the message says that angular_velocity is not measured", MARKED_TOO_MUCH)
    a = message.linear_acceleration
    if any((a.x, a.y, a.z)):
        return wrong("it has an acceleration", NOT_MEASURED)
    return right("it says that orientation and linear_acceleration are not measured")


def _judge_frame(frame: str, wanted: str) -> Finding:
    if frame == wanted:
        return right(f"its frame is {frame}")
    cause = NO_FRAME if not frame else TYPED_FRAME if frame == "Tank/base_link" else OTHER_FRAME
    return wrong(f"the frame is {frame!r}, not {wanted!r}", cause)


def _judge_crane(
    answer: type[SimpleController],
    world: World,
    publisher: WatchedPublisher,
    recorder: _Recorder,
    shared: SharedState,
) -> Iterator[Finding]:
    """Look whether it works on another robot with another time step, beside the first one."""
    when, other = "on the crane Lift, with steps of 2 ms", _Recorder()
    try:
        with World(answer, model="crane", name="Lift", time_step=0.002, before=[_Shaker(), other]) as lift:
            for each, steps in ((lift, 130), (world, 130), (lift, 300)):
                each.advance(steps)
            second = endpoint(lift.ros.node, WatchedPublisher, "/Lift/gyro", Imu)
            if second is None or not second.sent:
                yield wrong(f"{when}, nothing is published on /Lift/gyro", shared.cause(TYPED))
                return
            findings = [RATE.judge(second, 0.002), *_judge_messages(second, other.samples, "Lift")]
    except Failure as failure:
        typed = isinstance(failure.error, (TutorialError, LookupError, ValueError))
        yield failure.finding(shared.cause(TYPED) if typed else None, when)
        return
    odd = [wrong(f"{when}, {each.text}", shared.cause(TYPED)) for each in findings if not each.right]
    messages, sent_at = [message for message, _ in publisher.sent[-2:]], steps_of(publisher)[-3:]
    expected = list(means(recorder.samples, sent_at))[-len(messages) :] if len(sent_at) > len(messages) else []
    if odd:
        yield odd[0]
    elif any(not np.allclose(_numbers(message), wanted) for message, wanted in zip(messages, expected)):
        yield wrong("two robots at the same time: one's measurements are in the other's mean", shared.cause(SHARED))
    else:
        yield right(f"it works {when}, too")


def _judge_restart(world: World, publisher: WatchedPublisher, recorder: _Recorder) -> Finding:
    """Look whether it begins anew when the simulation does."""
    world.advance(30)  # so that a message is under way
    publisher.sent.clear()
    world.restart()
    world.advance(250)
    when = "after a restart of the simulation"
    if len(publisher.sent) < 2:
        return wrong(f"{when}, {('no message', '1 message')[len(publisher.sent)]} in 0.25 s", RESTART)
    findings = _judge_messages(publisher, recorder.samples, world.body.name)
    odd = next((finding for finding in findings if not finding.right), None)
    return right(f"{when} it begins anew") if odd is None else wrong(f"{when}, {odd.text}", RESTART)


def _numbers(message: Any) -> tuple[float, float, float]:
    v = message.angular_velocity
    return v.x, v.y, v.z


def _say(numbers: tuple[float, ...]) -> str:
    return ", ".join(f"{axis} {number:.3f}" for axis, number in zip("xyz", numbers)) + " rad/s"
