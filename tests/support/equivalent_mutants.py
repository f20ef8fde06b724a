"""The mutants that are right answers, too: a check has to take them."""

from __future__ import annotations

import ast
from itertools import pairwise, starmap

from tutorial.checks.catalogue import exercises
from tutorial.checks.exercise import listing

EXERCISES = {each.name: each for those in exercises().values() for each in those}


def becomes(line: str, *others: str) -> tuple[str, ...]:
    """The changes of one line."""
    return tuple(f"{line} → {other}" for other in others)


def swapped(one: str, other: str) -> str:
    """The change of two statements that follow each other."""
    return f"{one}; {other} → {other}; {one}"


def exchanged(name: str, *parts: tuple[str, str]) -> tuple[str, ...]:
    """The changes of parts of an exercise's right answer: of each two neighbours, the second comes first.

    Args:
        name: the exercise's.
        parts: how the first line of each part begins, and how the last one does.
    """
    lines = [line.strip() for line in ast.unparse(ast.parse(listing(EXERCISES[name].right_answer))).splitlines()]
    found: list[str] = []
    for first, last in parts:
        begin = next(i for i, line in enumerate(lines) if line.startswith(first))
        end = next(i for i, line in enumerate(lines) if i > begin and line.startswith(last))
        found += starmap(swapped, pairwise(lines[begin : end + 1]))
    return tuple(found)


UNRELATED = "neither statement uses what the other sets"
EVEN = "the remainder is never negative, and a multiple of n is one of -n"
WHAT_IS_TOLD = "that observers are told is asked for, not what"
FIRST = "at which step the first message is sent is left to the answer"

PRESSED = "pressed = len(message.buttons) > 0 and message.buttons[0] == 1"
FOUR_AXES = "axes = [*message.axes[:4], 0.0, 0.0, 0.0, 0.0][:4]"
AXES = "left_x, left_y = (axis if abs(axis) {} 0.3 else 0.0 for axis in axes[:2])"
LATEST = "self.call_latest(self.body.name, self.update, message)"
TOLD = "self.body.notify_change({})"
PER_MESSAGE = "self.steps_per_message = round(1 / (25 * io.time_step))"
PER_LOOK = "self.steps_per_look = round(1 / (50 * io.time_step))"
DUE = "if self.io.step % self.steps_per_message == 0:"
LOOK_DUE = DUE.replace("message", "look")

PER_TENTH = PER_MESSAGE.replace("25", "10")
PER_PICTURE = PER_MESSAGE.replace("25", "5").replace("message", "picture")
PICTURE_DUE = DUE.replace("message", "picture")

STAMP = "stamp = (message.header.stamp.sec, message.header.stamp.nanosec)"
STAMP_TURNED = "stamp = (message.header.stamp.nanosec, message.header.stamp.sec)"
TWO = "if len(together) == 2:"
DROP = "del self.waiting[next(iter(self.waiting))]"
COMPLETE = f"{TWO}; while stamp in self.waiting:; {DROP}; return (together['joints'], together['pose'])"
TOO_MANY = f"if len(self.waiting) > 50:; {DROP}"


def now_and_then(due: str, line: str, rate: str) -> dict[str, tuple[str, ...]]:
    """Those of an answer that publishes at a rate: of its condition, and of the number of steps."""
    remainder = due.removeprefix("if ").removesuffix(" == 0:")
    step, steps = remainder.split(" % ")
    evens = (f"{remainder} <= 0", f"-({remainder}) == 0", f"-{remainder} == 0", f"{step} % -{steps} == 0")
    return {
        EVEN: (*becomes(due, *(f"if {even}:" for even in evens)), *negative(line, rate)),
        FIRST: becomes(due, due.replace("0", "1")),
    }


def negative(line: str, rate: str) -> tuple[str, ...]:
    """The changes of a number of steps that turn its sign round."""
    parts = (f"({rate} * io.time_step)", "io.time_step", "1 /", rate)
    return becomes(line, *(line.replace(part, f"-{part}") for part in parts))


