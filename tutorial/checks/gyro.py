"""The exercise `gyro`: publish averages of what a sensor measures.

Write the controller `GyroPublisher`, for a robot that has a gyroscope and no accelerometer. It publishes an `Imu` on
the topic `gyro` of its body, 10 times per simulated second, as nearly as whole steps allow. For the body `Tank` the
topic is `Tank/gyro`, without a slash in front, so it is in the namespace of the node.

- Its angular velocity is the average of what the sensor `GYRO` has measured, one value per step, since the last
  message. The first message goes out at the first step, with one value, or a period later.
- It marks what is not measured: -1 is the first number in the covariances of orientation and linear acceleration.
- Its stamp is the simulated time at which it is sent.
- Its frame is the sensor's own, `Tank/GYRO`, with the body's name. On the tank the chassis, `Tank/base_link`, is
  right, too: the sensor is fixed to it, with the same axes. (The crane's sensor is at the tip of its jib.)
- It works on any body that has such a sensor, and with any time step.
- In `unconfigure`, when it leaves the body, the node destroys its publisher.

Hint 1: Look at what happens how often: you measure in every step, and send in every hundredth. Keep what you measure
until you send it.

Hint 2: In initialize look up the sensor, and begin with an empty list. In control append the sensor's value, in every
step; when it is time to, send the average of the list, and empty it. Mark what is not measured.

Hint 3: self.samples.append(self.sensor.value); then, if self.io.step % self.steps_per_message == 0, x, y, z =
np.mean(self.samples, axis=0).tolist() go into message.angular_velocity, -1.0 into both covariances,
message.orientation_covariance[0] = -1.0, and so on. Publish, then self.samples.clear().

Notice that the average of many measurements shakes less than any of them, and you lose nothing between them.
"""

from collections.abc import Iterable
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray
from rclpy.time import Time
from sensor_msgs.msg import Imu

from tutorial.checks.exercise import Exercise, Publishing, Rig, Sent, compared
from tutorial.controller import ControllerConfig, ControllerIO, SimpleController


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
            message.header.frame_id = f"{self.io.body.name}/{self.sensor.name}"
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
the sensor is read once, in initialize, and its value is a copy: ask for self.sensor.value in every step.
    self.sensor = io.body.sensor("GYRO") => self.sensor = io.body.sensor("GYRO") // self.once = self.sensor.value
    self.sensor.value) => self.once)

one measurement alone is sent, the newest or the oldest: note one in every step, and take their mean.
    np.mean(self.samples, axis=0) => self.samples[-1] => self.samples[0]

the sum is sent, or it is divided by the steps between two messages: divide it by how many measurements it has.
    np.mean(self.samples, axis=0) => np.sum(self.samples, axis=0) => (np.sum(self.samples, axis=0) * self.io.time_step)
    => (np.sum(self.samples, axis=0) / self.steps_per_message)

each value is averaged with the mean so far, or it is the median, or the mean of two: add up all, divide by how many.
    np.mean(self.samples, axis=0) => [*accumulate(self.samples, lambda a, b: (a + b) / 2)][-1]
    => np.median(self.samples, axis=0) => ((self.samples[0] + self.samples[-1]) / 2)

the mean is taken over all numbers at once, or over x, y and z: axis=0 takes it component by component.
    np.mean(self.samples, axis=0) => np.full(3, np.mean(self.samples)) => np.mean(self.samples, axis=1)

the sum or the count goes on: begin with both anew after a message, the sum with a new array, which += changes in place.
    self.samples: list[NDArray[np.float64]] = [] => self.samples, self.all = [], []
    self.samples.append(self.sensor.value) => self.samples.append(self.sensor.value) // self.all += self.samples[-1:]
    np.mean(self.samples, axis=0) => (sum(self.all) / len(self.samples)) => (sum(self.samples) / len(self.all))

