"""Looking at an answer to `show`: what a displayed body does when messages come, and on which thread."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator

from sensor_msgs.msg import JointState

from tutorial.checks._desk import Desk, joint_state
from tutorial.checks._node import WatchedSubscription
from tutorial.checks._topics import endpoint_on, judge_leaving
from tutorial.checks._verdict import Finding, judged, right, wrong
from tutorial.checks._watch import Failure
from tutorial.controller import SimpleController
from tutorial.errors import TutorialError, WrongThreadError

__all__ = ["LATEST", "judge_show", "judge_viewer", "rounded"]

TRIES = 12  # messages, after which one that is dropped now and then would have come through
PAUSE = 0.1  # [s] between them

DIRECT = "Most likely the callback moves the body itself: post the call instead, {post}."
AT_ONCE = (
    "Most likely the parentheses call it at once, and post what it returns: give the function and its arguments apart, "
    "{post}."
)
NOT_POSTED = "Most likely the callback posts nothing: {post}."
NOT_MOVED = "Most likely the positions are computed but not set: self.body.set_joint_positions(positions)."
BY_INDEX = "Most likely positions are matched by their place in the message: match them by name, with match_joints."
INVENTED = "Most likely a joint that the message does not name is set to 0: leave it where it is."
UNKNOWN = "Most likely a name that the body does not have is looked up: match_joints leaves such names out."
NO_KINEMATICS = (
    "Most likely self.body.calc_forward_kinematics() is missing, or called before set_joint_positions: the links "
    "stay behind the joints."
)
NO_NOTIFY = "Most likely self.body.notify_change() is missing: nobody is told to draw."
EARLY = "Most likely notify_change comes too early: first the positions, then the kinematics, then the news of it."
LATER = "self.call_later(self.update, message)"
LATEST = "self.call_latest(self.body.name, self.update, message)"
NO_KEY = f"call_latest takes a key first: {LATEST}."
THROTTLED = "Most likely messages are dropped by time or by count: post and show every one, whenever it comes."
ONLY_WHOLE = "Most likely a message that does not name all joints is dropped: show the joints that it names."
CALL = "config.node.create_subscription(JointState, topic, self.on_joint_state, 1)"


def judge_show(answer: type[SimpleController]) -> Iterator[Finding]:
    """Look at an answer to `show`."""
    for model, name in (("tank", "Tank"), ("crane", "Lift")):
        all_right = yield from judged(judge_viewer(answer, model, name, LATER, full=model == "tank"))
        if not all_right:
            return


def judge_viewer(answer: type[SimpleController], model: str, name: str, post: str, full: bool) -> Iterator[Finding]:
    """Look how an answer shows one body.

    Args:
        answer: the learner's class.
        model: the body's model file, without ``.xml``.
        name: the body's name.
        post: how a message is posted.
        full: whether to say everything, and to look at `unconfigure`; otherwise one line sums it up.
    """
    with Desk(answer, model, name) as desk:
        topic = f"/{name}/joint_state"
        subscription = yield from endpoint_on(desk.ros.node, WatchedSubscription, topic, JointState, CALL)
        if subscription is None:
            return
        publish = desk.ros.publisher_to(subscription)
        moved = list(_judge_motion(desk, publish, post))
        yield from moved if full else [_summary(desk, finding) for finding in moved[-1:]]
        if not all(finding.right for finding in moved):
            return
        if full:
            yield judge_leaving(answer, desk.learner.unconfigure, subscription)


def _summary(desk: Desk, finding: Finding) -> Finding:
    """Say of another body in one line what was said of the first in several."""
    names = ", ".join(desk.body.joint_names)
    return right(f"it shows {desk.body.name}, too, with the joints {names}") if finding.right else finding


def _judge_motion(desk: Desk, publish: Callable[[JointState], None], post: str) -> Iterator[Finding]:
    names = desk.body.joint_names
    wanted = tuple(0.1 * (i + 1) for i in range(len(names)))
    message = joint_state(names[::-1], wanted[::-1], 1)
    thread = _judge_thread(desk, publish, message, post)
    yield thread
    if not thread.right:
        return
    desk.drain()
    if desk.positions() == rounded(wanted[::-1]):
        yield wrong("a message with the joints in another order: it shows them exchanged", BY_INDEX)
    elif desk.positions() != rounded(wanted):
        yield wrong("a message comes, and the joints stay where they are", NOT_MOVED)
    else:
        yield right("a message with the joints in another order: each goes where its name says")
        yield from _judge_news(desk)
        yield _judge_part(desk, publish, wanted)
        yield _judge_unknown(desk, publish)


def _judge_thread(desk: Desk, publish: Callable[[JointState], None], message: JointState, post: str) -> Finding:
    """Look whether the callback only posts, and why not."""
    text = "the body is touched on the executor's thread"
    try:
        publish(message)
    except Failure as failure:
        if not isinstance(failure.error, WrongThreadError):
            return failure.finding()
        desk.guard.lenient = True
        try:
            publish(message)
        except Failure:
            return wrong(text, DIRECT.format(post=post), failure.place)
        return wrong(text, (AT_ONCE if desk.uncallable else DIRECT).format(post=post), failure.place)
    return _judge_posting(desk, publish, message, post)


def _judge_posting(desk: Desk, publish: Callable[[JointState], None], message: JointState, post: str) -> Finding:
    """Look what the callback has posted."""
    if desk.keyless:
        return wrong("call_latest is called without a key", NO_KEY)
    if desk.uncallable:
        return wrong("something else than a function is posted", AT_ONCE.format(post=post))
    if not desk.waiting:
        cause = THROTTLED if _happens_later(publish, message, lambda: desk.waiting) else NOT_POSTED.format(post=post)
        return wrong("a message comes, and nothing is posted to the main thread", cause)
    return right("the callback posts, and leaves the body alone")


def _happens_later(publish: Callable[[JointState], None], message: JointState, happened: Callable[[], object]) -> bool:
    """Look whether something happens when a message comes again, a little later."""
    for _ in range(TRIES):
        time.sleep(PAUSE)
        publish(message)
        if happened():
            return True
    return False


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


def _judge_part(desk: Desk, publish: Callable[[JointState], None], before: tuple[float, ...]) -> Finding:
    names = desk.body.joint_names
    when = f"a message with only {names[-1]}"
    wanted = rounded((*before[:-1], 0.05))
    message = joint_state(names[-1:], [0.05], 2)
    try:
        publish(message)
        posted = desk.waiting
        desk.drain()
    except Failure as failure:
        return failure.finding(BY_INDEX if isinstance(failure.error, IndexError) else None, when)
    if desk.positions() == wanted:
        return right(f"{when}: the others stay where they are")
    if desk.positions() == rounded(before):
        text = f"{when}: {'nothing moves' if posted else 'nothing is posted'}"
        late = _happens_later(publish, message, lambda: _shows(desk, wanted))
        return wrong(text, THROTTLED if late or not _shows_all(desk, publish, before) else ONLY_WHOLE)
    moved = desk.positions()[0] == 0.05
    return wrong(f"{when}: another one moves", BY_INDEX if moved else INVENTED)


def _shows(desk: Desk, positions: tuple[float, ...]) -> bool:
    """Run what was posted, and look whether the joints are there then [rad or m]."""
    desk.drain()
    return desk.positions() == positions


def _shows_all(desk: Desk, publish: Callable[[JointState], None], before: tuple[float, ...]) -> bool:
    """Look whether a message with all joints is shown."""
    other = tuple(position + 0.01 for position in before)
    publish(joint_state(desk.body.joint_names, other, 2))
    return _shows(desk, rounded(other))


def _judge_unknown(desk: Desk, publish: Callable[[JointState], None]) -> Finding:
    when = "a message with the unknown name ANTENNA"
    message = joint_state(["ANTENNA", desk.body.joint_names[0]], [1.0, 0.2], 3)
    wanted = (0.2, *desk.positions()[1:])
    try:
        publish(message)
        posted = desk.waiting
        desk.drain()
        if desk.positions()[0] == 0.2:
            return right(f"{when}: it is left out, and the rest is shown")
        late = _happens_later(publish, message, lambda: _shows(desk, wanted))
    except Failure as failure:
        return failure.finding(UNKNOWN if isinstance(failure.error, (LookupError, TutorialError)) else None, when)
    text = "the rest of it is not shown" if posted else "nothing is posted"
    return wrong(f"{when}: {text}", THROTTLED if late else UNKNOWN)


def rounded(positions: tuple[float, ...]) -> tuple[float, ...]:
    """Round positions [rad or m] as `Desk.positions` does."""
    return tuple(round(position, 6) for position in positions)
