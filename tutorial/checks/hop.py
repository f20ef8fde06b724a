"""The exercise `hop`: a timer on the main thread, and state that lives as long as the controller.

Write the controller `HopViewer`. It subscribes to its body's topic `imu` (type `Imu`); for the body `Tank`, this is
`Tank/imu`. The node has no namespace, so the topic can also begin with a slash. When a message reports a blow, the
displayed body hops:

- A blow is a horizontal acceleration (the length of the vector (x, y)) of more than 20 m/s².
- After a blow, the body immediately rises by 0.1 m. After 0.5 s, the body is back exactly where it stood.
- If another blow arrives while the body is up, the body stays up until 0.5 s after that blow, but rises no higher.
  Other messages have no effect. Treat a blow as new even if its message repeats the previous one.
- No blow is lost if up to five messages arrive while the executor's thread and the main thread are busy.
- Use an asyncio timer on the main thread. After each move, call `calc_forward_kinematics` and `notify_change`.
- After the controller has left the body, no timer is running, the body is back where it stood, and the node has
  destroyed the subscription.

Hint 1: Think about what you have to remember between calls: where the body stood, and the timer. The timer also tells
you whether the body is up.

Hint 2: Start with self.timer = None. To land, test whether there is a timer: if so, cancel it, set self.timer to None,
and put the body back. On a blow, land first; then store the position, move the body up, and start a new timer. Also
land in unconfigure.

Hint 3: self.place = self.body.position; x, y, z = self.place; self.body.position = x, y, z + 0.1; then call
calc_forward_kinematics and notify_change. self.timer = asyncio.get_running_loop().call_later(0.5, self.land), without
parentheses after land. To land, assign self.place itself to self.body.position: adding 0.1 and then subtracting it
doesn't give exactly the same numbers.

Notice that the timer, the next blow and unconfigure all call the same method to land: whichever comes first ends
the hop.
"""

import asyncio
from contextlib import closing
from functools import partial
from math import hypot
from typing import Any

from geometry_msgs.msg import Vector3
from numpy.typing import ArrayLike
from sensor_msgs.msg import Imu

from tutorial.checks.engine.cases import Case
from tutorial.checks.engine.trial import Trial
from tutorial.checks.engine.viewer import Viewer
from tutorial.checks.engine.viewing import MOVES, PAST_THE_QUEUE, hands_over, heard, side_by_side, steps, viewing
from tutorial.checks.exercise import Exercise
from tutorial.controller import ControllerConfig, SimpleController

Vector = tuple[float, float, float]

HEIGHT = 0.1  # [m]
PLACE = (0.1 + 0.2, -1 / 3, 0.105)  # [m]; adding and then subtracting 0.1 changes these numbers by a rounding error
OTHER_PLACE = (-1.1, 0.7, 0.3)
BLOW, OTHER_BLOW, HARMLESS = (25.0, 25.0, 9.8), (-21.0, 3.0, 9.8), (1.0, 2.0, 9.8)  # [m/s^2]
STOOD = "where it stood"
UP = "0.1 m higher"


class HopViewer(SimpleController):
    """Lift the displayed body for half a second when the robot receives a blow."""

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
        """Hop when a blow arrives. If the body is up, land first."""
        a = message.linear_acceleration
        if hypot(a.x, a.y) > 20:
            self.land()
            self.place = self.body.position
            x, y, z = self.place
            self.move((x, y, z + 0.1))
            self.timer = asyncio.get_running_loop().call_later(0.5, self.land)

    def land(self) -> None:
        """If the body is up, put it back where it stood."""
        timer, self.timer = self.timer, None
        if timer is not None:
            timer.cancel()
            self.move(self.place)

    def move(self, position: ArrayLike) -> None:
        """Put the body at a position, and update the view."""
        self.body.position = position
        self.body.calc_forward_kinematics()
        self.body.notify_change()

    def unconfigure(self) -> None:
        """Stop listening, and land."""
        self.node.destroy_subscription(self.subscription)
        self.land()


