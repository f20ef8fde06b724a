"""Looking at an answer to `hop`: when a blow lifts the displayed body, for how long, and what is left afterwards."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from math import hypot
from typing import Any

from sensor_msgs.msg import Imu

from tutorial.checks._answer import name_of
from tutorial.checks._clock import ClockedLoop
from tutorial.checks._desk import Desk
from tutorial.checks._display import LATER, judge_thread
from tutorial.checks._node import WatchedSubscription
from tutorial.checks._shared import SharedState
from tutorial.checks._topics import endpoint_on, judge_leaving
from tutorial.checks._verdict import Finding, judged, right, wrong
from tutorial.checks._watch import Failure, watch
from tutorial.controller import SimpleController

__all__ = ["judge_hop"]

Vector = tuple[float, float, float]

HEIGHT = 0.1  # [m]
PLACE = (0.1 + 0.2, -1 / 3, 0.105)  # [m]; what is added to it and taken off again does not bring these numbers back
OTHER_PLACE = (-1.1, 0.7, 0.3)
BLOW = (25.0, 25.0, 9.8)  # [m/s^2]

CALL = 'config.node.create_subscription(Imu, f"{self.body.name}/imu", self.on_imu, 10)'
TIMER = "asyncio.get_running_loop().call_later(0.5, self.land)"
RCLPY_TIMER = f"rclpy's timers call on the executor's thread; the body belongs to the main thread. There it is {TIMER}."
THREAD = f"A thread of its own may not move the body, nor may threading.Timer. On the main thread it is {TIMER}."
NOT_UP = "Most likely the body is not moved: x, y, z = self.place; self.body.position = x, y, z + 0.1."
DOWN = "Most likely the sign is turned round: z points up."
SIDEWAYS = "Most likely 0.1 is added to another component, or to all: the position is x, y, z, and z points up."
HEIGHTS = "Compare with 0.1 m: x, y, z = self.place; self.body.position = x, y, z + 0.1."
NO_KINEMATICS = "Most likely self.body.calc_forward_kinematics() is missing, or comes before the body is moved."
NO_NOTIFY = "Most likely self.body.notify_change() is missing, or comes too early: it comes last."
NO_TIMER = f"Most likely nothing is to bring it back: {TIMER}."
AT_ONCE = (
    "Most likely the parentheses call the function at once, and it is not called later: give call_later the function "
    "itself, self.land."
)
TOO_SOON = f"Most likely the timer's seconds are too few: {TIMER}."
TOO_LATE = f"Most likely the timer's seconds are too many: {TIMER}."
NOT_EXACT = (
    "Most likely 0.1 is taken off again: sums of floating point numbers are rounded. Keep the position before the "
    "hop, and set that."
)
KEPT_EARLY = "Most likely the place is typed, or noted too early, in configure: note it when the blow comes."
ONLY_X = "Most likely only x counts: it is hypot(x, y), whichever way it is hit."
ONLY_Y = ONLY_X.replace("x counts", "y counts")
SIGNED = "Most likely a blow against an axis does not count: hypot(x, y) has no sign."
WITH_Z = "Most likely z counts, too: gravity is in it, and a hard landing. Only x and y are horizontal."
SUM = "Most likely the components are added up: their length is hypot(x, y)."
LARGEST = "Most likely the larger component alone counts: their length is hypot(x, y)."
NO_ROOT = "Most likely the root is missing: x*x + y*y is the square of the length; hypot(x, y) is the length."
ALWAYS = "Most likely every message counts as a blow: if hypot(x, y) > 20."
OTHER_LIMIT = "Compare with hypot(a.x, a.y) > 20, where a is message.linear_acceleration."
NOTED_UP = (
    "Most likely the place is noted anew by a blow that comes while the body is up: note it only when it stands, "
    "if self.timer is None."
)
FIRST_TIMER = (
    "Most likely the first blow's timer goes on, and brings the body down: cancel it before the next, "
    "self.timer.cancel()."
)
IGNORED = "Most likely a blow that comes while the body is up is ignored: it counts, and its 0.5 s begin anew."
LEFT_OVER = "Most likely an older timer was not cancelled: self.timer.cancel(), before the next one is made."
LEFT_UP = "Most likely unconfigure does not put the body back: self.body.position = self.place, and tell who draws."
TIMER_LEFT = "Most likely unconfigure does not cancel the timer: self.timer.cancel()."
NEVER_HIT = "Most likely unconfigure puts it back to a place that was never noted: do so only if it is up."
TYPED = "Most likely the body's name or place is typed: take it from config.body."

RULES: tuple[tuple[Callable[[Vector], bool], str], ...] = (
    (lambda _: True, ALWAYS),
    (lambda a: a[0] > 20, ONLY_X),
    (lambda a: abs(a[0]) > 20, ONLY_X),
    (lambda a: abs(a[1]) > 20, ONLY_Y),
    (lambda a: a[0] > 20 or a[1] > 20, SIGNED),
    (lambda a: abs(a[0]) > 20 or abs(a[1]) > 20, LARGEST),
    (lambda a: hypot(*a) > 20, WITH_Z),
    (lambda a: a[0] + a[1] > 20, SUM),
    (lambda a: abs(a[0]) + abs(a[1]) > 20, SUM),
    (lambda a: a[0] ** 2 + a[1] ** 2 > 20, NO_ROOT),
    (lambda a: hypot(a[0], a[1]) >= 20, "20 m/s² is not more than 20: hypot(a.x, a.y) > 20."),
)
"""Which blows are taken for such by mistake, and how to mend it."""

CASES: tuple[Vector, ...] = (
    (25.0, 0.0, 9.8), (-25.0, 0.0, 9.8), (0.0, 25.0, 9.8), (0.0, -25.0, 9.8), (-15.0, 15.0, 9.8), (15.0, 15.0, 9.8),
    (20.5, 0.0, 0.0), (20.0, 0.0, 0.0), (5.0, 0.0, 9.8), (14.0, 14.0, 0.0), (14.0, 0.0, 30.0), (0.0, 0.0, 40.0),
)  # fmt: skip


class _Hall(Desk):
    """A displayed body, the learner's controller, and a clock that stands still.

    Attributes:
        seen: where the body's first link was whenever observers were told.
    """

    make_loop = ClockedLoop
    _loop: ClockedLoop

    def __init__(self, controller_class: type[SimpleController], model: str, name: str) -> None:
        super().__init__(controller_class, model, name)
        self.seen: list[list[float]] = []
        self.body.on_change(lambda _: self.seen.append(self.body.data.xpos[1].tolist()))
        self._loop.wrap = self._watched

    def join(self) -> None:
        """Have the learner's controller join the body, while the loop is running."""
        self._within(super().join)

    def leave(self) -> None:
        """Have the learner's controller leave it, as when the body is deleted.

        Raises:
            Failure: it raised.
        """
        self._scope.close()
        self._within(self.learner.unconfigure)
        self.advance(0.0)

    def place(self, position: Vector) -> None:
        """Stand the body somewhere [m]."""
        self.body.position = position
        self.body.calc_forward_kinematics()
        self.seen.clear()

    def hit(self, subscription: WatchedSubscription, acceleration: Vector = BLOW) -> None:
        """Have a message come, and what it posts run.

        Raises:
            Failure: something of it raised.
        """
        self.ros.publisher_to(subscription)(imu(acceleration))
        self.drain()

    def advance(self, seconds: float) -> None:
        """Let the clock go on, and timers run [s].

        Raises:
            Failure: one of them raised.
        """
        self._loop.advance(seconds)
        self.drain()

    @property
    def timers(self) -> int:
        """How many timers there are."""
        return len(self._loop.timers)

    def rise(self, position: Vector = PLACE) -> list[float]:
        """Return how far the body is from a place [m]; nothing but zeros when it stands there to the last bit."""
        x, y, z = (self.body.position - position).tolist()
        return [x, y, z]

    def is_up(self) -> bool:
        """Whether it is higher than where it stood."""
        return self.rise()[2] > HEIGHT / 2

    def news(self) -> Finding | None:
        """Say what is wrong when the links are elsewhere than the body, or observers have not been told."""
        if self.body.data.xpos[1].tolist() != self.body.position.tolist():
            return wrong("the body has moved, but its links are where they were", NO_KINEMATICS)
        if not self.seen or self.seen[-1] != self.body.position.tolist():
            return wrong("the body has moved, but nobody is told", NO_NOTIFY)
        return None

    def _within(self, function: Callable[[], None]) -> None:
        self._loop.within(function)
        if self._failures:
            raise self._failures.pop(0)

    def _watched(self, function: Callable[..., object]) -> Callable[..., object]:
        def run(*args: Any) -> None:
            try:
                with watch.call(name_of(function)):
                    function(*args)
            except Failure as failure:
                self._failures.append(failure)

        return run