the step's own measurement comes too late: note it before the message is sent.
    self.samples: list[NDArray[np.float64]] = [] => self.samples, self.late = [], []
    self.samples.append(self.sensor.value) => self.samples += self.late // self.late = [self.sensor.value]
    if self.io.step % => if self.io.step % => if self.samples and self.io.step %
    np.mean(self.samples, => np.mean(self.samples, => np.mean(self.samples or [np.zeros(3)],

x, y and z are exchanged, or only z is sent: the sensor's value has all three, in this order.
    velocity.x, velocity.y, velocity.z = => velocity.z, velocity.y, velocity.x = => velocity.y, velocity.x, velocity.z =
    => velocity.x, velocity.z, velocity.y = => _, _, velocity.z =

the frame is that of the chassis: on the crane the sensor is at the tip of the jib, so take the sensor's own, "/GYRO".
    {self.sensor.name}" => base_link"

the sign is turned round, or it is converted from or to degrees: send what the sensor says, which is in rad/s.
    np.mean( => -np.mean( => 180 / np.pi * np.mean( => np.pi / 180 * np.mean(

#
Most likely some measurements are left out, or older ones still count: each message has the mean of all since the last.

# the frame
Most likely the body or the sensor is missing, or another: message.header.frame_id = f"{self.io.body.name}/GYRO".

# what is not measured
These two are not measured: put -1.0 into orientation_covariance[0] and linear_acceleration_covariance[0], nowhere else.

# on a robot with a gyroscope alone
Most likely the accelerometer is asked for, too, which not every robot has: what is sent is what the gyroscope measures.
"""

SIGNAL = np.random.default_rng(4).exponential((0.2, 0.3, 0.5), (700, 3)) - (0.1, 0.4, 0.2)  # [rad/s], at each step
GYROSCOPE_ALONE = """
<mujoco>
  <worldbody><body><freejoint/><geom size="0.1"/><site name="Rover/IMU"/></body></worldbody>
  <sensor><gyro name="Rover/GYRO" site="Rover/IMU"/></sensor>
</mujoco>
""".strip()


def shaken(answer: type, **options: Any) -> Rig:
    """Make a rig whose gyroscope measures the signal, and the accelerometer something else."""

    def measure() -> None:
        for sensor, scale in zip(sensors, (1, 10)):
            sensor.value = scale * SIGNAL[rig.io.step % len(SIGNAL)]

    rig = Rig(answer, measure, **options)
    rig.displayed.sensor("GYRO").value = (0.7, 0.8, 0.9)
    sensors = [rig.body.sensor(name) for name in ("GYRO", "ACCEL_SENSOR")[: rig.body.model.nsensor]]
    measure()
    return rig


def means(rig: Rig, sent: list[Sent]) -> Any:
    """Observe whether each message holds the mean of what was measured since the one before."""
    seen = [(v.x, v.y, v.z) for v in (each.message.angular_velocity for each in sent)]
    windows = pairwise([rig.begun - 1, *(each.step for each in sent)])
    wanted = (SIGNAL[min(before + 1, step) : step + 1].mean(axis=0).tolist() for before, step in windows)
    return compared([*zip(seen, wanted)], "the means of what was measured", word)


def word(velocity: Iterable[float]) -> str:
    """Put an angular velocity [rad/s] into words."""
    return ", ".join(f"{axis} {number:z.3f}" for axis, number in zip("xyz", velocity)) + " rad/s"


def marks(_rig: Rig, sent: list[Sent]) -> str:
    """Observe what the last message says is not measured."""
    fields = ("orientation", "angular_velocity", "linear_acceleration")
    marked = [field for field in fields if getattr(sent[-1].message, f"{field}_covariance")[0] == -1]
    return f"-1 marks {' and '.join(marked) or 'nothing'}"


def frame(_rig: Rig, sent: list[Sent]) -> str:
    """Observe the frame of the last message; of the tank Rover, that of its chassis is as good as the sensor's own."""
    frame_id = sent[-1].message.header.frame_id
    return repr("Rover/GYRO" if frame_id == "Rover/base_link" else frame_id)


PUBLISHING = Publishing(Imu, "gyro", 10, shaken, means)
TRIED = {
    "what is sent": PUBLISHING.sent(0.45, ms=2),
    "what is not measured": PUBLISHING.sent(0.25, look=marks),
    "the frame": PUBLISHING.sent(0.25, look=frame),
    "the frame, on the crane Lift": PUBLISHING.sent(0.25, look=frame, model="crane", name="Lift"),
    "on the crane, 20 ms a step": PUBLISHING.sent(0.45, model="crane", ms=20),
    "on a robot with a gyroscope alone": PUBLISHING.sent(0.45, model=GYROSCOPE_ALONE),
}
gyro = Exercise("gyro", __doc__, PUBLISHING.cases(GyroPublisher, TRIED, MISTAKES))