class Hall(Viewer):
    """A viewer whose body can be put anywhere. Its methods describe what is visible."""

    place: Vector

    def __init__(self, trial: Trial, *body: Any, **how: Any) -> None:
        super().__init__(trial, *body, **how)
        self.stand(PLACE if self.body.name == "Rover" else OTHER_PLACE)

    def stand(self, place: Vector) -> None:
        """Move the body to a position [m]."""
        self.place = self.body.position = place
        self.body.calc_forward_kinematics()
        self.shown.clear()

    def where(self) -> str:
        """Describe where the body is."""
        x, y, z = (self.body.position - self.place).tolist()
        if max(abs(x), abs(y), abs(z)) < 1e-9:
            return "almost where it stood" if x or y or z else STOOD
        if abs(abs(x) - HEIGHT) < 1e-9 or abs(abs(y) - HEIGHT) < 1e-9:
            return "0.1 m aside"
        return "somewhere else" if x or y else f"{z:.3g} m higher"

    def falls(self) -> str:
        """Wait until the body is down again, and report how long it took."""
        self.shown.clear()
        began, timers = self.loop.time(), len(self.loop.timers)
        for _ in range(1000):
            after = self.loop.time() - began
            if self.body.position[2] - self.place[2] < HEIGHT / 2:
                after = next((due for due in (0.125, 0.5) if -0.02 < after - due < 0.03), after)
                return f"down after {after:.3g} s{f', with {timers} timers' * (timers > 1)}"
            rings = [timer.when() - self.loop.time() for timer in self.loop.timers]
            if not rings and after > 1.0:
                break
            self.drain(min(rings, default=1 / 64))
        kinds = ("a timer on another thread", "a timer that moves the body", "a timer", "no timer")
        there = ("timer" in self.trial.noted or "thread" in self.trial.noted, self.shown, timers, True)
        return f"never down, with {next(kind for kind, is_there in zip(kinds, there) if is_there)}"


def imu(x: float, y: float, z: float) -> Imu:
    """Make a message with an acceleration [m/s^2]."""
    return Imu(linear_acceleration=Vector3(x=x, y=y, z=z))


blow, other_blow, harmless = heard(imu(*BLOW)), heard(imu(*OTHER_BLOW)), heard(imu(*HARMLESS))


def land(hall: Hall) -> None:
    """Wait until the body has come down."""
    hall.falls()


def wait(hall: Hall) -> None:
    """Wait for less than half a second."""
    hall.drain(0.375)


def move_it(hall: Hall) -> None:
    """Move the body, as other code would."""
    hall.stand(OTHER_PLACE)


ACCELERATIONS: tuple[Vector, ...] = (
    (25.0, 0.0, 9.8), (-25.0, 0.0, 9.8), (0.0, 25.0, 9.8), (0.0, -25.0, 9.8), (-15.0, 15.0, 9.8), (15.0, 15.0, 9.8),
    (20.5, 0.0, 0.0), (20.0, 0.0, 0.0), (5.0, 0.0, 9.8), (14.0, 14.0, 0.0), (14.0, 0.0, 30.0), (0.0, 0.0, 40.0),
)  # fmt: skip


def mistaken(hall: Hall) -> str:
    """Observe which accelerations are mistaken for blows, and which blows are missed."""
    odd: dict[bool, list[str]] = {True: [], False: []}
    for x, y, z in ACCELERATIONS:
        with closing(hall.another()) as other:
            heard(imu(x, y, z))(other)
            moved = any(where != STOOD for where in (other.where(), *(where for where, _ in other.shown)))
            taken = bool(hall.trial.noted.pop("timer", None) or moved or other.loop.timers)
            if taken != (hypot(x, y) > 20):
                odd[taken].append(f"{x:g} {y:g} {z:g}")
    words = {True: "mistaken for a blow", False: "missed"}
    return "; ".join(f"{words[taken]}: {', '.join(each)}" for taken, each in odd.items() if each) or "all are right"