def imu(acceleration: Vector) -> Imu:
    """Make a message [m/s^2]."""
    message = Imu()
    a = message.linear_acceleration
    a.x, a.y, a.z = acceleration
    return message


def judge_hop(answer: type[SimpleController]) -> Iterator[Finding]:
    """Look at an answer to `hop`."""
    shared = SharedState(answer)
    with _Hall(answer, "tank", "Tank") as hall:
        subscription = yield from endpoint_on(hall.ros.node, WatchedSubscription, "/Tank/imu", Imu, CALL)
        if subscription is None:
            return
        hall.place(PLACE)
        for judge in (_judge_up, _judge_down, _judge_blows, _judge_again):
            all_right = yield from judged(judge(hall, subscription))
            if not all_right:
                return
        finding = _judge_crane(answer, hall, subscription, shared)
        yield finding
        if finding.right:
            yield from _judge_end(answer, hall, subscription)


def _judge_up(hall: _Hall, subscription: WatchedSubscription) -> Iterator[Finding]:
    """Look whether the callback posts, and the body is lifted."""
    thread = judge_thread(hall, hall.ros.publisher_to(subscription), imu(BLOW), LATER)
    yield thread
    if not thread.right:
        return
    hall.drain()
    if hall.ros.node.timers_made:
        yield wrong("a timer of the node's is made", RCLPY_TIMER)
        return
    if "thread" in watch.noted:
        yield wrong("a thread of its own is started", THREAD, watch.noted["thread"])
        return
    yield _judge_height(hall) or hall.news() or right("a blow lifts it by 0.1 m, and observers are told")


