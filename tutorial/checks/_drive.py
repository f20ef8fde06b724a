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
from tutorial.checks._shared import SharedState
from tutorial.checks._topics import endpoint, endpoint_on, judge_leaving
from tutorial.checks._verdict import Finding, judged, right, wrong
from tutorial.checks._watch import Failure, watch
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
    "ahead and to the left, in the corner": (1.0, 1.0, 0.7, -0.9),
    "0.33 to the right": (-0.33, 0.0, 0.7, -0.9),
    "0.31 back": (0.0, -0.31, 0.7, -0.9),
    "0.29 back, and half to the left": (0.5, -0.29, 0.7, -0.9),
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
    Mistake("gains", (0.5, 1.0), "the two numbers are exchanged: 1.0 belongs to left_y, 0.5 to left_x."),
    Mistake("gains", (0.5, 0.5), "left_y counts half: it counts in full, 1.0 * left_y."),
    Mistake("gains", (1.0, 0.0), "left_x is left out, so the tank never turns: -0.5 * left_x and +0.5 * left_x."),
    Mistake("gains", (0.0, 0.5), "left_y is left out, so the tank never drives ahead: 1.0 * left_y."),
    Mistake("tracks", "left twice", "both tracks have the left one's formula: the right one is + 0.5 * left_x."),
    Mistake("tracks", "right twice", "both tracks have the right one's formula: the left one is - 0.5 * left_x."),
    Mistake(
        "gains",
        (1.0, -0.5),
        "left and right are exchanged: to the left, the left track slows down and the right one speeds up.",
    ),
    Mistake("dead", "none", "the dead zone is missing: an axis within 0.3 of the middle counts as 0."),
    Mistake("dead", 0.2, "the dead zone is that of TankController, 0.2; here it is 0.3."),
    *(Mistake("dead", width, f"the dead zone is {width} wide: it is 0.3.") for width in (0.03, 0.1, 0.15, 0.35, 0.5)),
    Mistake("dead", 0.28, "the dead zone is a little narrow: it is 0.3."),
    Mistake("dead", 0.32, "the dead zone is a little wide: it is 0.3."),
    Mistake("dead", "one side", "abs is missing, so a stick to the right or back counts as 0: abs(axis) > 0.3."),
    Mistake("dead", "other side", "abs is missing, so the dead zone holds on one side only: abs(axis) > 0.3."),
    Mistake(
        "dead", "turned round", "the dead zone is turned round: an axis within 0.3 counts as 0, others as they are."
    ),
    Mistake("dead", "sum", "the dead zone is asked of the speeds: it is the axes, each for itself, that count as 0."),
    Mistake("dead", "or", ONE_ZONE),
    Mistake("dead", "and", ONE_ZONE),
    Mistake("dead", "y", "left_x has no dead zone: both axes have one."),
    Mistake("dead", "x", "left_y has no dead zone: both axes have one."),
    Mistake("dead", "rescaled", "the dead zone is taken off: outside of it an axis counts as it is."),
    Mistake("limit", "each", "the speeds are limited to 1 m/s, which nobody asked for: in the corner it is 1.5 m/s."),
    Mistake("limit", "scaled", "the speeds are scaled down to 1 m/s, which nobody asked for: in the corner it is 1.5."),
    Mistake("curve", 2, "the axes are squared: an axis counts as it is."),
    Mistake("curve", 3, "the axes are cubed: an axis counts as it is."),
    Mistake("curve", 0, "only the sign of an axis counts: it counts as it is."),
    Mistake("rest", "kept", "nothing is set at rest, so the last speed stays: set 0 then."),
)
OTHERWISE = "Compare with left: 1.0 * left_y - 0.5 * left_x, right: 1.0 * left_y + 0.5 * left_x."
IN_CALLBACK = (
    "Most likely the callback sets the tracks: it runs on the executor's thread, and the simulated tank belongs to the "
    "simulation's. Only keep the message there, and set the tracks in control."
)
FEW_AXES = "Most likely the code takes for granted that there are axes: one that the message lacks counts as 0."
FEW_DROPPED = (
    "Most likely a message with few axes is dropped, so the last speeds stay: the axes that it lacks count as 0."
)
FEW_STOP = (
    "Most likely a message with few axes counts as rest: only the axes that it lacks count as 0, the others count."
)
MANY_AXES = "Most likely a certain number of axes is expected: there may be more, and axes[0] and axes[1] count."
CONSUMED = (
    "Most likely a message counts for one step only, or for a while, and then for nothing: the stick is where it was "
    "last seen, until the next message says otherwise. Latest keeps it."
)
QUEUED = (
    "Most likely messages wait in a queue, and are taken one after the other: only the newest counts, as in a Latest."
)
SMOOTHED = "Most likely the speeds are smoothed, or approach what the stick says step by step: set them at once."
DROPPED = "Most likely messages are dropped by time: the newest counts, whenever it comes."
READ_ONCE = "Most likely the stick is read once, in initialize: control has to look at every step, self.joy.get()."
OVERWRITTEN = (
    "Most likely self.{name} = ... puts a number in the place of the actuator: it is self.{name}.ctrl = ..., the "
    "actuator takes the speed."
)
UNSEEN = (
    "Most likely control does not see what the callback keeps, or sets no ctrl: take it at every step, self.joy.get(), "
    "and set self.track_l.ctrl and self.track_r.ctrl."
)
EARLY = (
    "Most likely initialize throws away what has come before: make what keeps the message in configure, and only there."
)
NOT_AT_REST = "Most likely the tracks are set in initialize, or begin with something else than a stick at rest."
SHARED = "Most likely what is kept belongs to the class, and so to all tanks: make it in configure, self.joy = ..."
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
    shared = SharedState(answer)
    with World(answer) as world:
        call = 'config.node.create_subscription(Joy, "joy", self.on_joy, 1)'
        subscription = yield from endpoint_on(world.ros.node, WatchedSubscription, "/joy", Joy, call)
        if subscription is not None:
            all_right = yield from judged(_judge_driving(answer, world, subscription))
            if all_right:
                yield from _judge_two(answer, world, subscription, shared)
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
    if _speeds(world) != (0.0, 0.0):
        yield wrong(f"before the first message: {_say(_speeds(world))}; expected: both stand still", NOT_AT_REST)
        return
    publish(Joy(axes=[0.0, 1.0, 0.0, 0.0]))
    if _speeds(world) != (0.0, 0.0):
        yield wrong("the tracks change while control is not running", IN_CALLBACK)
        return
    lacking = missing(answer, "control")
    if lacking:
        yield lacking
        return
    at_once, seen = [], []
    for axes in STICKS.values():
        publish(Joy(axes=axes))
        world.advance()
        at_once.append(_speeds(world))
        world.advance(4)
        seen.append(_speeds(world))
    probes = [Probe(label, speeds, _say, _want) for label, speeds in zip(STICKS, seen)]
    if not any(map(any, seen)):
        cause = _unmoved(answer, world, any(map(any, at_once)))
        yield wrong("whatever the stick does, the tracks stand still", cause)
        return
    all_right = yield from judged(judge_probes(probes, predict, MISTAKES, OTHERWISE if at_once == seen else SMOOTHED))
    if all_right:
        yield _judge_crowd(world, subscription)
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


