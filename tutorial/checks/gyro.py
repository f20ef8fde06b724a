"""The exercise `gyro`: publish averages of a sensor's measurements.

Write the controller `GyroPublisher` for a robot that has a gyroscope but no accelerometer. It publishes an `Imu` on the
topic `gyro` of its body. For the body `Tank` the topic is `Tank/gyro`, without a leading slash, so it is in the node's
namespace.

- It publishes 10 times per simulated second: one message every `round(1 / (10 * io.time_step))` steps. You may also
  publish at the steps nearest to the multiples of 1/10 s, so that the rate is exact on average. Publish the first
  message at any step within 1/10 s of the start; at the very first step, there is only one value to average.
- It publishes each message even if nothing has changed, for example on a robot that doesn't turn.
- The angular velocity is the average of the `GYRO` sensor's values since the last message: one value per step,
  including the step at which you publish the message.
- It marks what it does not measure: the covariances of orientation and linear acceleration begin with -1
  (`message.orientation_covariance[0] = -1.0`), but the covariance of the angular velocity does not.
- The stamp is the simulated time of publication.
- The frame is the sensor's frame, `Tank/GYRO`, which includes the body's name. On the tank you may also use the
  chassis frame, `Tank/base_link`: the sensor is fixed to the chassis and has the same axes. (The crane's sensor is at
  the tip of its jib.)
- It works on any body that has such a sensor, and with any time step. When the simulation is restarted, `io.step` and
  the time continue: they don't go back to 0.
- In `unconfigure`, the node destroys its publisher.

Hint 1: Look at how often each thing happens. You measure in every step, but with steps of 1 ms you publish only in
every hundredth step. Collect the measurements until you publish.

Hint 2: In initialize, look up the sensor, and start with an empty list. In control, append the sensor's value in every
step. When a message is due, publish the average of the list, then empty the list. Mark the unmeasured fields.

Hint 3: self.samples.append(self.sensor.value); then, if self.io.step % self.steps_per_message == 0, put x, y, z =
np.mean(self.samples, axis=0).tolist() into message.angular_velocity, and start both covariances with -1.0:
message.orientation_covariance[0] = -1.0, and so on. Publish the message, then self.samples.clear().

Notice that the average of many measurements is less noisy than any single one, and that no measurement is lost.
"""

import dataclasses
from collections.abc import Iterable
from functools import partial
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray
from rclpy.time import Time
from sensor_msgs.msg import Imu

from tutorial.checks.engine.cases import Case, Mistake, both, replace
from tutorial.checks.engine.publishing import Publishing, compared
from tutorial.checks.engine.rig import Rig, Sent
from tutorial.checks.engine.trial import Trial
from tutorial.checks.exercise import Exercise
from tutorial.controller import ControllerConfig, ControllerIO, SimpleController


class GyroPublisher(SimpleController):
    """Publish the mean angular velocity since the last message, at 10 Hz."""

    def configure(self, config: ControllerConfig) -> None:
        """Create the publisher; its topic is named after the body."""
        self.node = config.node
        self.publisher = self.node.create_publisher(Imu, f"{config.body.name}/gyro", 1)

    def initialize(self, io: ControllerIO) -> None:
        """Look up the sensor, and start with no measurements."""
        self.io = io
        self.sensor = io.body.sensor("GYRO")
        self.samples: list[NDArray[np.float64]] = []
        self.steps_per_message = round(1 / (10 * io.time_step))

    def control(self) -> None:
        """Keep the measurement, and publish the average when a message is due."""
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
        """Destroy the publisher."""
        self.node.destroy_publisher(self.publisher)


MISTAKES = [
    Mistake("your code reads the sensor only once, in initialize. "
            "The value is a copy, which never changes: read self.sensor.value in every step.",
            both(replace('self.sensor = io.body.sensor("GYRO")',
                         'self.sensor = io.body.sensor("GYRO")\nself.once = self.sensor.value'),
                 replace("self.sensor.value)", "self.once)"))),
    Mistake("your code sends the sum, or divides it by the wrong number. "
            "Divide the sum by the number of measurements in it.",
            replace("np.mean(self.samples, axis=0)", "np.sum(self.samples, axis=0)",
                    "(np.sum(self.samples, axis=0) * self.io.time_step)",
                    "(np.sum(self.samples, axis=0) / self.steps_per_message)")),
    Mistake("your code sends the value of only one step. Collect the values of all steps, and send their average.",
            replace("np.mean(self.samples, axis=0)", "self.samples[-1]")),
    Mistake("your code averages over all numbers at once, or over x, y and z. "
            "Average each component separately, with axis=0.",
            replace("np.mean(self.samples, axis=0)", "np.full(3, np.mean(self.samples))",
                    "np.mean(self.samples, axis=1)")),
    Mistake("your code doesn't discard the measurements after it has published a message. "
            "Empty the list, or set the sum and the count to 0.",
            replace("self.samples.clear()", "pass")),
    Mistake("your code resets only the sum or only the count after a message. Reset both. "
            "Begin each sum with a new array, because += changes the old one.",
            both(replace("self.samples: list[NDArray[np.float64]] = []", "self.samples, self.all = [], []"),
                 replace("self.samples.append(self.sensor.value)",
                         "self.samples.append(self.sensor.value)\nself.all += self.samples[-1:]"),
                 replace("np.mean(self.samples, axis=0)", "(sum(self.all) / len(self.samples))",
                         "(sum(self.samples) / len(self.all))"))),
    Mistake("your code publishes before it adds the current step's measurement. Add it first.",
            both(replace("self.samples: list[NDArray[np.float64]] = []", "self.samples, self.late = [], []"),
                 replace("self.samples.append(self.sensor.value)",
                         "self.samples += self.late\nself.late = [self.sensor.value]"),
                 replace("if self.io.step %", "if self.io.step %", "if self.samples and self.io.step %"),
                 replace("np.mean(self.samples,", "np.mean(self.samples,", "np.mean(self.samples or [np.zeros(3)],"))),
    Mistake("your code mixes up x, y and z, or sends only z. The sensor's value contains x, y and z, in this order.",
            replace("velocity.x, velocity.y, velocity.z =", "velocity.z, velocity.y, velocity.x =",
                    "velocity.y, velocity.x, velocity.z =", "velocity.x, velocity.z, velocity.y =",
                    "_, _, velocity.z =")),
    Mistake("your code uses the chassis frame. The crane's sensor is at "
            "the tip of its jib: use the sensor's frame, \".../GYRO\".",
            replace('{self.sensor.name}"', 'base_link"')),
    Mistake("your code converts the angular velocity. Send it unchanged: the "
            "sensor and the message both use rad/s.",
            replace("self.sensor.value)", "np.degrees(self.sensor.value))", "np.radians(self.sensor.value))")),
]  # fmt: skip
MEANING = ("Your code probably skips measurements, counts some of them twice, or weights them. "
           "Publish the plain average of all measurements since the last message, one from each step.")  # fmt: skip