def _judge_height(hall: _Hall) -> Finding | None:
    """Look whether a blow has lifted the body, and not moved it elsewhere."""
    x, y, z = hall.rise()
    if not (x or y or z):
        return wrong("a blow comes, and the body stays where it is", AT_ONCE if len(hall.seen) > 1 else NOT_UP)
    if not (x or y) and abs(z - HEIGHT) < 1e-9:
        return None
    aside = any(abs(abs(each) - HEIGHT) < 1e-9 for each in (x, y))
    cause = SIDEWAYS if aside else KEPT_EARLY if x or y else DOWN if z < 0 else HEIGHTS
    return wrong(f"a blow moves it by x {x:.3g}, y {y:.3g}, z {z:.3g} m", cause)


def _judge_down(hall: _Hall, _: WatchedSubscription) -> Iterator[Finding]:
    """Look when it comes down, and where. It is up already."""
    if not hall.timers:
        yield wrong("no timer is there to bring it down", NO_TIMER)
        return
    hall.advance(0.484375)
    if not hall.is_up():
        yield wrong("after 0.48 s it is down again", TOO_SOON)
        return
    hall.advance(0.046875)
    if hall.is_up():
        hall.advance(60.0)
        yield wrong("after 0.53 s it is still up", NO_TIMER if hall.is_up() else TOO_LATE)
        return
    yield _judge_place(hall) or hall.news() or right("after 0.5 s it stands where it stood, to the last bit")


def _judge_place(hall: _Hall) -> Finding | None:
    """Look whether the body stands where it stood."""
    rise = hall.rise()
    if not any(rise):
        return None
    x, y, z = rise
    near = max(map(abs, rise)) < 1e-9
    text = f"it comes down, but {'not exactly' if near else 'elsewhere'}: off by x {x:.3g}, y {y:.3g}, z {z:.3g} m"
    return wrong(text, NOT_EXACT if near else KEPT_EARLY)


