"""Looking at answers to `display` and `keep_up`: what a displayed body does when messages come, and on which thread."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from functools import partial

from sensor_msgs.msg import JointState

from tutorial.checks._answer import missing
from tutorial.checks._desk import Desk, joint_state
from tutorial.checks._interleave import interleave
from tutorial.checks._node import Ear, ear_on
from tutorial.checks._verdict import Finding, right, wrong
from tutorial.checks._watch import Stumble, watch
from tutorial.controller import SimpleController
from tutorial.errors import TutorialError, WrongThreadError

__all__ = ["judge_display", "judge_keep_up"]

BURST = 50

DIRECT = "Most likely the callback moves the body itself: post the call instead, self.call_later(self.update, message)."
AT_ONCE = (
    "Most likely the parentheses call it at once, and post what it returns: give the function and its arguments apart, "
    "self.call_later(self.update, message)."
)
NOT_POSTED = "Most likely the callback posts nothing: self.call_later(self.update, message)."
NOT_MOVED = "Most likely the positions are computed but not set: self.body.set_joint_positions(positions)."
BY_INDEX = "Most likely positions are matched by their place in the message: match them by name, with match_joints."
INVENTED = "Most likely a joint that the message does not name is set to 0: leave it where it is."
UNKNOWN = "Most likely a name that the body does not have is looked up: match_joints leaves such names out."
NO_KINEMATICS = (
    "Most likely self.body.calc_forward_kinematics() is missing: without it the links stay behind the joints."
)
NO_NOTIFY = "Most likely self.body.notify_change() is missing: nobody is told to draw."
EARLY = "Most likely notify_change comes too early: first the positions, then the kinematics, then the news of it."
KEPT = "Most likely unconfigure is missing, or does not call self.subscription.destroy()."
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
CALL = "config.node.create_subscription(JointState, topic, self.on_joint_state, 1)"


def judge_display(answer: type[SimpleController]) -> Iterator[Finding]:
    """Look at an answer to `display`."""
    for model, name in (("tank", "Tank"), ("crane", "Lift")):
        all_right = True
        for finding in _judge_viewer(answer, model, name, full=model == "tank"):
            all_right = all_right and finding.right
            yield finding
        if not all_right:
            return


def judge_keep_up(answer: type[SimpleController]) -> Iterator[Finding]:
    """Look at an answer to `keep_up`."""
    all_right = True
    for finding in _judge_viewer(answer, "tank", "Tank", full=True):
        all_right = all_right and finding.right
        yield finding
    if not all_right:
        return
    with Desk(answer, "tank", "Tank") as desk:
        ear = desk.ros.node.ears[0]
        speak = desk.ros.speaker(ear)
        burst = list(_judge_burst(desk, speak, 0.0))
        yield from burst
        if all(finding.right for finding in burst):
            yield next(finding for finding in _judge_burst(desk, speak, 0.5, " again") if _last(finding))
            yield _judge_pieces(desk, ear)


def _last(finding: Finding) -> bool:
    return not finding.right or "newest" in finding.text


def _judge_viewer(answer: type[SimpleController], model: str, name: str, full: bool) -> Iterator[Finding]:
    lacking = missing(answer, "configure")
    if lacking:
        yield lacking
        return
    with Desk(answer, model, name) as desk:
        finding, ear = ear_on(desk.ros.node, f"/{name}/joint_state", JointState, CALL)
        yield finding
        if ear is None:
            return
        speak = desk.ros.speaker(ear)
        moved = list(_judge_motion(desk, speak))
        yield from moved if full else [_summary(desk, finding) for finding in moved[-1:]]
        if not all(finding.right for finding in moved):
            return
        if full:
            desk.learner.unconfigure()
            if ear.subscription in list(desk.ros.node.subscriptions):
                yield wrong("after unconfigure it still listens", KEPT)
            else:
                yield right("after unconfigure it does not listen any more")


def _summary(desk: Desk, finding: Finding) -> Finding:
    """Say of another body in one line what was said of the first in several."""
    names = ", ".join(desk.body.joint_names)
    return right(f"it shows {desk.body.name}, too, with the joints {names}") if finding.right else finding


def _judge_motion(desk: Desk, speak: Callable[[JointState], None]) -> Iterator[Finding]:
    names = desk.body.joint_names
    wanted = tuple(0.1 * (i + 1) for i in range(len(names)))
    message = joint_state(names[::-1], wanted[::-1], 1)
    thread = _judge_thread(desk, speak, message)
    yield thread
    if not thread.right:
        return
    desk.drain()
    turned = wrong("a message with the joints in another order: it shows them exchanged", BY_INDEX)
    if desk.positions() == _rounded(wanted):
        yield right("a message with the joints in another order: each goes where its name says")
    elif desk.positions() == _rounded(wanted[::-1]):
        yield turned
        return
    else:
        yield wrong("a message comes, and the joints stay where they are", NOT_MOVED)
        return
    yield from _judge_news(desk)
    yield _judge_part(desk, speak, wanted)
    yield _judge_unknown(desk, speak)


def _judge_thread(desk: Desk, speak: Callable[[JointState], None], message: JointState) -> Finding:
    """Look whether the callback only posts, and why not."""
    text = "the body is touched on the executor's thread"
    try:
        speak(message)
    except Stumble as stumble:
        if not isinstance(stumble.error, WrongThreadError):
            return stumble.finding()
        desk.guard.lenient = True
        try:
            speak(message)
        except Stumble:
            return wrong(text, DIRECT, stumble.place)
        return wrong(text, AT_ONCE if desk.uncallable else DIRECT, stumble.place)
    if desk.uncallable:
        return wrong("something else than a function is posted", AT_ONCE)
    if not desk.waiting:
        return wrong("a message comes, and nothing is posted to the main thread", NOT_POSTED)
    return right("the callback posts, and leaves the body alone")


def _judge_news(desk: Desk) -> Iterator[Finding]:
    """Look whether the links follow the joints, and whether observers hear of it when it is done."""
    if not desk.links_follow():
        yield wrong("the joints have moved, but the links are where they were", NO_KINEMATICS)
        return
    yield right("the links follow the joints")
    if not desk.shown:
        yield wrong("the body has moved, but nobody is told", NO_NOTIFY)
    elif desk.shown[-1] != (desk.positions(), True):
        yield wrong("observers are told before the body has moved", EARLY)
    else:
        yield right("observers are told when everything is in its place")


def _judge_part(desk: Desk, speak: Callable[[JointState], None], before: tuple[float, ...]) -> Finding:
    names = desk.body.joint_names
    when = f"a message with only {names[-1]}"
    try:
        speak(joint_state(names[-1:], [0.05], 2))
        desk.drain()
    except Stumble as stumble:
        return stumble.finding(BY_INDEX if isinstance(stumble.error, IndexError) else None, when)
    if desk.positions() == _rounded((*before[:-1], 0.05)):
        return right(f"{when}: the others stay where they are")
    moved = desk.positions()[0] == 0.05
    return wrong(f"{when}: another one moves", BY_INDEX if moved else INVENTED)


def _judge_unknown(desk: Desk, speak: Callable[[JointState], None]) -> Finding:
    when = "a message with the unknown name ANTENNA"
    try:
        speak(joint_state(["ANTENNA", desk.body.joint_names[0]], [1.0, 0.2], 3))
        desk.drain()
    except Stumble as stumble:
        return stumble.finding(UNKNOWN if isinstance(stumble.error, (LookupError, TutorialError)) else None, when)
    if desk.positions()[0] == 0.2:
        return right(f"{when}: it is left out, and the rest is shown")
    return wrong(f"{when}: the rest of it is not shown", UNKNOWN)


def _judge_burst(desk: Desk, speak: Callable[[JointState], None], begin: float, again: str = "") -> Iterator[Finding]:
    """Let many messages come while the main thread is busy."""
    names = desk.body.joint_names
    poses = [tuple(begin + 0.001 * (i + k) for k in range(len(names))) for i in range(1, BURST + 1)]
    for i, pose in enumerate(poses):
        speak(joint_state(names, pose, 100 + round(1000 * begin) + i))
    waiting = desk.waiting
    desk.shown.clear()
    desk.drain()
    when = f"{BURST} messages while the main thread is busy{again}"
    if waiting > 2:
        yield wrong(f"{when}: {waiting} calls wait for it", KEYS if len(set(desk.keys)) > 2 else QUEUE)
    else:
        yield right(f"{when}: {waiting} call{'s' * (waiting != 1)} wait{'s' * (waiting == 1)} for it")
    if desk.positions() == _rounded(poses[-1]):
        yield right(f"{when}: the newest is shown")
    else:
        first = desk.positions() == _rounded(poses[0])
        speak(joint_state(names, poses[-1], 200 + round(1000 * begin)))
        desk.drain()
        again_right = desk.positions() == _rounded(poses[-1])
        yield wrong(f"{when}: the last one is not shown", FIRST if first and again_right else LOST)


def _judge_pieces(desk: Desk, ear: Ear) -> Finding:
    """Look whether the main thread ever shows half of a message, in whatever order the two threads run."""
    names = desk.body.joint_names
    old, new = ((value,) * len(names) for value in (0.3, 0.4))
    desk.guard.lenient = True
    first, second = (joint_state(names, pose, 1000 + i) for i, pose in enumerate((old, new)))
    whole = {_rounded(old), _rounded(new)}
    ear.hear(first)
    desk.drain()
    desk.shown.clear()
    ear.hear(first)
    update = desk.last_call
    for message in (first, second):  # Python 3.13 stops between instructions only in code that was traced before
        interleave(partial(ear.hear, message), watch.files, update, None)
    at, more = 0, True
    while more:
        desk.drain()
        ear.hear(first)
        more = interleave(desk.last_call, watch.files, partial(ear.hear, second), at)
        at += 1
    desk.drain()
    if all(positions in whole for positions, _ in desk.shown):
        return right("a message that comes while another is drawn does not mix with it")
    return wrong("a message that comes while another is drawn: half of each is shown", PIECES)


def _rounded(positions: tuple[float, ...]) -> tuple[float, ...]:
    return tuple(round(position, 6) for position in positions)