def _unmoved(answer: type[SimpleController], world: World, at_once: bool) -> str:
    """Name the likeliest cause when the tracks stand still, whatever the stick does."""
    if at_once:
        return CONSUMED
    for name, value in vars(world.learner.inner).items():
        if isinstance(value, float) and sets(answer.initialize, name) and sets(answer.control, name):
            return OVERWRITTEN.format(name=name)
    with World(answer) as early:
        subscription = endpoint(early.ros.node, WatchedSubscription, "/joy", Joy)
        if subscription is not None:
            subscription.call_back(Joy(axes=[0.5, -0.8, 0.0, 0.0]))
            early.advance()
        return READ_ONCE if any(_speeds(early)) else UNSEEN


def _judge_crowd(world: World, subscription: WatchedSubscription) -> Finding:
    """Look whether the newest of several messages counts, and goes on counting."""
    with watch.clocks_stand():
        for left_y in (0.4, -0.5, 0.6, 0.9):
            subscription.call_back(Joy(axes=[0.0, left_y, 0.0, 0.0]))
        world.advance()
    seen, wanted = _speeds(world), (0.9, 0.9)
    if not _same(seen, wanted):
        cause = DROPPED if "clock" in watch.noted else QUEUED
        return wrong(f"four messages between two steps: {_say(seen)}; expected: {_want(wanted)}", cause)
    with watch.clocks_stand(ahead=60.0):
        world.advance(300)
    if not _same(_speeds(world), wanted):
        return wrong(f"300 steps without a message: {_say(_speeds(world))}; expected: {_want(wanted)}", CONSUMED)
    return right("several messages between two steps: the newest counts, until there is another one")


def _judge_two(
    answer: type[SimpleController], world: World, subscription: WatchedSubscription, shared: SharedState
) -> Iterator[Finding]:
    """Look at a second tank beside the first, of another name and time step, that hears something before its start."""
    drives, rests = Joy(axes=[0.5, -0.8, 0.0, 0.0]), Joy(axes=[0.0, 0.0, 0.0, 0.0])
    subscription.call_back(rests)
    world.advance()
    with World(answer, name="Rover", time_step=0.002) as other:
        second = endpoint(other.ros.node, WatchedSubscription, "/joy", Joy)
        if second is None:
            yield wrong("a second tank, Rover: it does not listen to /joy", shared.cause(SHARED))
            return
        when = "a message that comes before the simulation starts"
        try:
            second.call_back(drives)
        except Failure as failure:
            yield failure.finding(when=when)
            return
        other.advance()
        if not _same(_speeds(other), (-1.05, -0.55)):
            yield wrong(f"{when}: {_say(_speeds(other))}; expected: {_want((-1.05, -0.55))}", EARLY)
            return
        yield right(f"{when} counts, too")
        world.advance()
        seen = [*_speeds(world)]
        subscription.call_back(drives)
        second.call_back(rests)
        world.advance()
        other.advance()
        if not _same((*seen, *_speeds(other), *_speeds(world)), (0.0, 0.0, 0.0, 0.0, -1.05, -0.55)):
            yield wrong("two tanks at the same time: one does what the other's stick says", shared.cause(SHARED))
        else:
            yield right("two tanks at the same time: each goes by its own messages")