def _judge_blows(hall: _Hall, subscription: WatchedSubscription) -> Iterator[Finding]:
    """Look what is taken for a blow."""
    taken = []
    for case in CASES:
        hall.hit(subscription, case)
        taken.append(hall.is_up())
        hall.advance(1.0)
    odd = [i for i, (x, y, _) in enumerate(CASES) if taken[i] != (hypot(x, y) > 20)]
    if not odd:
        yield right("more than 20 m/s² across the ground is a blow, from wherever it comes")
        return
    causes = [cause for rule, cause in RULES if [rule(case) for case in CASES] == taken]
    x, y, z = CASES[odd[0]]
    text = f"an acceleration of x {x:g}, y {y:g}, z {z:g} m/s² {'lifts it' if taken[odd[0]] else 'does not lift it'}"
    yield wrong(text, causes[0] if causes else OTHER_LIMIT)


def _judge_again(hall: _Hall, subscription: WatchedSubscription) -> Iterator[Finding]:
    """Look what a blow does that comes while the body is up."""
    hall.hit(subscription)
    hall.advance(0.375)
    hall.hit(subscription)
    if hall.rise()[2] > 1.5 * HEIGHT:
        yield wrong("a second blow lifts it still higher", NOTED_UP)
        return
    both = hall.timers > 1
    hall.advance(0.375)
    if not hall.is_up():
        yield wrong("0.38 s after a second blow it is down", FIRST_TIMER if both else IGNORED)
        return
    hall.advance(0.1875)
    if hall.is_up():
        yield wrong("after a second blow it stays up", NOTED_UP)
        return
    if hall.timers:
        yield wrong("it is down, and a timer goes on", LEFT_OVER)
        return
    yield _judge_place(hall) or right("a second blow makes it 0.5 s again, from the same place")


def _judge_crane(
    answer: type[SimpleController], hall: _Hall, subscription: WatchedSubscription, shared: SharedState
) -> Finding:
    """Look whether it works on another robot, beside the first one."""
    with _Hall(answer, "crane", "Lift") as other:
        made = [each for each in other.ros.node.watched(WatchedSubscription) if each.topic == "/Lift/imu"]
        if not made:
            return wrong("on a body called Lift, it does not listen to /Lift/imu", TYPED)
        other.place(OTHER_PLACE)
        cause = ""
        try:
            hall.hit(subscription)
            other.hit(made[-1])
            up, cause = other.rise(OTHER_PLACE)[2], shared.cause("")
            for each in (hall, other):
                each.advance(0.5625)
        except Failure as failure:
            return failure.finding(cause or None, "with the crane Lift beside the tank")
        if abs(up - HEIGHT) > 1e-9 or any(other.rise(OTHER_PLACE)) or any(hall.rise()):
            return wrong("with the crane Lift beside the tank, one of them does not hop as it should", cause or TYPED)
        return _judge_idle(other) or _judge_unhit(answer) or right("it lifts the crane Lift, too, beside the tank")


def _judge_unhit(answer: type[SimpleController]) -> Finding | None:
    """Look what `unconfigure` does without any blow before."""
    with _Hall(answer, "crane", "Lift") as unhit:
        unhit.place(OTHER_PLACE)
        return _judge_idle(unhit)


def _judge_idle(hall: _Hall) -> Finding | None:
    """Look whether `unconfigure` leaves a body alone that stands."""
    when = "unconfigure, when nothing is up"
    try:
        hall.leave()
    except Failure as failure:
        return failure.finding(NEVER_HIT, when)
    return wrong(f"{when}, moves it", NEVER_HIT) if any(hall.rise(OTHER_PLACE)) else None


def _judge_end(answer: type[SimpleController], hall: _Hall, subscription: WatchedSubscription) -> Iterator[Finding]:
    """Look what is left when the controller leaves a body that is up."""
    hall.hit(subscription)
    hall.seen.clear()
    yield judge_leaving(answer, hall.leave, subscription)
    if hall.timers:
        yield wrong("after unconfigure a timer goes on", TIMER_LEFT)
        return
    if any(hall.rise()):
        yield wrong("after unconfigure the body is up for ever", LEFT_UP)
        return
    yield hall.news() or right("after unconfigure no timer is left, and the body stands where it stood")