def displaying(name: str) -> dict[str, tuple[str, ...]]:
    """Those of an exercise whose answer shows joint states."""
    return {
        UNRELATED: exchanged(name, ("self.body", "topic")),
        WHAT_IS_TOLD: becomes(TOLD.format("report"), TOLD.format("message"), TOLD.format("positions")),
    }


EQUIVALENT: dict[str, dict[str, tuple[str, ...]]] = {
    "fire": {
        "a length is never negative": becomes(PRESSED, PRESSED.replace(">", "!=")),
        "a button is 0 or 1": becomes(PRESSED, PRESSED.replace("==", ">=")),
    },
    "bound": {
        "of however many are taken at first, four are left in the end": becomes(
            FOUR_AXES, FOUR_AXES.replace("axes[:4]", "axes[:5]")
        ),
    },
    "timeout": {UNRELATED: (swapped("self.message = message", "self.since = seconds"),)},
    "drive": {
        UNRELATED: exchanged(
            "drive",
            ("self.node", "self.joy ="),
            ("self.track_l =", "self.track_r ="),
            ("self.track_l.ctrl", "self.track_r.ctrl"),
        ),
        "an axis is a float32, and 0.3 is none": becomes(AXES.format(">"), AXES.format(">=")),
        "of four, those before the last two are the first two": becomes(
            AXES.format(">"), AXES.format(">").replace("[:2]", "[:-2]")
        ),
    },
    "aim": {
        UNRELATED: exchanged(
            "aim", ("self.joint =", "self.q_ref ="), ("dq_ref", "q ="), ("self.joint.effort", "self.q_ref, self.q_prev")
        ),
    },
    "publish": {
        UNRELATED: exchanged("publish", ("self.io", "self.steps"), ("message.header", "message.effort")),
        **now_and_then(DUE, PER_MESSAGE, "25"),
    },
    "thrift": {
        UNRELATED: exchanged("thrift", ("self.io", "self.steps"), ("self.publisher.publish", "self.sent")),
        EVEN: now_and_then(LOOK_DUE, PER_LOOK, "50")[EVEN],
    },
    "show": displaying("show"),
    "keep_up": {
        **displaying("keep_up"),
        "any key does that is the same for every message: a controller's keys are its own": becomes(
            LATEST, LATEST.replace("name", "joint_names")
        ),
    },
    "gyro": {
        UNRELATED: exchanged(
            "gyro",
            ("self.io", "self.steps"),
            ("message.header.stamp", "velocity ="),
            ("velocity.x", "message.linear"),
            ("self.publisher.publish", "self.samples"),
        ),
        **now_and_then(DUE, PER_TENTH, "10"),
    },
    "hop": {
        UNRELATED: exchanged(
            "hop",
            ("self.body", "self.timer"),
            ("self.node.destroy", "self.land"),
            ("timer.cancel", "self.move"),
            ("self.move((x", "self.timer"),
        ),
        "what is posted runs on the main thread, and so not before configure has ended": exchanged(
            "hop", ("self.timer", "self.subscription")
        ),
    },
    "pair": {
        "a function without a return returns None": becomes("return None", "nothing", "return"),
        "a key is a key in either order": becomes(STAMP, STAMP_TURNED),
        "of a stamp there are never more than two": becomes(TWO, TWO.replace("==", ">=")),
        "a message that completes a pair makes no more wait": (swapped(COMPLETE, TOO_MANY),),
    },
    "gray": {
        UNRELATED: exchanged("gray", ("self.io", "self.steps"), ("message.header.stamp", "message.data")),
        **now_and_then(PICTURE_DUE, PER_PICTURE, "5"),
    },
    "gaps": {
        UNRELATED: exchanged("gaps", ("found", "newest")),
        "the bag's own time is not used": becomes(
            "for _, message in messages:",
            "for message, message in messages:",
            "for stamp, message in messages:",
        ),
    },
}
