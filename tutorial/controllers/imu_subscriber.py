"""Step 5: show what another program's inertial sensors measure, and shake the displayed tank after a blow."""

import asyncio
from math import hypot
from random import uniform

import numpy as np
from numpy.typing import NDArray
from sensor_msgs.msg import Imu

from tutorial.body import Body
from tutorial.controller import ControllerConfig, SimpleController

BLOW = 20.0  # [m/s^2] horizontal acceleration that counts as a blow
DURATION = 0.5  # [s]
PERIOD = 0.02  # [s]
AMPLITUDE = 0.02  # [m] in each direction


class ImuSubscriber(SimpleController):
    """Show the acceleration and angular velocity that another program publishes, and shake the body after a blow."""

    def configure(self, config: ControllerConfig) -> None:  # main thread
        """Subscribe to the topic that is named after the body."""
        self.body = config.body
        self.node = config.node
        self.call_later = config.call_later
        self.shaker = Shaker(self.body)
        self.subscription = self.node.create_subscription(Imu, f"{self.body.name}/imu", self.on_imu, 10)

    def on_imu(self, message: Imu) -> None:  # executor's thread: post and return
        """Hand every message to the main thread: a blow is an event and must not be lost."""
        self.call_later(self.update, message)

    def update(self, message: Imu) -> None:  # main thread
        """Write the message's values into the displayed body's sensors; shake after a blow."""
        a, w = message.linear_acceleration, message.angular_velocity
        self.body.sensor("ACCEL_SENSOR").value = a.x, a.y, a.z
        self.body.sensor("GYRO").value = w.x, w.y, w.z
        self.body.notify_change()
        if hypot(a.x, a.y) > BLOW:
            self.shaker.start()

    def unconfigure(self) -> None:  # main thread
        """Stop listening, and stop shaking, so that no timer outlives the controller."""
        self.node.destroy_subscription(self.subscription)
        self.shaker.stop()


class Shaker:
    """Shakes a displayed body for a while and puts it back exactly where it was. Main thread only."""

    def __init__(self, body: Body) -> None:
        self.body = body
        self.timer: asyncio.TimerHandle | None = None

    def start(self) -> None:
        """Start shaking. If the body is already shaking, make it shake for longer, in the same place."""
        self.ends_at = asyncio.get_running_loop().time() + DURATION
        if self.timer is None:
            self.place = self.body.position
            self.shake()

    def shake(self) -> None:
        """Move the body a little and start the next timer, or stop when the time is up."""
        loop = asyncio.get_running_loop()
        if loop.time() < self.ends_at:
            self.timer = loop.call_later(PERIOD, self.shake)
            stand_at(self.body, self.place + [uniform(-AMPLITUDE, AMPLITUDE) for _ in "xyz"])
        else:
            self.stop()

    def stop(self) -> None:
        """Put the body back if it is shaking."""
        if self.timer is not None:
            self.timer.cancel()
            self.timer = None
            stand_at(self.body, self.place)


def stand_at(body: Body, position: NDArray[np.float64]) -> None:
    """Move a displayed body to a position [m], shape (3,), and update the view."""
    body.position = position
    body.calc_forward_kinematics()
    body.notify_change()
