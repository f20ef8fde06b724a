"""The exercise `gyro`: publish means of what a sensor measures."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray
from rclpy.time import Time
from sensor_msgs.msg import Imu

from tutorial.checks._cases import Cases
from tutorial.checks._publishing import NOTHING, Publishing, Told, say
from tutorial.checks._rig import Rig
from tutorial.checks.exercise import Exercise
from tutorial.controller import ControllerConfig, ControllerIO, SimpleController

__all__ = ["GyroPublisher", "gyro"]


class GyroPublisher(SimpleController):
    """Publish the angular velocity at 10 Hz, the mean of the steps since the last message."""

    def configure(self, config: ControllerConfig) -> None:
        """Announce the topic, named after the body."""
        self.node = config.node
        self.publisher = self.node.create_publisher(Imu, f"{config.body.name}/gyro", 1)

    def initialize(self, io: ControllerIO) -> None:
        """Begin with nothing measured."""
        self.io = io
        self.sensor = io.body.sensor("GYRO")
        self.samples: list[NDArray[np.float64]] = []
        self.steps_per_message = round(1 / (10 * io.time_step))

    def control(self) -> None:
        """Note what is measured; publish the mean, when it is time to."""
        self.samples.append(self.sensor.value)
        if self.io.step % self.steps_per_message == 0:
            message = Imu()
            message.header.stamp = Time(nanoseconds=self.io.time_ns).to_msg()
            message.header.frame_id = f"{self.io.body.name}/base_link"
            velocity = message.angular_velocity
            velocity.x, velocity.y, velocity.z = np.mean(self.samples, axis=0).tolist()
            message.orientation_covariance[0] = -1.0
            message.linear_acceleration_covariance[0] = -1.0
            self.publisher.publish(message)
            self.samples.clear()

    def unconfigure(self) -> None:
        """Take the topic back."""
        self.node.destroy_publisher(self.publisher)


MISTAKES = """
there is a message for each measurement: one holds the mean of them all.
    self.publisher.publish(message) => for _ in self.samples: self.publisher.publish(message)

message.angular_velocity is left out.
    velocity.x, velocity.y, velocity.z = => nothing =

the velocity is put into linear_acceleration: it belongs into message.angular_velocity.
    velocity = message.angular_velocity => velocity = message.linear_acceleration

the sensor is read once, in initialize, and its value is a copy: ask for self.sensor.value in every step.
    self.sensor = io.body.sensor("GYRO") => self.sensor = io.body.sensor("GYRO") // self.once = self.sensor.value
    self.sensor.value) => self.once)

the newest measurement alone is sent: note one in every step, and take their mean.
    np.mean(self.samples, axis=0) => self.samples[-1]

the oldest measurement alone is sent: take the mean of all since the last message.
    np.mean(self.samples, axis=0) => self.samples[0]

the sum is sent: divide it by how many measurements it has.
    np.mean(self.samples, axis=0) => np.sum(self.samples, axis=0)

the sum is divided by the number of steps between two messages: the first message has fewer measurements, so divide it
by how many it has.
    np.mean(self.samples, axis=0) => (np.sum(self.samples, axis=0) / self.steps_per_message)

