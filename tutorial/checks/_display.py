"""Looking at an answer to `show`: what a displayed body does when messages come, and on which thread."""

from __future__ import annotations

import threading
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor, wait
from math import degrees, nan, radians
from pathlib import Path
from typing import Any

from sensor_msgs.msg import JointState

from tutorial.checks._desk import Desk, joint_state
from tutorial.checks._node import WatchedSubscription
from tutorial.checks._shared import SharedState
from tutorial.checks._topics import endpoint, endpoint_on, judge_leaving
from tutorial.checks._verdict import Finding, judged, right, wrong
from tutorial.checks._watch import Failure, watch
from tutorial.controller import SimpleController
from tutorial.errors import TutorialError

__all__ = ["LATEST", "SHARED", "judge_show", "judge_thread", "judge_two", "judge_viewer", "rounded"]

Publish = Callable[[JointState], None]

TRIES = 12  # messages, a second apart, of which one gets through where some are dropped now and then

DIRECT = "Most likely the callback moves the body itself: post the call instead, {post}; a lock does not help."
PARTLY = (
    "Most likely the callback moves the body itself, and posts only what comes after: all that touches the body "
    "belongs into the posted call, {post}."
)
AT_ONCE = (
    "Most likely the parentheses call it at once, and post what it returns: give the function and its arguments apart, "
    "{post}."
)
NOT_POSTED = "Most likely the callback posts nothing: {post}."
TIMER = (
    "Most likely a timer posts, whether there is news or not: its calls pile up while the main thread is busy. The "
    "callback posts, once for each message: {post}."
)
THREAD = "Most likely a thread of its own posts: the callback does that, for each message: {post}."
PLACE_AND_NAME = (
    "Most likely the i-th joint of the body is compared with the i-th name of the message: look for the name wherever "
    "it is, as match_joints does."
)
DEGREES = "Most likely the positions are converted to degrees: they are rad on both sides."
RADIANS = "Most likely the positions are converted to rad: they are rad already."
NEGATED = "Most likely the sign is turned round: set the positions as they come."
ELSEWHERE = "Most likely the positions are changed on the way: set them as match_joints returns them."
NAN_DROPS = "Most likely one NaN makes the whole message invalid: leave out only that joint, as match_joints does."
NAN = "Most likely NaN is set as a position: leave out that joint, and it stays where it is. match_joints does."
SHORT = "Most likely an index goes beyond the end: there may be fewer positions than names. match_joints knows that."
ZERO = "Most likely 0.0 is taken for nothing, as in `if position`: it is a position like any other."
BELOW = "Most likely positions below 0 are left out, or changed: a joint turns both ways."
RESTARTED = (
    "Most likely a message with an older stamp is dropped for ever: when the publisher was started again, its stamps "
    "begin anew, and have to be shown."
)
LATEST_USED = (
    "Most likely it is posted with call_latest, which replaces a call that waits: call_later keeps all, in order."
)
READS_NEWEST = (
    "Most likely the posted call takes the message from self, where the next one has replaced it: give it along, "
    "{post}."
)
ORDER = "Most likely the newest of those that wait is taken first: the oldest comes first, and the newest stays shown."
TYPED = "Most likely a name is typed, of the body or of its joints: take both from config.body."
SHARED = "Most likely what is kept belongs to the class, and so to all viewers: make it in configure, self.... = ..."
HELD = (
    "Most likely a lock is held while the body is moved and drawn, so the callback waits for the main thread: hold it "
    "only to take the message, and draw when it is free again."
)
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
HELD_UP = 30  # looks, a hundredth of a second each, at a callback that sleeps: it is held up, not slow
LATEST = "self.call_latest(self.body.name, self.update, message)"
NO_KEY = f"call_latest takes a key first: {LATEST}."
THROTTLED = "Most likely messages are dropped by time or by count: post and show every one, whenever it comes."
ONLY_WHOLE = "Most likely a message that does not name all joints is dropped: show the joints that it names."
CALL = "config.node.create_subscription(JointState, topic, self.on_joint_state, 1)"


def judge_show(answer: type[SimpleController]) -> Iterator[Finding]:
    """Look at an answer to `show`."""
    shared = SharedState(answer)
    all_right = yield from judged(judge_viewer(answer, "tank", "Tank", LATER, full=True, in_order=True))
    if all_right:
        all_right = yield from judged(judge_viewer(answer, "crane", "Lift", LATER, full=False, in_order=True))
    if all_right:
        yield judge_two(answer, shared)