def _same(seen: Sequence[float], wanted: Sequence[float]) -> bool:
    return all(abs(a - b) < 1e-4 for a, b in zip(seen, wanted))


def _judge_short_messages(world: World, publish: Callable[[Joy], None]) -> Finding:
    """Look whether an axis that a message lacks does what a 0 does, and one too many does nothing."""
    for axes in ([0.0, 1.0], [], [1.0], [1.0, -1.0, 0.7], [1.0, -1.0, 0.7, -0.9, 0.1, 0.1, 0.3, 0.4]):
        when = f"a message with {len(axes)} ax{'i' if len(axes) == 1 else 'e'}s"
        left_x, left_y, *_ = (*axes, 0.0, 0.0)
        wanted = (left_y - 0.5 * left_x, left_y + 0.5 * left_x)
        crash = FEW_AXES if len(axes) < 4 else MANY_AXES
        try:
            publish(Joy(axes=[0.5, -0.8, 0.0, 0.0]))
            world.advance()
            before = _speeds(world)
            publish(Joy(axes=axes))
            world.advance()
        except Failure as failure:
            return failure.finding(crash if isinstance(failure.error, (IndexError, ValueError)) else None, when)
        seen = _speeds(world)
        if not _same(seen, wanted):
            cause = FEW_DROPPED if seen == before else crash if any(seen) else FEW_STOP
            cause = MANY_AXES if len(axes) > 4 else cause
            return wrong(f"{when}: {_say(seen)}; expected: {_want(wanted)}", cause)
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

    subscription.call_back(rest)
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
    dead: str | float = 0.3,
    rest: str = "stop",
    tracks: str = "each",
    limit: str = "none",
    curve: int = 1,
) -> Iterator[tuple[float, ...]]:
    """Compute the track speeds [m/s] for `STICKS`, right or with some mistakes."""
    last = (0.0, 0.0)
    for stick in STICKS.values():
        x, y = (_bent(axis, curve) for axis in _dead_zone(stick[axes[0]], stick[axes[1]], dead))
        v, h = gains[0] * ahead * y, gains[1] * x
        if rest != "kept" or x or y:
            last = {"left twice": (v - h, v - h), "right twice": (v + h, v + h)}.get(tracks, (v - h, v + h))
        speeds = tuple(speed if only in (None, side) else 0.0 for side, speed in enumerate(last))
        if dead == "sum":
            speeds = tuple(speed if abs(speed) > 0.3 else 0.0 for speed in speeds)
        if limit == "each":
            speeds = tuple(min(max(speed, -1.0), 1.0) for speed in speeds)
        elif limit == "scaled":
            speeds = tuple(speed / max(1.0, *map(abs, speeds)) for speed in speeds)
        yield speeds


def _bent(axis: float, curve: int) -> float:
    return (abs(axis) ** curve if axis else 0.0) * (1.0 if axis > 0 else -1.0)


def _dead_zone(x: float, y: float, kind: str | float) -> tuple[float, float]:
    if kind in ("none", "sum") or (kind == "or" and (abs(x) > 0.3 or abs(y) > 0.3)):
        return x, y
    if kind == "and" and (abs(x) <= 0.3 or abs(y) <= 0.3):
        return 0.0, 0.0
    cut_x, cut_y = (axis if _counts(axis, kind) else 0.0 for axis in (x, y))
    if kind == "rescaled":
        return tuple((abs(a) - 0.3) / 0.7 * (1 if a > 0 else -1) if a else 0.0 for a in (cut_x, cut_y))  # type: ignore[return-value]
    return (x if kind == "y" else cut_x), (y if kind == "x" else cut_y)


def _counts(axis: float, kind: str | float) -> bool:
    """Whether an axis is outside of the dead zone, as the answer understands it."""
    if not isinstance(kind, str):
        return abs(axis) > kind
    known = {"one side": axis > 0.3, "other side": axis > 0.3 or axis < 0.0, "turned round": abs(axis) <= 0.3}
    return known.get(kind, abs(axis) > 0.3)


def _say(speeds: tuple[float, ...]) -> str:
    return _in_words(speeds, "both tracks stand still", "both tracks run at {} m/s", "the tracks run at {} and {} m/s")


def _want(speeds: tuple[float, ...]) -> str:
    return _in_words(speeds, "both stand still", "both at {} m/s", "{} and {} m/s")


def _in_words(speeds: tuple[float, ...], still: str, alike: str, apart: str) -> str:
    left, right = map(_number, speeds)
    return (apart if left != right else still if left == "0" else alike).format(left, right)


def _number(speed: float) -> str:
    return f"{speed:+.2f}" if abs(speed) >= 0.005 else "0"