that is the median: here the mean is asked for.
    np.mean( => np.median(

that is the largest: here the mean is asked for.
    np.mean( => np.max(

each measurement is averaged with the mean before it, so the newest counts for half: add all up, and divide once.
    self.samples.append(self.sensor.value) => self.samples = [np.mean([*self.samples, self.sensor.value], axis=0)]

the mean is taken over all numbers at once: axis=0 takes it component by component.
    np.mean(self.samples, axis=0).tolist() => [float(np.mean(self.samples))] * 3

the mean is taken over x, y and z of each measurement: axis=0 takes it component by component.
    np.mean(self.samples, axis=0) => np.mean(self.samples, axis=1)

measurements of the messages before count, too: begin anew after each message, self.samples.clear().
    self.samples.clear() => pass

the sum goes on, though the count begins anew: after each message begin with both anew. An array that is kept as the
zero is changed by +=, too.
    self.samples: list[NDArray[np.float64]] = [] => self.samples, self.total = [], np.zeros(3)
    self.samples.append(self.sensor.value) => self.samples.append(self.sensor.value) // self.total += self.samples[-1]
    np.mean(self.samples, axis=0) => (self.total / len(self.samples))

the count goes on, though the sum begins anew: after each message begin with both anew.
    self.samples: list[NDArray[np.float64]] = [] => self.samples, self.count = [], 0
    self.samples.append(self.sensor.value) => self.samples.append(self.sensor.value) // self.count += 1
    np.mean(self.samples, axis=0) => (np.sum(self.samples, axis=0) / self.count)

the step's own measurement comes too late: note it before the message is sent.
    self.samples: list[NDArray[np.float64]] = [] => self.samples, self.late = [], []
    self.samples.append(self.sensor.value) => self.samples += self.late // self.late = [self.sensor.value]
    if self.io.step % => if self.samples and self.io.step %

the step's own measurement comes too late: note it before the message is sent.
    self.samples: list[NDArray[np.float64]] = [] => self.samples, self.late = [], []
    self.samples.append(self.sensor.value) => self.samples += self.late // self.late = [self.sensor.value]
    np.mean(self.samples, => np.mean(self.samples or self.late,

the step's own measurement comes too late, so there is none for the first message: note it before the message is sent.
    self.samples: list[NDArray[np.float64]] = [] => self.samples, self.late = [], []
    self.samples.append(self.sensor.value) => self.samples += self.late // self.late = [self.sensor.value]
    np.mean(self.samples, axis=0).tolist() => (np.mean(self.samples, axis=0).tolist() if self.samples else 0.0)

the mean is that of the message before: compute it when it is sent.
    self.samples: list[NDArray[np.float64]] = [] => self.samples, self.before = [], np.zeros(3)
    velocity = => before, self.before = self.before, np.mean(self.samples, axis=0) // velocity =
    np.mean(self.samples, axis=0).tolist() => before.tolist()

that is the accelerometer: the gyroscope is io.body.sensor("GYRO").
    "GYRO" => "ACCEL_SENSOR"

the accelerometer is asked for, too, which not every robot has: this message only has what the gyroscope measures.
    self.sensor = => self.other = io.body.sensor("ACCEL_SENSOR") // self.sensor =

the accelerometer is sent, too: this robot's message only has what its gyroscope measures.
    velocity = => message.linear_acceleration.x = float(self.io.body.sensor("ACCEL_SENSOR").value[0]) // velocity =

the sensor is that of config.body, the displayed copy: what is simulated is io.body.
    self.node = config.node => self.node, self.shown = config.node, config.body
    io.body.sensor( => self.shown.sensor(

x, y and z are exchanged: the sensor's value has them in this order.
    velocity.x, velocity.y, velocity.z = => velocity.z, velocity.y, velocity.x =

x, y and z are exchanged: the sensor's value has them in this order.
    velocity.x, velocity.y, velocity.z = => velocity.y, velocity.z, velocity.x =

x, y and z are exchanged: the sensor's value has them in this order.
    velocity.x, velocity.y, velocity.z = => velocity.z, velocity.x, velocity.y =

x and y are exchanged: the sensor's value has x, y, z in this order.
    velocity.x, velocity.y, velocity.z = => velocity.y, velocity.x, velocity.z =

y and z are exchanged: the sensor's value has x, y, z in this order.
    velocity.x, velocity.y, velocity.z = => velocity.x, velocity.z, velocity.y =

only z is sent: the tank also rolls and pitches, x and y.
    velocity.x, velocity.y, velocity.z = => _, _, velocity.z =

the sign is turned round: send what the sensor says.
    np.mean(self.samples, axis=0) => (-np.mean(self.samples, axis=0))

it is in degrees: ROS 2 uses rad/s.
    np.mean(self.samples, axis=0) => np.degrees(np.mean(self.samples, axis=0))

orientation_covariance[0] is still 0: -1 says that orientation is not measured, 0 that nobody knows how well.
    message.orientation_covariance[0] = -1.0 => pass

linear_acceleration_covariance[0] is still 0: -1 says that linear_acceleration is not measured, 0 that nobody knows how
well.
    message.linear_acceleration_covariance[0] = -1.0 => pass

all three are marked: angular_velocity is measured, so its covariance stays 0, which means unknown.
    message.orientation_covariance[0] = => message.orientation_covariance[0] = message.angular_velocity_covariance[0] =

angular_velocity is marked in place of linear_acceleration: it is measured, and linear_acceleration is not.
    message.linear_acceleration_covariance => message.angular_velocity_covariance

the number is 1: it is -1 that says that something is not measured.
    -1.0 => 1.0

the frame is left out, of which x, y and z are the axes: message.header.frame_id = f"{self.io.body.name}/base_link".
    f"{self.io.body.name}/base_link" => ""

the body's name is typed: message.header.frame_id = f"{self.io.body.name}/base_link".
    f"{self.io.body.name}/base_link" => "Tank/base_link"

the frame is the body's name alone: message.header.frame_id = f"{self.io.body.name}/base_link".
    f"{self.io.body.name}/base_link" => self.io.body.name

the frame lacks the body's name: message.header.frame_id = f"{self.io.body.name}/base_link".
    f"{self.io.body.name}/base_link" => "base_link"

measurements of the run before are kept: initialize is called at every start, and begins anew.
    self.node = config.node => self.node, self.kept = config.node, []
    self.samples: list[NDArray[np.float64]] = [] => self.samples = self.kept

the publisher is destroyed in stop, but made in configure: after a restart there is none. Destroy it in unconfigure.
    def unconfigure(self) => def stop(self)
"""

STEPS = (
    "Compare with io.step % steps_per_message == 0, in control, and steps_per_message = round(1 / (10 * io.time_step))."
)
OTHERWISE = {
    "": "Compare with the mean, component by component, of the measurements since the last message.",
    "on the body Rover": 'Compare with config.node.create_publisher(Imu, f"{config.body.name}/gyro", 1), in configure.',
    "with steps of 1 ms": STEPS,
    "with steps of 2 ms": "Most likely the number of steps is written down for 1 ms: compute it from io.time_step.",
    "with steps of 3 ms": STEPS,
    "with steps of 6 ms": STEPS,
    "the stamp": "Compare with Time(nanoseconds=self.io.time_ns).to_msg(), at the time of sending.",
    "the frame": 'Compare with message.header.frame_id = f"{self.io.body.name}/base_link".',
    "what is not measured": "Compare with message.orientation_covariance[0] = -1.0; the same for linear_acceleration.",
    "two robots in turns": "Most likely what is kept belongs to the class: make it in initialize, for each body.",
    "on a robot with a gyroscope alone": "Most likely something is asked for that not every robot has: use only GYRO.",
    "after a restart": "Most likely something of the run before is kept: initialize is called at every start.",
    "after unconfigure": "Compare with self.node.destroy_publisher(self.publisher), in unconfigure.",
}

SIGNAL = np.random.default_rng(4).exponential((0.2, 0.3, 0.5), (700, 3)) - (0.1, 0.4, 0.2)  # [rad/s], at each step
DISPLAYED = (0.7, 0.8, 0.9)  # [rad/s] what the displayed copy's gyroscope says
GYROSCOPE_ALONE = """
<mujoco>
  <worldbody><body><freejoint/><geom size="0.1"/><site name="Rover/IMU"/></body></worldbody>
  <sensor><gyro name="Rover/GYRO" site="Rover/IMU"/></sensor>
</mujoco>
""".strip()


@dataclass(frozen=True)
class Kept:
    """What is looked at of a message.

    Attributes:
        velocity: the angular velocity [rad/s].
        frame: its frame.
        marks: the first numbers of the covariances: of orientation, angular velocity and linear acceleration.
        acceleration: whether it has one.
    """

    velocity: tuple[float, float, float]
    frame: str
    marks: tuple[float, ...]
    acceleration: bool


def keep(message: Any) -> Kept | None:
    """Keep what is looked at of a message; nothing of any other kind."""
    if not isinstance(message, Imu):
        return None
    v, a = message.angular_velocity, message.linear_acceleration
    fields = ("orientation", "angular_velocity", "linear_acceleration")
    marks = tuple(float(getattr(message, f"{field}_covariance")[0]) for field in fields)
    return Kept((v.x, v.y, v.z), message.header.frame_id, marks, any((a.x, a.y, a.z)))


def shaken(answer: type, **options: Any) -> Rig:
    """Make a rig whose gyroscope measures the signal, and the accelerometer something else."""

    def measure() -> None:
        gyroscope.value = SIGNAL[rig.io.step]
        if accelerometers:
            accelerometers[0].value = 10 * SIGNAL[rig.io.step] + 1

    rig = Rig(answer, measure, keep=keep, **options)
    rig.displayed.sensor("GYRO").value = DISPLAYED
    gyroscope = rig.body.sensor("GYRO")
    accelerometers = [rig.body.sensor("ACCEL_SENSOR")] if rig.body.model.nsensor > 1 else []
    measure()
    return rig


def means(rig: Rig) -> Any:
    """Observe whether each message holds the mean of what was measured since the one before."""
    sent = PUBLISHING.messages(rig)
    windows = pairwise([rig.begun - 1, *(each.step for each in sent)])
    wanted = [SIGNAL[min(before + 1, step) : step + 1].mean(axis=0) for before, step in windows]
    seen = [each.message.velocity for each in sent]
    odd = [i for i, mean in enumerate(wanted) if not np.allclose(seen[i], mean)]
    if not odd:
        return "the means of what was measured" if seen else NOTHING
    i = odd[0]
    return Told(f"message {i + 1} has {numbers(seen[i])}, and the mean is {numbers(wanted[i])}", seen)


def numbers(velocity: Any) -> str:
    """Put an angular velocity [rad/s] into words."""
    return ", ".join(f"{axis} {number:z.3f}" for axis, number in zip("xyz", velocity)) + " rad/s"


NAMES = {"steps": "steps_per_message", "time": "self.io.time_ns", "lesson": "ImuPublisher", "lesson_hz": 20}
PUBLISHING = Publishing(Imu, "gyro", 10, shaken, means, NAMES)


def sent(answer: type, **options: Any) -> Any:
    """Observe the means that are sent."""
    return means(PUBLISHING.play(answer, 0.45, **options))


def last(look: Callable[[Kept], str], **options: Any) -> Callable[[type], str]:
    """Observe something of the last message."""

    def observe(answer: type) -> str:
        messages = PUBLISHING.messages(PUBLISHING.play(answer, 0.25, **options))
        return look(messages[-1].message) if messages else NOTHING

    return observe


def marks(kept: Kept) -> str:
    """Say what a message says about what it does not measure."""
    orientation, velocity, acceleration = kept.marks
    texts = [
        (orientation != -1, f"orientation_covariance[0] is {orientation:g}"),
        (acceleration != -1, f"linear_acceleration_covariance[0] is {acceleration:g}"),
        (velocity == -1, "angular_velocity_covariance[0] is -1"),
        (kept.acceleration, "it has an acceleration"),
    ]
    return ", ".join(text for odd, text in texts if odd) or "orientation and linear_acceleration are marked"


def frame(kept: Kept) -> str:
    """Say which frame a message has."""
    name, _, rest = kept.frame.partition("/")
    own = name == "Rover" and any(word in rest.lower() for word in ("gyro", "imu"))
    return "'Rover/base_link'" if own else repr(kept.frame)


CASES = Cases(
    GyroPublisher,
    {
        "on the body Rover": PUBLISHING.topics("/"),
        "in the namespace /lab": PUBLISHING.topics("/lab"),
        "with steps of 1 ms": PUBLISHING.rate(1),
        "what is sent": sent,
        "what is not measured": last(marks),
        "the frame": last(frame),
        "the stamp": PUBLISHING.stamps,
        "with steps of 2 ms": PUBLISHING.rate(2),
        "with steps of 3 ms": PUBLISHING.rate(3),
        "with steps of 6 ms": PUBLISHING.rate(6),
        "on the crane, with steps of 20 ms": lambda answer: sent(answer, model="crane", ms=20),
        "on a robot with a gyroscope alone": lambda answer: sent(answer, model=GYROSCOPE_ALONE),
        "two robots in turns": PUBLISHING.two,
        "after a restart": PUBLISHING.restarted,
        "after unconfigure": PUBLISHING.left,
        "on ROS 2": PUBLISHING.on_ros,
    },
    PUBLISHING.mistakes(MISTAKES),
    say,
    OTHERWISE,
)

gyro = Exercise(
    name="gyro",
    statement="""
    Write the controller `GyroPublisher`, for a robot that has a gyroscope and no accelerometer. It publishes an `Imu`
    on the topic `gyro` of its body, 10 times per simulated second, as near as whole steps allow. For the body `Tank`
    the topic is `Tank/gyro`, without a slash in front: so it is in the namespace of the node.

    - Its angular velocity is the mean of what the sensor `GYRO` has measured, one value per step, since the last
      message; the first message has what there is.
    - What is not measured says so: -1 is the first number in the covariances of orientation and linear acceleration.
    - Its stamp is the simulated time at which it is sent.
    - Its frame is `Tank/base_link`, with the body's name. The sensor's own frame, `Tank/GYRO`, is right, too.
    - It works on any body that has such a sensor, and with any time step.
    - When it leaves the body it destroys its publisher, in `unconfigure`.
    """,
    judge=CASES.judge,
    solution=(GyroPublisher,),
    base=SimpleController,
    parts=("configure", "initialize", "control", "unconfigure"),
    requires=("configure", "initialize"),
    hints=(
        "Look at what happens how often: measuring in every step, sending in every hundredth. What is measured has to "
        "be kept from the one to the other.",
        "In initialize look up the sensor, and begin with an empty list. In control append the sensor's value, in "
        "every step; when it is time to, send the mean of the list, and empty it. Mark what is not measured.",
        "self.samples.append(self.sensor.value); then, if self.io.step % self.steps_per_message == 0, x, y, z = "
        "np.mean(self.samples, axis=0).tolist() go into message.angular_velocity, -1.0 into both covariances, "
        "message.orientation_covariance[0] = -1.0, and so on. Publish, then self.samples.clear().",
    ),
    notice="Notice that the mean of many measurements shakes less than any of them, and nothing between them is lost.",
)