SIGNAL = np.random.default_rng(4).exponential((0.2, 0.3, 0.5), (700, 3)) - (0.1, 0.4, 0.2)  # [rad/s], at each step
GYROSCOPE_ALONE = """
<mujoco>
  <worldbody><body><freejoint/><geom size="0.1"/><site name="Rover/IMU"/></body></worldbody>
  <sensor><gyro name="Rover/GYRO" site="Rover/IMU"/></sensor>
</mujoco>
""".strip()


def shaken(trial: Trial, signal: NDArray[np.float64] = SIGNAL, **options: Any) -> Rig:
    """Make a rig whose gyroscope measures a signal, and whose accelerometer measures something else."""

    def measure() -> None:
        for sensor, scale in zip(sensors, (1, 10)):
            sensor.value = scale * signal[rig.io.step % len(signal)]

    rig = Rig(trial, measure, **options)
    rig.displayed.sensor("GYRO").value = (0.7, 0.8, 0.9)
    sensors = [rig.body.sensor(name) for name in ("GYRO", "ACCEL_SENSOR")[: rig.body.model.nsensor]]
    measure()
    return rig


def means(rig: Rig, sent: list[Sent]) -> Any:
    """Observe whether each message contains the average of the measurements since the previous message."""
    seen = [(v.x, v.y, v.z) for v in (each.message.angular_velocity for each in sent)]
    windows = pairwise([rig.begun - 1, *(each.step for each in sent)])
    wanted = (SIGNAL[min(before + 1, step) : step + 1].mean(axis=0).tolist() for before, step in windows)
    return compared([*zip(seen, wanted)], "the averages of the measurements", word)


def word(velocity: Iterable[float]) -> str:
    """Format an angular velocity [rad/s]."""
    return ", ".join(f"{axis} {number:z.3f}" for axis, number in zip("xyz", velocity)) + " rad/s"


def marks(_rig: Rig, sent: list[Sent]) -> str:
    """Observe which fields the last message marks as unmeasured."""
    fields = ("orientation", "angular_velocity", "linear_acceleration")
    marked = [field for field in fields if getattr(sent[-1].message, f"{field}_covariance")[0] == -1]
    return f"-1 marks {' and '.join(marked) or 'nothing'}"


def frame(_rig: Rig, sent: list[Sent]) -> str:
    """Observe the frame of the last message. On the tank Rover, the chassis frame is also accepted."""
    frame_id = sent[-1].message.header.frame_id
    return repr("Rover/GYRO" if frame_id == "Rover/base_link" else frame_id)


PUBLISHING = Publishing(Imu, "gyro", 10, shaken, means)
RESTING = dataclasses.replace(PUBLISHING, scene=partial(shaken, signal=np.zeros((1, 3))))
FRAME = ("Your code probably omits the name of the body or the sensor: "
         'message.header.frame_id = f"{self.io.body.name}/GYRO".')  # fmt: skip
CASES = [
    Case("the content", PUBLISHING.sent(0.45, ms=2)),
    Case("unmeasured fields", PUBLISHING.sent(0.25, look=marks),
         "Your code probably marks too few or too many fields as unmeasured. Put -1.0 into orientation_covariance[0] "
         "and linear_acceleration_covariance[0], and nowhere else."),
    Case("the frame", PUBLISHING.sent(0.25, look=frame), FRAME),
    Case("the frame on the crane Lift", PUBLISHING.sent(0.25, look=frame, model="crane", name="Lift"), FRAME),
    Case("on the crane, with steps of 20 ms", PUBLISHING.sent(0.45, model="crane", ms=20)),
    Case("on a robot that doesn't turn", RESTING.rate(10),
         "Your code probably publishes nothing while the robot isn't turning. Publish every "
         "message: receivers can't distinguish a robot at rest from a lost connection."),
    Case("on a robot with only a gyroscope", PUBLISHING.sent(0.45, model=GYROSCOPE_ALONE),
         "Your code probably also uses the accelerometer, which this robot lacks. "
         "Send only the gyroscope's measurements."),
]  # fmt: skip
gyro = Exercise("gyro", __doc__, PUBLISHING.cases(GyroPublisher, CASES, MISTAKES, MEANING))