def judge_viewer(
    answer: type[SimpleController], model: str, name: str, post: str, full: bool, in_order: bool
) -> Iterator[Finding]:
    """Look how an answer shows one body.

    Args:
        answer: the learner's class.
        model: the body's model file, without ``.xml``.
        name: the body's name.
        post: how a message is posted.
        full: whether to say everything, and to look at `unconfigure`; otherwise one line sums it up.
        in_order: whether every message is to be shown, in order.
    """
    with Desk(answer, model, name) as desk:
        topic = f"/{name}/joint_state"
        subscription = yield from endpoint_on(desk.ros.node, WatchedSubscription, topic, JointState, CALL)
        if subscription is None:
            return
        publish = desk.ros.publisher_to(subscription)
        moved = list(_judge_motion(desk, subscription, publish, post, in_order))
        yield from moved if full else [_summary(desk, finding) for finding in moved[-1:]]
        if not all(finding.right for finding in moved):
            return
        if full:
            yield judge_leaving(answer, desk.learner.unconfigure, subscription)


def _summary(desk: Desk, finding: Finding) -> Finding:
    """Say of another body in one line what was said of the first in several."""
    names = ", ".join(desk.body.joint_names)
    if finding.right:
        return right(f"it shows {desk.body.name}, too, with the joints {names}")
    typed = finding.cause in (NOT_MOVED, UNKNOWN, ELSEWHERE, ONLY_WHOLE)
    return wrong(f"on {desk.body.name}, {finding.text}", TYPED if typed else finding.cause, finding.place)


def _judge_motion(
    desk: Desk, subscription: WatchedSubscription, publish: Publish, post: str, in_order: bool
) -> Iterator[Finding]:
    names = desk.body.joint_names
    wanted = tuple(0.1 * (i + 1) for i in range(len(names)))
    message = joint_state(names[::-1], wanted[::-1], 100_001)
    thread = judge_thread(desk, publish, message, post)
    yield thread
    if not thread.right:
        return
    desk.drain()
    when = "a message with the joints in another order"
    if desk.positions() != rounded(wanted):
        yield _not_there(desk, publish, when, wanted)
        return
    yield right(f"{when}: each goes where its name says")
    all_right = yield from judged(_judge_news(desk))
    if not all_right:
        return
    for judge in (_judge_part, _judge_unknown, _judge_odd):
        finding = judge(desk, publish)
        yield finding
        if not finding.right:
            return
    if in_order:
        yield _judge_all_shown(desk, publish, post)
    yield judge_held_up(desk, subscription)


def _not_there(desk: Desk, publish: Publish, when: str, wanted: tuple[float, ...]) -> Finding:
    """Say where the joints have gone instead, and why."""
    seen = desk.positions()
    if seen == rounded(wanted[::-1]):
        return wrong(f"{when}: it shows them exchanged", BY_INDEX)
    guesses = ((degrees, DEGREES), (radians, RADIANS), (lambda q: -q, NEGATED))
    known = [cause for convert, cause in guesses if seen == rounded(tuple(map(convert, wanted)))]
    if any(seen):
        some = all(position in (0.0, q) for position, q in zip(seen, rounded(wanted)))
        said = ", ".join(f"{name} to {position:g}" for name, position in zip(desk.body.joint_names, seen))
        cause = known[0] if known else PLACE_AND_NAME if some else ELSEWHERE
        return wrong(f"{when}: it moves {said}", cause)
    publish(joint_state(desk.body.joint_names, wanted, 100_002))
    desk.drain()
    if desk.positions() == rounded(wanted):
        return wrong(f"{when}: nothing moves; in the body's own order it does", PLACE_AND_NAME)
    return wrong("a message comes, and the joints stay where they are", NOT_MOVED)


def judge_thread(desk: Desk, publish: Callable[[Any], None], message: Any, post: str) -> Finding:
    """Look whether the callback only posts, and why not."""
    desk.guard.lenient = True
    try:
        publish(message)
    except Failure as failure:
        if not desk.guard.touched:
            return failure.finding()
    finally:
        desk.guard.lenient = False
    if desk.guard.touched:
        cause = AT_ONCE if desk.uncallable else PARTLY if desk.waiting else DIRECT
        return wrong("the body is touched on the executor's thread", cause.format(post=post), desk.guard.place)
    return _judge_posting(desk, publish, message, post)


