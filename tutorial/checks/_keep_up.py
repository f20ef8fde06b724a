"""Looking at an answer to `keep_up`: what a displayed body does when messages come faster than they are shown."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from functools import partial
from itertools import count

from sensor_msgs.msg import JointState

from tutorial.checks._desk import Desk, joint_state
from tutorial.checks._display import LATEST, judge_viewer, rounded
from tutorial.checks._interleave import interleave
from tutorial.checks._node import WatchedSubscription
from tutorial.checks._verdict import Finding, judged, right, wrong
from tutorial.controller import SimpleController

__all__ = ["judge_keep_up"]

BURST = 50

QUEUE = (
    "Most likely each message is posted with call_later, which keeps every call: call_latest keeps the newest of a key."
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
    all_right = yield from judged(judge_viewer(answer, "tank", "Tank", LATEST, full=True))
    if not all_right:
        return
    with Desk(answer, "tank", "Tank") as desk:
        subscription = desk.ros.node.watched(WatchedSubscription)[0]
        publish = desk.ros.publisher_to(subscription)
        all_right = yield from judged(list(_judge_burst(desk, publish, 0.0)))
        if all_right:
            yield next(finding for finding in _judge_burst(desk, publish, 0.5, " again") if _last(finding))
            yield _judge_pieces(desk, subscription)


def _last(finding: Finding) -> bool:
    return not finding.right or "newest" in finding.text


def _judge_burst(desk: Desk, publish: Callable[[JointState], None], begin: float, again: str = "") -> Iterator[Finding]:
    """Let many messages come while the main thread is busy."""
    names = desk.body.joint_names
    poses = [tuple(begin + 0.001 * (i + k) for k in range(len(names))) for i in range(1, BURST + 1)]
    for i, pose in enumerate(poses):
        publish(joint_state(names, pose, 100 + round(1000 * begin) + i))
    waiting = desk.waiting
    desk.shown.clear()
    desk.drain()
    when = f"{BURST} messages while the main thread is busy{again}"
    if waiting > 2:
        yield wrong(f"{when}: {waiting} calls wait for it", KEYS if len(set(desk.keys)) > 2 else QUEUE)
    else:
        yield right(f"{when}: {waiting} call{'s' * (waiting != 1)} wait{'s' * (waiting == 1)} for it")
    if desk.positions() == rounded(poses[-1]):
        yield right(f"{when}: the newest is shown")
    else:
        first = desk.positions() == rounded(poses[0])
        publish(joint_state(names, poses[-1], 200 + round(1000 * begin)))
        desk.drain()
        again_right = desk.positions() == rounded(poses[-1])
        yield wrong(f"{when}: the last one is not shown", FIRST if first and again_right else LOST)


def _judge_pieces(desk: Desk, subscription: WatchedSubscription) -> Finding:
    """Look whether the main thread ever shows half of a message, in whatever order the two threads run."""
    names = desk.body.joint_names
    old, new = ((value,) * len(names) for value in (0.3, 0.4))
    desk.guard.lenient = True
    first, second = (joint_state(names, pose, 1000 + i) for i, pose in enumerate((old, new)))
    whole = {rounded(old), rounded(new)}
    subscription.call_back(first)
    desk.drain()
    desk.shown.clear()
    subscription.call_back(first)
    update = desk.last_call
    for message in (first, second):  # Python 3.13 stops between instructions only in code that was traced before
        interleave(partial(subscription.call_back, message), update, None)
    for at in count():
        desk.drain()
        subscription.call_back(first)
        if not interleave(desk.last_call, partial(subscription.call_back, second), at):
            break
    desk.drain()
    if all(positions in whole for positions, _ in desk.shown):
        return right("a message that comes while another is drawn does not mix with it")
    return wrong("a message that comes while another is drawn: half of each is shown", PIECES)
