"""The exercise of step 5: a timer on the main thread, and state that ends with the controller."""

from __future__ import annotations

import asyncio
from math import hypot

from numpy.typing import ArrayLike
from sensor_msgs.msg import Imu

from tutorial.checks._hop import judge_hop
from tutorial.checks.exercise import Exercise
from tutorial.controller import ControllerConfig, SimpleController

__all__ = ["hop"]


class HopViewer(SimpleController):
    """Lift the displayed body for half a second when another program's has hit something."""

    def configure(self, config: ControllerConfig) -> None:
        """Subscribe to the topic that is named after the body."""
        self.body = config.body
        self.node = config.node
        self.call_later = config.call_later
        self.timer: asyncio.TimerHandle | None = None
        self.subscription = self.node.create_subscription(Imu, f"{self.body.name}/imu", self.on_imu, 10)

    def on_imu(self, message: Imu) -> None:
        """Hand the message to the main thread."""
        self.call_later(self.update, message)

    def update(self, message: Imu) -> None:
        """Hop, if it was a blow; from the ground, even if it is up."""
        a = message.linear_acceleration
        if hypot(a.x, a.y) > 20:
            self.land()
            self.place = self.body.position
            x, y, z = self.place
            self.move((x, y, z + 0.1))
            self.timer = asyncio.get_running_loop().call_later(0.5, self.land)

    def land(self) -> None:
        """Stand where it stood, if it is up."""
        timer, self.timer = self.timer, None
        if timer is not None:
            timer.cancel()
            self.move(self.place)

    def move(self, position: ArrayLike) -> None:
        """Stand there, and have it drawn."""
        self.body.position = position
        self.body.calc_forward_kinematics()
        self.body.notify_change()

    def unconfigure(self) -> None:
        """Stop listening, and land."""
        self.node.destroy_subscription(self.subscription)
        self.land()


hop = Exercise(
    name="hop",
    statement="""
    Write the controller `HopViewer`. It listens to the topic `imu` of its body, which for the body `Tank` is
    `/Tank/imu` (type `Imu`), and when it hears of a blow, the displayed body hops.

    - A blow is a horizontal acceleration, x and y together, of more than 20 m/s².
    - The body stands 0.1 m higher than it stood, and 0.5 s after the blow exactly where it stood before.
    - A blow that comes while it is up makes it 0.5 s again; it goes no higher.
    - The timer is asyncio's, on the main thread. Whoever draws is told of both moves.
    - When the controller leaves the body, no timer is left, the body stands where it stood, and nothing listens.
    """,
    judge=judge_hop,
    solution=(HopViewer,),
    base=SimpleController,
    parts=("configure", "unconfigure"),
    requires=("configure",),
    hints=(
        "Look at what has to be remembered between two calls: where the body stood, and the timer. Whether there is a "
        "timer also says whether the body is up.",
        "Begin with self.timer = None. Landing, if there is a timer, cancels it, sets it to None and puts the body "
        "back. A blow lands first; then it notes the position, moves the body up, and makes a new timer. unconfigure "
        "lands, too.",
        "self.place = self.body.position, whose x, y, z become x, y, z + 0.1; then calc_forward_kinematics and "
        "notify_change. self.timer = asyncio.get_running_loop().call_later(0.5, self.land), without parentheses "
        "after land. Put back self.place itself: what is added and taken off again is not exactly the same.",
    ),
    notice="Notice that one method lands, for the timer, the next blow and unconfigure: whoever comes first ends it.",
)
