"""The exercise `hop`: a timer on the main thread, and state that ends with the controller.

Write the controller `HopViewer`. It listens to the topic `imu` of its body, which for the body `Tank` is `/Tank/imu`
(type `Imu`). When it hears of a blow, the displayed body hops:

- A blow is a horizontal acceleration, x and y together, of more than 20 m/s².
- The body stands 0.1 m higher than it stood, and 0.5 s after the blow exactly where it stood before.
- If another blow comes while the body is up, it stays up for 0.5 s from then; it goes no higher. A harmless message
  changes nothing.
- No blow gets lost among other messages, however busy the threads are.
- The timer is asyncio's, on the main thread. After each move come `calc_forward_kinematics` and `notify_change`.
- When the controller leaves the body, no timer is left, the body stands where it stood, and nothing listens.

Hint 1: Look at what you have to remember between two calls: where the body stood, and the timer. Whether there is a
timer also says whether the body is up.

Hint 2: Begin with self.timer = None. Landing, if there is a timer, cancels it, sets it to None and puts the body
back. A blow lands first; then it notes the position, moves the body up, and makes a new timer. unconfigure lands,
too.

Hint 3: self.place = self.body.position, whose x, y, z become x, y, z + 0.1; then calc_forward_kinematics and
notify_change. self.timer = asyncio.get_running_loop().call_later(0.5, self.land), without parentheses after land. Put
back self.place itself: if you add and subtract, the result is not exactly the same.

Notice that one method lands, for the timer, the next blow and unconfigure: the first of them ends the hop.
"""

import asyncio
from collections.abc import Sequence
from contextlib import closing
from math import hypot
from typing import Any

from geometry_msgs.msg import Vector3
from numpy.typing import ArrayLike
from sensor_msgs.msg import Imu

from tutorial.checks.exercise import Exercise, Step, Viewer, hands_over, heard, side_by_side, viewing, watch
from tutorial.controller import ControllerConfig, SimpleController

Vector = tuple[float, float, float]

HEIGHT = 0.1  # [m]
PLACE = (0.1 + 0.2, -1 / 3, 0.105)  # [m]; what is added to it and taken off again does not bring these numbers back
OTHER_PLACE = (-1.1, 0.7, 0.3)
BLOW, HARMLESS = (25.0, 25.0, 9.8), (1.0, 2.0, 9.8)  # [m/s^2]
STOOD = "where it stood"
UP = "0.1 m higher"


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


class Hall(Viewer):
    """A displayed body that may be put anywhere. Each method says what is seen."""

    place: Vector

    def __init__(self, answer: type, *body: Any, **how: Any) -> None:
        super().__init__(answer, *body, **how)
        self.stand(PLACE if self.body.name == "Rover" else OTHER_PLACE)

    def stand(self, place: Vector) -> None:
        """Put the body somewhere [m]."""
        self.place = self.body.position = place
        self.body.calc_forward_kinematics()
        self.shown.clear()

    def where(self) -> str:
        """Say where the body is."""
        x, y, z = (self.body.position - self.place).tolist()
        if max(abs(x), abs(y), abs(z)) < 1e-9:
            return "almost where it stood" if x or y or z else STOOD
        if abs(abs(x) - HEIGHT) < 1e-9 or abs(abs(y) - HEIGHT) < 1e-9:
            return "0.1 m aside"
        return "somewhere else" if x or y else f"{z:.3g} m higher"

    def falls(self) -> str:
        """Say when it is not up any more, however far away that is."""
        self.shown.clear()
        began, timers = self.loop.time(), len(self.loop.timers)
        for _ in range(1000):
            after = self.loop.time() - began
            if self.body.position[2] - self.place[2] < HEIGHT / 2:
                after = next((due for due in (0.125, 0.5) if -0.02 < after - due < 0.03), after)
                return f"down after {after:.3g} s{f', of {timers} timers' * (timers > 1)}"
            rings = [timer.when() - self.loop.time() for timer in self.loop.timers]
            if not rings and after > 1.0:
                break
            self.drain(min(rings, default=1 / 64))
        kinds = ("a timer on another thread", "a timer that moves it", "a timer", "no timer")
        there = ("timer" in watch.noted or "thread" in watch.noted, self.shown, timers, True)
        return f"up for ever, with {next(kind for kind, is_there in zip(kinds, there) if is_there)}"


def imu(x: float, y: float, z: float) -> Imu:
    """Make a message [m/s^2]."""
    return Imu(linear_acceleration=Vector3(x=x, y=y, z=z))


blow, harmless = heard(imu(*BLOW)), heard(imu(*HARMLESS))


def land(hall: Hall) -> None:
    """Let it come down."""
    hall.falls()


def wait(hall: Hall) -> None:
    """Let pass what is less than the half second."""
    hall.drain(0.375)


def move_it(hall: Hall) -> None:
    """Have the body moved by somebody else."""
    hall.stand(OTHER_PLACE)


ACCELERATIONS: tuple[Vector, ...] = (
    (25.0, 0.0, 9.8), (-25.0, 0.0, 9.8), (0.0, 25.0, 9.8), (0.0, -25.0, 9.8), (-15.0, 15.0, 9.8), (15.0, 15.0, 9.8),
    (20.5, 0.0, 0.0), (20.0, 0.0, 0.0), (5.0, 0.0, 9.8), (14.0, 14.0, 0.0), (14.0, 0.0, 30.0), (0.0, 0.0, 40.0),
)  # fmt: skip