def _judge_posting(desk: Desk, publish: Callable[[Any], None], message: Any, post: str) -> Finding:
    """Look what the callback has posted."""
    if desk.keyless:
        return wrong("call_latest is called without a key", NO_KEY)
    if desk.uncallable:
        return wrong("something else than a function is posted", AT_ONCE.format(post=post))
    if desk.ros.node.timers_made:
        return wrong("a timer goes on beside the callback", TIMER.format(post=post))
    if "thread" in watch.noted:
        return wrong("a thread of its own goes on beside the callback", THREAD.format(post=post), watch.noted["thread"])
    if not desk.waiting:
        cause = THROTTLED if _happens_later(publish, message, lambda: desk.waiting) else NOT_POSTED.format(post=post)
        return wrong("a message comes, and nothing is posted to the main thread", cause)
    return right("the callback posts, and leaves the body alone")


def _happens_later(publish: Callable[[Any], None], message: Any, happened: Callable[[], object]) -> bool:
    """Look whether something happens when a message comes again, a little later by the clocks that are asked."""
    for i in range(TRIES):
        with watch.clocks_stand(1.0 + i):
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


def _judge_part(desk: Desk, publish: Publish) -> Finding:
    names, before = desk.body.joint_names, desk.positions()
    when = f"a message with only {names[-1]}"
    wanted = rounded((*before[:-1], 0.05))
    message = joint_state(names[-1:], [0.05], 100_003)
    try:
        publish(message)
        posted = desk.waiting
        desk.drain()
    except Failure as failure:
        return failure.finding(BY_INDEX if isinstance(failure.error, LookupError) else None, when)
    if desk.positions() == wanted:
        return right(f"{when}: the others stay where they are")
    if desk.positions() == before:
        text = f"{when}: {'nothing moves' if posted else 'nothing is posted'}"
        late = _happens_later(publish, message, lambda: _shows(desk, wanted))
        return wrong(text, THROTTLED if late or not _shows_all(desk, publish, before) else ONLY_WHOLE)
    moved = desk.positions()[0] == 0.05
    return wrong(f"{when}: another one moves", BY_INDEX if moved else INVENTED)


def _shows(desk: Desk, positions: tuple[float, ...]) -> bool:
    """Run what was posted, and look whether the joints are there then [rad or m]."""
    desk.drain()
    return desk.positions() == positions


def _shows_all(desk: Desk, publish: Publish, before: tuple[float, ...]) -> bool:
    """Look whether a message with all joints is shown."""
    other = tuple(position + 0.01 for position in before)
    publish(joint_state(desk.body.joint_names, other, 100_003))
    return _shows(desk, rounded(other))


def _judge_unknown(desk: Desk, publish: Publish) -> Finding:
    when = "a message with the unknown name ANTENNA"
    message = joint_state(["ANTENNA", desk.body.joint_names[0]], [1.0, 0.2], 100_004)
    wanted = (0.2, *desk.positions()[1:])
    try:
        publish(message)
        posted = desk.waiting
        desk.drain()
        if desk.positions() == wanted:
            return right(f"{when}: it is left out, and the rest is shown")
        if desk.positions()[0] == 1.0:
            return wrong(f"{when}: its position goes to another joint", BY_INDEX)
        late = _happens_later(publish, message, lambda: _shows(desk, wanted))
    except Failure as failure:
        return failure.finding(UNKNOWN if isinstance(failure.error, (LookupError, TutorialError)) else None, when)
    text = "the rest of it is not shown" if posted else "nothing is posted"
    return wrong(f"{when}: {text}", THROTTLED if late else UNKNOWN)


def _judge_odd(desk: Desk, publish: Publish) -> Finding:
    """Look what is made of messages as they should not be, and of those of a publisher that was started again."""
    first, last = desk.body.joint_names[0], desk.body.joint_names[-1]
    cases: tuple[tuple[str, JointState, dict[str, float], str], ...] = (
        (f"a message with {first} at 0", joint_state([first], [0.0], 100_005), {first: 0.0}, ZERO),
        (f"a message with {first} at -0.1", joint_state([first], [-0.1], 100_006), {first: -0.1}, BELOW),
        (f"a message with NaN for {first}", joint_state([first, last], [nan, 0.07], 100_007), {last: 0.07}, NAN),
        ("a message with 2 names and 1 position", joint_state([last, first], [0.11], 100_008), {last: 0.11}, SHORT),
        ("a message with 2 names and no position", joint_state([first, last], [], 100_009), {}, SHORT),
        (
            "a publisher that was started again",
            joint_state([first, last], [0.3, 0.2], 5),
            {first: 0.3, last: 0.2},
            RESTARTED,
        ),
        ("and its next message", joint_state([first, last], [0.31, 0.21], 6), {first: 0.31, last: 0.21}, RESTARTED),
    )
    for when, message, moves, cause in cases:
        before = dict(zip(desk.body.joint_names, desk.positions()))
        wanted = rounded(tuple({**before, **moves}.values()))
        try:
            publish(message)
            desk.drain()
            if desk.positions() == wanted:
                continue
            unchanged = desk.positions() == tuple(before.values())
            late = unchanged and _happens_later(publish, message, lambda: _shows(desk, wanted))  # noqa: B023
        except Failure as failure:
            return failure.finding(cause if isinstance(failure.error, (LookupError, ValueError)) else None, when)
        said = ", ".join(f"{name} at {position:g}" for name, position in zip(before, desk.positions()))
        dropped = THROTTLED if late else NAN_DROPS if cause is NAN else cause
        return wrong(f"{when}: it shows {said}", dropped if unchanged else cause)
    return right("messages with 0, NaN or too few positions, and those after a new start, are shown as far as they go")