def in_a_crowd(hall: Hall) -> str:
    """Observe whether a blow is lost among harmless messages that arrive while both threads are busy."""
    crowd = (BLOW, *[HARMLESS] * 4)
    kept = crowd[-hall.node.subscriptions[-1].depth :]
    for each in kept:
        hall.receive(imu(*each))
    calls = len(hall.calls)
    hall.drain()
    lost = f"{len(kept)} of 5 messages arrived; waiting calls: {calls}{', under a key' * bool(hall.keys)}"
    return "" if hall.where() == UP else lost


THEN = Hall.where, Hall.falls, Hall.where  # observed after a message
hopped = partial(steps, viewer=Hall)
STAYS = ("Your unconfigure method probably puts the body back even if it is not up. "
         "First test whether the body is up: self.timer is not None.")  # fmt: skip
CASES = [
    Case("accelerations x y z [m/s²]", hopped(mistaken),
         "Your code probably tests the wrong condition. With a = message.linear_acceleration, the condition is "
         "hypot(a.x, a.y) > 20. Ignore z, because it includes gravity."),
    Case("after a blow", hopped(blow, Hall.where),
         "Your code probably puts the body in the wrong place, or changes a copy of its position. Store "
         "self.body.position when the blow arrives, then set self.body.position to the stored x, y and z + 0.1."),
    Case("the hop ends", hopped(blow, Hall.falls),
         "Your code probably uses the wrong timer or duration, or the function that the timer calls does not put "
         "the body back. In update, write asyncio.get_running_loop().call_later(0.5, self.land)."),
    Case("after the hop", hopped(blow, land, Hall.where),
         "Your code probably computes or hard-codes the landing position. "
         "Restore the position that you stored when the blow arrived."),
    Case("after each move", hopped(blow, Hall.news, land, Hall.news), MOVES),
    Case("a second blow, after the body has landed and been moved", hopped(blow, land, move_it, other_blow, *THEN),
         "Your code probably reuses the timer or position of the previous hop. "
         "Set self.timer = None when the body lands, and store its position at each blow."),
    Case("a second blow while the body is up", hopped(blow, wait, other_blow, *THEN),
         "Your code probably ignores the second blow, lifts the body again, stores its position while it is up, or "
         "keeps the first timer. Cancel that timer and start a new one for 0.5 s; "
         "don't change the stored position or the height."),
    Case("the same blow again", hopped(blow, land, blow, Hall.where),
         "Your code probably skips a message that is identical to the previous one. A second blow can be identical to "
         "the first: post every message."),
    Case("a harmless message while the body is up", hopped(blow, wait, harmless, *THEN),
         "Your code probably reacts to a harmless message while the body is up. "
         "First test for a blow: only a blow may change the timer."),
    Case("a blow and four harmless messages while both threads are busy", hopped(in_a_crowd, Hall.where, Hall.falls),
         "Your code probably loses messages. Subscribe with a queue depth of 10, "
         "and post each message with call_later."),
    Case("the tank and the crane Lift", hopped(side_by_side(blow, Hall.where, land, Hall.where))),
    Case("after unconfigure while the body is up", hopped(blow, wait, Hall.leaves, Hall.left),
         "Your code probably doesn't end the hop in unconfigure. "
         "Cancel the timer, put the body back and call notify_change."),
    Case("after unconfigure has put the body back", hopped(blow, wait, Hall.leaves, Hall.news),
         "Your unconfigure method probably puts the body back without calling "
         "self.body.calc_forward_kinematics() and self.body.notify_change() afterwards."),
    Case("after unconfigure without a blow", hopped(move_it, Hall.leaves), STAYS),
    Case("after unconfigure, if the body has landed and been moved", hopped(blow, land, move_it, Hall.leaves), STAYS),
    Case("a call is waiting when the controller leaves", hopped(lambda hall: hall.leaves(imu(*BLOW))), PAST_THE_QUEUE),
]  # fmt: skip
ARRIVALS = harmless, hands_over(imu(*BLOW))
hop = Exercise("hop", __doc__, viewing(HopViewer, "imu", imu(*BLOW), ARRIVALS, CASES, may_ask_clock=True, viewer=Hall))