def mistaken(hall: Hall) -> str:
    """Observe which accelerations are mistaken for blows, and which blows are not taken for such."""
    odd = []
    for x, y, z in ACCELERATIONS:
        with closing(hall.another()) as other:
            heard(imu(x, y, z))(other)
            moved = any(where != STOOD for where in (other.where(), *(where for where, _ in other.shown)))
            taken = bool(watch.noted.pop("timer", None) or moved or other.loop.timers)
            if taken != (hypot(x, y) > 20):
                odd.append(f"{x:g} {y:g} {z:g}{' is one' * taken}")
    return ", ".join(odd) if odd else "none is mistaken"


def in_a_crowd(hall: Hall) -> str:
    """Observe what comes of a blow among harmless messages, which come while both threads are busy."""
    crowd = (HARMLESS, BLOW, BLOW, HARMLESS)
    kept = crowd[-hall.node.subscriptions[-1].depth :]
    for each in kept:
        hall.receive(imu(*each))
    calls = len(hall.calls)
    hall.drain()
    lost = f"{len(kept)} of 4 have come, {calls} have waited{' under a key' * bool(hall.keys)}"
    return "" if hall.where() == UP else lost


THEN = Hall.where, Hall.falls, Hall.where  # what is asked after a message
TRIED: dict[str, Sequence[Step]] = {
    "messages come": [harmless, hands_over(imu(*BLOW))],
    "of accelerations x, y, z that are blows or not": [mistaken],
    "a blow puts the body": [blow, Hall.where],
    "the body is": [blow, Hall.falls],
    "then it stands": [blow, land, Hall.where],
    "the news of it": [blow, Hall.news, land, Hall.news],
    "a second blow, when it has landed and been moved elsewhere": [blow, land, move_it, blow, *THEN],
    "a second blow while it is up": [blow, wait, blow, *THEN],
    "a harmless message while it is up": [blow, wait, harmless, *THEN],
    "blows between harmless messages, both threads being busy": [in_a_crowd, Hall.where, Hall.falls],
    "the tank and the crane Lift": [side_by_side(blow, Hall.where, land, Hall.where)],
    "unconfigure, while it is up, leaves it": [blow, wait, Hall.leaves, Hall.left],
    "the news of it then": [blow, wait, Hall.leaves, Hall.news],
    "unconfigure, when no blow has come, leaves it": [move_it, Hall.leaves],
    "unconfigure, when it has landed and been moved elsewhere, leaves it": [blow, land, move_it, Hall.leaves],
    "one that waits when the controller leaves": [lambda hall: hall.leaves(imu(*BLOW))],
}
MISTAKES = """
# of accelerations x, y, z that are blows or not
only x counts, only y, or the larger of the two: it is hypot(a.x, a.y), whichever way it is hit.
    hypot(a.x, a.y) => a.x => abs(a.x) => a.y => abs(a.y) => max(a.x, a.y) => max(abs(a.x), abs(a.y))
z counts, too: gravity is in it, and a hard landing. Only x and y are horizontal.
    hypot(a.x, a.y) => hypot(a.x, a.y, a.z)
The condition is another: hypot(a.x, a.y) > 20, where a is message.linear_acceleration, and 20 itself is no blow.

# a blow puts the body
It is put elsewhere, as to 0.1 m in the world, or a copy is changed: note self.body.position when the blow comes, and
then set self.body.position to its x, y and z + 0.1.

# the body is
Most likely the timer is not asyncio.get_running_loop().call_later(0.5, self.land), or what it calls takes the body for
one that is down, or the place was noted after the move up.

# then it stands
it is not put back to the very place that was noted when the blow came: one is typed, or 0.1 taken off, which rounds.
    self.move(self.place) => self.move(self.body.position - (0, 0, 0.1))

# a second blow, when it has landed and been moved elsewhere
what says that the body is up, or its place, is kept from the hop before: set self.timer = None on landing.
    > 20 => > 20 and not hasattr(self, "place")

# a second blow while it is up
a blow that comes while the body is up is ignored: it counts, and its 0.5 s begin anew.
    > 20 => > 20 and not self.timer
Most likely it lifts the body or notes the place once more, or the first timer goes on: such a blow cancels the timer,
and makes a new one of 0.5 s; place and height stay.

# a harmless message while it is up
a harmless message is not left alone while the body is up: ask first whether it is a blow; only that touches the timer.
    a = message. => if self.timer: self.timer.cancel() // a = message.

# blows between harmless messages, both threads being busy
a blow is lost among others: keep ten in the subscription, 10, post each with call_later, and give the message along.
    self.on_imu, 10) => self.on_imu, 1)

# unconfigure, while it is up, leaves it
unconfigure has to do what the timer would: cancel that, put the body back where it stood, and tell who draws.

# unconfigure, when
unconfigure puts it back although it is down: ask first whether it is up, if self.timer is not None.
    self.node.destroy => self.move(getattr(self, "place", (0.0, 0.0, 0.0))) // self.node.destroy
    => if hasattr(self, "place"): self.move(self.place) // self.node.destroy

# the news of it then
the way back does not end as the way up: with self.body.calc_forward_kinematics(), and then self.body.notify_change().
    self.node.destroy => self.timer.cancel() // self.timer, self.body.position = None, self.place // self.node.destroy
"""
hop = Exercise("hop", __doc__, viewing(HopViewer, "imu", imu(*BLOW), TRIED, MISTAKES, viewer=Hall, clock=""))
