"""Looking at an answer to `keep_up`: what a displayed body does when messages come faster than they are shown."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from functools import partial
from itertools import count

from sensor_msgs.msg import JointState

from tutorial.checks._desk import Desk, joint_state
from tutorial.checks._display import LATEST, SHARED, judge_two, judge_viewer, rounded
from tutorial.checks._interleave import interleave
from tutorial.checks._node import WatchedSubscription
from tutorial.checks._shared import SharedState
from tutorial.checks._topics import endpoint
from tutorial.checks._verdict import Finding, judged, right, wrong
from tutorial.checks._watch import Failure, watch
from tutorial.controller import SimpleController

__all__ = ["judge_keep_up"]

BURST = 50

QUEUE = (
    "Most likely each message is posted with call_later, which keeps every call: call_latest keeps the newest of a key."
)
NO_KEY = "Most likely the key is None, which is no key: take one that says what the call is about, the body's name."
ALL_DRAWN = (
    "Most likely all messages that wait are drawn, one after the other, so the main thread is as busy as with a call "
    "for each: draw only the newest, which call_latest keeps."
)
LOST_WAKE_UP = (
    "Most likely what says that a call waits is cleared too late, or asked too early: a message that comes between "
    "taking the newest and clearing it is kept, but no call is posted for it. Clear it first, and under one lock; or "
    "leave all that to call_latest."
)
KEYS = (
    "Most likely the key differs from message to message: take one that says what the call is about, the body's name."
)
LOST = (
    "Most likely messages are dropped by time or by count, and the last one with them: post every one with call_latest."
)
FIRST = "Most likely the first of them is kept: the newest is what counts, and call_latest keeps that."
PIECES = (
    "Most likely the callback keeps the message piece by piece, while the main thread reads it: hand it over as a "
    "whole, as an argument of the posted call."
)


def judge_keep_up(answer: type[SimpleController]) -> Iterator[Finding]:
    """Look at an answer to `keep_up`."""
    shared = SharedState(answer)
    for model, name in (("tank", "Tank"), ("crane", "Lift")):
        full = model == "tank"
        all_right = yield from judged(judge_viewer(answer, model, name, LATEST, full=full, in_order=False))
        if not all_right:
            return
    with Desk(answer, "tank", "Tank") as desk:
        subscription = endpoint(desk.ros.node, WatchedSubscription, "/Tank/joint_state", JointState)
        if subscription is None:
            yield wrong("a second viewer does not listen to /Tank/joint_state", shared.cause(SHARED))
            return
        publish = desk.ros.publisher_to(subscription)
        with watch.clocks_stand():
            all_right = yield from judged(list(_judge_burst(desk, publish, 0.0)))
            if not all_right:
                return
            again = yield from judged(f for f in _judge_burst(desk, publish, 0.5, " again") if _last(f))
        if not again:
            return
        all_right = yield from judged([_judge_turns(desk, subscription)])
        if not all_right:
            return
    yield judge_two(answer, shared)


def _last(finding: Finding) -> bool:
    return not finding.right or "newest" in finding.text


def _judge_burst(desk: Desk, publish: Callable[[JointState], None], begin: float, again: str = "") -> Iterator[Finding]:
    """Let many messages come while the main thread is busy."""
    names = desk.body.joint_names
    poses = [tuple(begin + 0.001 * (i + k) for k in range(len(names))) for i in range(1, BURST + 1)]
    stamp = 100 + round(100_000 * begin)  # [ms]; the messages are from different seconds
    desk.keys.clear()
    for i, pose in enumerate(poses):
        publish(joint_state(names, pose, stamp + 401 * i))
    waiting = desk.waiting
    desk.shown.clear()
    desk.drain()
    when = f"{BURST} messages while the main thread is busy{again}"
    if waiting > 1:
        keys = set(desk.keys)
        cause = NO_KEY if keys == {None} else KEYS if len(keys) > 1 else QUEUE
        yield wrong(f"{when}: {waiting} calls wait for it", cause)
    else:
        yield right(f"{when}: {waiting} call{'s' * (waiting != 1)} wait{'s' * (waiting == 1)} for it")
    if desk.positions() != rounded(poses[-1]):
        first = desk.positions() == rounded(poses[0])
        publish(joint_state(names, poses[-1], stamp + 401 * BURST))
        desk.drain()
        again_right = desk.positions() == rounded(poses[-1])
        yield wrong(f"{when}: the last one is not shown", FIRST if first and again_right else LOST)
    elif len(desk.shown) > 1 and waiting <= 1:
        yield wrong(f"{when}: the body is drawn {len(desk.shown)} times", ALL_DRAWN)
    else:
        yield right(f"{when}: the newest is shown")


def _judge_turns(desk: Desk, subscription: WatchedSubscription) -> Finding:
    """Look whether a message is lost, or mixed with another, in whatever order the two threads run."""
    desk.guard.lenient = True
    try:
        _be_traced(desk, subscription)
        for interrupted in (_interrupted_drawing, _interrupted_callback):
            for at in count():
                more, odd = interrupted(desk, subscription, at)
                if odd is not None:
                    return odd
                if not more:
                    break
    except Failure as failure:
        return failure.finding(PIECES, "a message that comes while another is drawn")
    return right("a message that comes while another is drawn is shown next, and does not mix with it")


def _be_traced(desk: Desk, subscription: WatchedSubscription) -> None:
    """Trace both sides once: Python 3.13 stops between instructions only in code that was traced before."""
    first, second = _pair(desk)
    for message in (first, second):
        interleave(partial(subscription.call_back, message), bool, None)
        interleave(desk.drain, bool, None)


Turn = tuple[bool, Finding | None]


def _interrupted_drawing(desk: Desk, subscription: WatchedSubscription, at: int) -> Turn:
    """Let a message come when the posted call has come to an instruction.

    Args:
        desk: with a displayed body.
        subscription: the learner's.
        at: the instruction, counted from 0.

    Returns:
        Whether there are so many instructions, and what has gone wrong.
    """
    first, second = _pair(desk)
    subscription.call_back(first)
    more = interleave(desk.drain, partial(subscription.call_back, second), at)
    return more, _judge_turn(desk, first, second) if more else None


def _interrupted_callback(desk: Desk, subscription: WatchedSubscription, at: int) -> Turn:
    """Let the main thread run what waits when the callback has come to an instruction; as `_interrupted_drawing`."""
    first, second = _pair(desk)
    subscription.call_back(first)
    more = interleave(partial(subscription.call_back, second), desk.drain, at)
    return more, _judge_turn(desk, first, second) if more else None


_stamps = count(100_000, 2)  # [ms], after those of the bursts


def _pair(desk: Desk) -> tuple[JointState, JointState]:
    """Make two messages, the second of which has to be shown in the end, and forget what was shown."""
    names = desk.body.joint_names
    desk.drain()
    desk.shown.clear()
    stamp = next(_stamps)
    return joint_state(names, [0.3] * len(names), stamp), joint_state(names, [0.4] * len(names), stamp + 1)


def _judge_turn(desk: Desk, first: JointState, second: JointState) -> Finding | None:
    desk.drain()
    whole = {rounded(tuple(message.position)) for message in (first, second)}
    if not all(positions in whole for positions, _ in desk.shown):
        return wrong("a message that comes while another is drawn: half of each is shown", PIECES)
    if desk.positions() != rounded(tuple(second.position)):
        return wrong("a message that comes while another is drawn: it is never shown", LOST_WAKE_UP)
    return None