def _judge_all_shown(desk: Desk, publish: Publish, post: str) -> Finding:
    """Look whether messages that wait together are all shown, in order."""
    first, last = desk.body.joint_names[0], desk.body.joint_names[-1]
    with watch.clocks_stand():
        for i, (name, position) in enumerate(((first, 0.12), (last, 0.13), (first, 0.14), (first, 0.15), (last, 0.16))):
            publish(joint_state([name], [position], 7 + i))
        desk.drain()
    seen = dict(zip(desk.body.joint_names, desk.positions()))
    text = "five messages that wait together"
    if (seen[first], seen[last]) == (0.15, 0.16):
        return right(f"{text}: all are shown, in order")
    said = f"{first} is shown at {seen[first]:g}, not 0.15, and {last} at {seen[last]:g}, not 0.16"
    early = seen[first] in (0.12, 0.14) or seen[last] == 0.13
    cause = LATEST_USED if desk.keys else ORDER if early else READS_NEWEST.format(post=post)
    cause = THROTTLED if "clock" in watch.noted else cause
    return wrong(f"{text}: {said}", cause)


def judge_held_up(desk: Desk, subscription: WatchedSubscription) -> Finding:
    """Look whether a callback returns while the body is drawn."""
    names = desk.body.joint_names
    first, second = (joint_state(names, [q] * len(names), 20 + i) for i, q in enumerate((0.21, 0.22)))
    held_up = []
    with ThreadPoolExecutor(1) as executor:
        thread = executor.submit(threading.get_native_id).result()

        def call_back() -> None:
            called, asleep = executor.submit(subscription.call_back, second), 0
            while not wait([called], 0.01).done and asleep < HELD_UP:
                asleep += _sleeps(thread)
            held_up.append(not called.done())

        desk.while_drawn = call_back
        subscription.call_back(first)
        desk.drain()
    desk.drain()
    when = "a message that comes while the body is drawn"
    if any(held_up):
        return wrong(f"{when}: the callback waits until it is", HELD)
    return right(f"{when}: the callback does not wait for it")


def _sleeps(thread: int) -> bool:
    """Whether a thread of this process waits for something, rather than for the processor; where Linux tells."""
    stat = Path(f"/proc/self/task/{thread}/stat")
    return not stat.exists() or stat.read_text().rpartition(")")[2].split()[0] == "S"


def judge_two(answer: type[SimpleController], shared: SharedState) -> Finding:
    """Look at two viewers at the same time, each of a body of its own."""
    with Desk(answer, "tank", "Tank") as tank, Desk(answer, "crane", "Lift") as lift:
        desks = (tank, lift)
        made = [endpoint(d.ros.node, WatchedSubscription, f"/{d.body.name}/joint_state", JointState) for d in desks]
        for order in (desks, desks[::-1]):
            wanted = []
            for i, (desk, subscription) in enumerate(zip(desks, made)):
                names = desk.body.joint_names
                pose = tuple(desk.positions()[0] + 0.1 * (i + 1) + 0.01 * k for k in range(len(names)))
                wanted.append(rounded(pose))
                if subscription is not None:
                    subscription.call_back(joint_state(names, pose, 100_000))
            try:
                for desk in order:
                    desk.drain()
            except Failure as failure:
                return failure.finding(shared.cause(SHARED), "two viewers at the same time")
            if [desk.positions() for desk in desks] != wanted:
                text = "two viewers at the same time: what one hears is shown by the other, or by none"
                return wrong(text, shared.cause(SHARED))
    return right("two viewers at the same time: each shows what it hears itself")


def rounded(positions: tuple[float, ...]) -> tuple[float, ...]:
    """Round positions [rad or m] as `Desk.positions` does."""
    return tuple(round(position, 6) for position in positions)
