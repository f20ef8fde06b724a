"""Looking at an answer to `drive`: what the tracks do for each position of the stick, and between two threads."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from functools import partial
from itertools import count

from sensor_msgs.msg import Joy

from tutorial.checks._answer import missing
from tutorial.checks._diagnose import owner_of, sentence, sets
from tutorial.checks._explain import Mistake, Probe, judge_probes
from tutorial.checks._interleave import interleave
from tutorial.checks._node import WatchedSubscription
from tutorial.checks._topics import endpoint_on, judge_leaving
from tutorial.checks._verdict import Finding, judged, right, wrong
from tutorial.checks._watch import Failure
from tutorial.checks._world import World
from tutorial.controller import SimpleController

__all__ = ["judge_drive"]

STICKS = {
    "ahead": (0.0, 1.0, 0.7, -0.9),
    "back": (0.0, -1.0, 0.7, -0.9),
    "a turn to the left on the spot": (1.0, 0.0, 0.7, -0.9),
    "ahead and to the right": (-0.6, 0.8, 0.7, -0.9),
    "stick at rest, at (0.16, -0.1)": (0.16, -0.1, 0.7, -0.9),
    "ahead, and 0.25 to the left": (0.25, 1.0, 0.7, -0.9),
    "0.4 ahead": (0.0, 0.4, 0.7, -0.9),
    "0.25 to the left": (0.25, 0.0, 0.7, -0.9),
}
"""What is tried, as (left x, left y, right x, right y)."""

ONE_ZONE = "the two axes share one dead zone: it holds for each axis for itself."
MISTAKES = (
    Mistake("axes", (2, 3), "it reads the right stick: the left one is axes[0] and axes[1]."),
    Mistake("axes", (1, 0), "the two axes are exchanged: axes[0] is x, to the left, axes[1] is y, ahead."),
    Mistake("only", 0, "the right track is forgotten: set the ctrl of TRACK_R, too."),
    Mistake("only", 1, "the left track is forgotten: set the ctrl of TRACK_L, too."),
    Mistake("ahead", -1.0, "the sign of left_y is wrong: forward is positive, for the stick and the tracks."),
    Mistake("gains", (2.0, 1.0), "these are the numbers of TankController; here they are 1.0 and 0.5."),
    Mistake("gains", (1.0, 1.0), "left_x counts in full: it counts half, 0.5 * left_x."),
    Mistake(
        "gains",
        (1.0, -0.5),
        "left and right are exchanged: to the left, the left track slows down and the right one speeds up.",
    ),
    Mistake("dead", "none", "the dead zone is missing: an axis within 0.3 of the middle counts as 0."),
    Mistake("dead", "narrow", "the dead zone is that of TankController, 0.2; here it is 0.3."),
    Mistake("dead", "or", ONE_ZONE),
    Mistake("dead", "and", ONE_ZONE),
    Mistake("dead", "y", "left_x has no dead zone: both axes have one."),
    Mistake("dead", "x", "left_y has no dead zone: both axes have one."),
    Mistake("dead", "rescaled", "the dead zone is taken off: outside of it an axis counts as it is."),
    Mistake("rest", "kept", "nothing is set at rest, so the last speed stays: set 0 then."),
)
OTHERWISE = "Compare with left: 1.0 * left_y - 0.5 * left_x, right: 1.0 * left_y + 0.5 * left_x."
IN_CALLBACK = (
    "Most likely the callback sets the tracks: it runs on the executor's thread, and the simulated tank belongs to the "
    "simulation's. Only keep the message there, and set the tracks in control."
)
FEW_AXES = "Most likely the code takes for granted that there are axes: one that the message lacks counts as 0."
BEFORE_ANY = "Most likely there is nothing to drive by yet: begin with an empty message, Latest(Joy())."
PIECEWISE = (
    "Most likely the callback keeps the message piece by piece, so control can run between two pieces: keep it as a "
    "whole, in a Latest."
)
READ_TWICE = (
    "Most likely control looks twice, and a message comes in between: take it once, and read both axes from that."
)


def judge_drive(answer: type[SimpleController]) -> Iterator[Finding]:
    """Look at an answer to `drive`."""
    with World(answer) as world:
        call = 'config.node.create_subscription(Joy, "joy", self.on_joy, 1)'
        subscription = yield from endpoint_on(world.ros.node, WatchedSubscription, "/joy", Joy, call)
        if subscription is not None:
            yield from _judge_driving(answer, world, subscription)
            yield judge_leaving(answer, world.leave, subscription)


def _judge_driving(
    answer: type[SimpleController], world: World, subscription: WatchedSubscription
) -> Iterator[Finding]:
    publish = world.ros.publisher_to(subscription)
    try:
        world.advance()
    except Failure as failure:
        yield failure.finding(_cause(failure.error, answer, subscription.callback), "before the first message")
        return
    publish(Joy(axes=[0.0, 1.0, 0.0, 0.0]))
    if _speeds(world) != (0.0, 0.0):
        yield wrong("the tracks change while control is not running", IN_CALLBACK)
        return
    lacking = missing(answer, "control")
    if lacking:
        yield lacking
        return
    seen = []
    for axes in STICKS.values():
        publish(Joy(axes=axes))
        world.advance(5)
        seen.append(_speeds(world))
    probes = [Probe(label, speeds, _say, _want) for label, speeds in zip(STICKS, seen)]
    all_right = yield from judged(judge_probes(probes, predict, MISTAKES, OTHERWISE))
    if all_right:
        short = _judge_short_messages(world, publish)
        yield short
        if short.right:
            yield _judge_halves(world, subscription)
    others = [name for name in ("TURRET_Y", "TURRET_P") if world.body.actuator(name).ctrl]
    if others:
        yield wrong(f"it also commands {' and '.join(others)}", "GentleTank drives only TRACK_L and TRACK_R.")


def _speeds(world: World) -> tuple[float, ...]:
    """Return what the two tracks are commanded now [m/s], left and right."""
    return tuple(world.body.actuator(name).ctrl for name in ("TRACK_L", "TRACK_R"))


def _judge_short_messages(world: World, publish: Callable[[Joy], None]) -> Finding:
    """Look whether an axis that a message lacks does what a 0 does."""

    def speeds(*axes: float) -> tuple[float, ...]:
        publish(Joy(axes=axes))
        world.advance()
        return _speeds(world)

    given = 0
    try:
        for axes in ((0.0, 1.0), ()):
            wanted = speeds(*axes, *(0.0 for _ in range(4 - len(axes))))
            speeds(0.5, -0.8, 0.0, 0.0)
            given = len(axes)
            seen = speeds(*axes)
            if seen != wanted:
                return wrong(f"a message with {given} axes: {_say(seen)}; expected: {_want(wanted)}", FEW_AXES)
    except Failure as failure:
        cause = FEW_AXES if isinstance(failure.error, (IndexError, ValueError)) else None
        return failure.finding(cause, f"a message with {given} axes")
    return right("a message with fewer axes: those that it lacks count as 0")


def _judge_halves(world: World, subscription: WatchedSubscription) -> Finding:
    """Look whether control ever sees half of a message, in whatever order the two threads run."""
    when = "a message that comes while control runs"
    try:
        cause = _half_message(world, subscription)
    except Failure as failure:
        return failure.finding(PIECEWISE, when)
    return wrong(f"{when}: half of it is used", cause) if cause else right(f"{when} is used as a whole, or not yet")


def _half_message(world: World, subscription: WatchedSubscription) -> str:
    """Try all orders of a message and a step, and return the likeliest cause if one of them goes wrong."""
    rest, both = (Joy(axes=[x, y, 0.0, 0.0]) for x, y in ((0.0, 0.0), (1.0, 1.0)))
    whole = ((0.0, 0.0), (0.5, 1.5))
    seen = []

    def control() -> None:
        world.learner.control()
        seen.append(_speeds(world))

    for message in (rest, both):  # Python 3.13 stops between instructions only in code that was traced before
        interleave(partial(subscription.call_back, message), control, None)
    if any(speeds not in whole for speeds in seen):
        return PIECEWISE
    for at in count():
        subscription.call_back(rest)
        if not interleave(control, partial(subscription.call_back, both), at):
            break
    return READ_TWICE if any(speeds not in whole for speeds in seen) else ""


def _cause(error: BaseException, answer: type, callback: Callable[..., object]) -> str | None:
    """Name the likeliest cause of an exception in the first step, when no message has come."""
    if isinstance(error, (IndexError, ValueError)):
        return FEW_AXES
    if isinstance(error, (AttributeError, TypeError)) and "'NoneType'" in sentence(error):
        return BEFORE_ANY
    owner, name = owner_of(error) if isinstance(error, AttributeError) else (None, "")
    return BEFORE_ANY if isinstance(owner, answer) and sets(callback, name) else None


def predict(
    axes: tuple[int, int] = (0, 1),
    only: int | None = None,
    ahead: float = 1.0,
    gains: tuple[float, float] = (1.0, 0.5),
    dead: str = "each",
    rest: str = "stop",
) -> Sequence[tuple[float, ...]]:
    """Compute the track speeds [m/s] for `STICKS`, right or with some mistakes."""
    speeds = []
    last = (0.0, 0.0)
    for stick in STICKS.values():
        x, y = _dead_zone(stick[axes[0]], stick[axes[1]], dead)
        v, h = gains[0] * ahead * y, gains[1] * x
        if rest != "kept" or x or y:
            last = (v - h, v + h)
        speeds.append(tuple(speed if only in (None, side) else 0.0 for side, speed in enumerate(last)))
    return speeds


def _dead_zone(x: float, y: float, kind: str) -> tuple[float, float]:
    if kind == "none" or (kind == "or" and (abs(x) > 0.3 or abs(y) > 0.3)):
        return x, y
    if kind == "and" and (abs(x) <= 0.3 or abs(y) <= 0.3):
        return 0.0, 0.0
    width = 0.2 if kind == "narrow" else 0.3
    cut_x, cut_y = (axis if abs(axis) > width else 0.0 for axis in (x, y))
    if kind == "rescaled":
        return tuple((abs(a) - 0.3) / 0.7 * (1 if a > 0 else -1) if a else 0.0 for a in (cut_x, cut_y))  # type: ignore[return-value]
    return (x if kind == "y" else cut_x), (y if kind == "x" else cut_y)


def _say(speeds: tuple[float, ...]) -> str:
    return _in_words(speeds, "both tracks stand still", "both tracks run at {} m/s", "the tracks run at {} and {} m/s")


def _want(speeds: tuple[float, ...]) -> str:
    return _in_words(speeds, "both stand still", "both at {} m/s", "{} and {} m/s")


def _in_words(speeds: tuple[float, ...], still: str, alike: str, apart: str) -> str:
    left, right = map(_number, speeds)
    return (apart if left != right else still if left == "0" else alike).format(left, right)


def _number(speed: float) -> str:
    return f"{speed:+.2f}" if abs(speed) >= 0.005 else "0"
