"""Exercises about what is displayed: a list of requirements, each with the mistakes that fail it."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from contextlib import closing
from dataclasses import dataclass
from functools import cached_property
from string import Template
from typing import Any

from tutorial.checks._cases import observed, same
from tutorial.checks._mistakes import Mistake, mistakes, with_mistakes
from tutorial.checks._node import ros_node, send
from tutorial.checks._shared import SharedState
from tutorial.checks._verdict import Finding, right, wrong
from tutorial.checks._viewer import Step, Viewer
from tutorial.checks._watch import Failure, watch
from tutorial.errors import TutorialError

__all__ = ["Requirements"]

THROTTLED = "Most likely messages are dropped by time or by count: post and show every one, whenever it comes."
SHARED = """
# on a body called Rover it listens to
the topic is another: it is f"{config.body.name}/$topic".
    {self.body.name}/$topic" => {self.body.name}/${topic}s" => Tank/$topic"
config.node.create_subscription($kind, ...) is missing, or not reached.
    self.node.create_subscription( => (

# for messages of the type
the type of the messages is another: give $kind first.
    ($kind, => (Joy,

# messages come
$post is missing, or not reached: the callback posts nothing.
    $post => pass

# the news of it
self.body.calc_forward_kinematics() is missing, or not reached: the links stay behind.
    self.body.calc_forward_kinematics() => pass
self.body.calc_forward_kinematics() comes too early: the links stay behind what is moved after it.
    self.body.calc_forward_kinematics() => pass
    $move => self.body.calc_forward_kinematics() // $move
self.body.notify_change() is missing, or not reached: nobody is told to draw.
    self.body.notify_change( => bool(
self.body.notify_change() comes too early: first the move, then the kinematics, then the news of it.
    self.body.notify_change( => bool(
    $move => self.body.notify_change() // $move

# one that waits when the controller leaves
it goes to the event loop by itself: $post is asked for, and drops what still waits when the controller leaves its body.
    self.node = config.node => self.node, self.loop = config.node, asyncio.get_running_loop()
    $post => self.loop.call_soon_threadsafe(self.update, message)
"""


@dataclass(frozen=True)
class Requirements:
    """What an answer has to do, one thing after the other.

    Attributes:
        solution: the right answer. What is observed of it is what is expected, and mistakes change its source.
        topic: that it listens to, without the body's name.
        message: what it is sent by another program in the end, with rclpy's own node.
        move: the solution's statement that moves the body.
        tried: by text, in the order in which they are tried, steps: functions of the viewer, of which each may return
            what is observed, in words. The first text whose steps do not see what is expected ends it.
        table: the mistakes, those that fail a requirement below a line with ``#`` and its text. To them come those that
            all viewers share. The first one's cause is named where no other leads to exactly what was observed.
        post: the solution's statement that posts.
        viewer: makes what an answer is tried in.
        clock: the cause to name where the computer's clock is asked; "" where that may be right.
        odd: exceptions that odd messages lead to: a requirement's cause is named. Any other speaks for itself.
    """

    solution: type
    topic: str
    message: Any
    move: str
    tried: Mapping[str, Sequence[Step]]
    table: str
    post: str = "self.call_later(self.update, message)"
    viewer: type[Viewer] = Viewer
    clock: str = THROTTLED
    odd: tuple[type[Exception], ...] = (LookupError, ValueError, ArithmeticError, TutorialError)

    def judge(self, answer: type) -> Iterator[Finding]:
        """Try an answer, and say of each requirement what was observed."""
        shared = SharedState(answer)
        for text in self.tried:
            expected, seen = self.seen(text, self.solution), self.seen(text, answer)
            if seen == expected:
                yield right(f"{text}: {seen}")
                continue
            place = next(iter(watch.noted.values()), None)
            by_the_clock = self.clock if "clock" in watch.noted else ""
            cause = self._cause(text, seen, shared)
            if isinstance(seen, Failure):
                yield seen.finding(cause, text)
            else:
                yield wrong(f"{text}: {seen}; expected: {expected}", by_the_clock or cause or "", place)
            return
        with ros_node() as node, closing(self.viewer(answer, node=node)) as viewer:
            send(node, f"/Rover/{self.topic}", self.message, lambda: viewer.loop.posted)
            viewer.drain()
            yield right(f"with another program: {viewer.where()}")

    def seen(self, text: str, answer: Any) -> Any:
        """Observe what an answer does; of one that raises, the failure."""
        watch.noted.clear()

        def attempt(answer: Any) -> str:
            with watch.clocks_stand(), closing(self.viewer(answer)) as viewer:
                return ", ".join(dict.fromkeys(filter(None, [step(viewer) for step in self.tried[text]])))

        return observed(attempt, answer)

    @cached_property
    def mistakes(self) -> dict[str, tuple[Mistake, ...]]:
        """By requirement, the mistakes that fail it."""
        known: dict[str, tuple[Mistake, ...]] = {}
        for each in (SHARED, self.table):
            table = Template(each).substitute(vars(self), kind=type(self.message).__name__)
            _, *parts = re.split(r"^# (.*)$", table, flags=re.MULTILINE)
            known |= {text: known.get(text, ()) + mistakes(rows) for text, rows in zip(parts[::2], parts[1::2])}
        return known

    def mistaken(self, mistake: Mistake) -> Any:
        """Define the solution with a mistake in it."""
        return with_mistakes(self.solution, [mistake])

    def _cause(self, text: str, seen: Any, shared: SharedState) -> str | None:
        """Name the mistake that leads to what was observed; None for what speaks for itself."""
        watch.explaining = True
        watch.files.add("<a mistake>")  # as if the learner had written that
        known = self.mistakes.get(text, ())
        found = next((each for each in known if same(self.seen(text, self.mistaken(each)), seen)), None)
        if not known or (isinstance(seen, Failure) and not (found or isinstance(seen.error, self.odd))):
            return None
        cause = f"Most likely {(found or known[0]).cause}"
        return cause if found and "." not in shared.changed() else shared.cause(cause)
