"""Hostile joint states, in a minute's soak a million through a matcher, and a hundred thousand through a viewer.

In the first half of each, every message has one fault, and what was counted has to agree with what was made. In the
second all faults come at once, and garbage between them: then nothing may fail, and no joint be shown where no number
is. Throughout, memory stays flat after the first tenth.
"""

from __future__ import annotations

import asyncio
import logging
import time
from collections import Counter
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from itertools import count
from math import isfinite
from random import Random
from struct import unpack
from typing import Any

import tutorial  # noqa: F401 - promises an rclpy

# isort: split
from memory import BOUND, Memory, Trend
from rclpy.qos import HistoryPolicy, QoSProfile
from rich.console import Console
from rich.table import Table
from sensor_msgs.msg import JointState
from tqdm import tqdm

from tutorial.host import Host
from tutorial.joints import JointMatcher
from tutorial.paths import find_project
from tutorial.project import Project
from tutorial.ros.chaos import FAULTS, Chaos
from tutorial.ros.chaos.faults import CONTROL, MARKUP, SECOND_NS
from tutorial.ros.chaos.stream import JOINTS, TOPIC, swing
from tutorial.ros.node_thread import NodeThread

MATCHED_IN_A_MINUTE, VIEWED_IN_A_MINUTE = 1_000_000, 100_000
WARM_UP = 0.1
GARBAGE = 0.05  # of the messages of the second half
PATIENCE = 60.0  # [s] until the viewer has shown a message
KEEP_ALL = QoSProfile(history=HistoryPolicy.KEEP_ALL)
NAMES = (*JOINTS, *MARKUP, *CONTROL, "", "x" * 10_000)
COUNTED = {"unknown": ("rename", "markup", "control"), "duplicate": ("duplicate",), "late": ("late",)}
COUNTED |= {"non_finite": ("nan", "infinite")}
"""By what is counted of messages, the faults that cause one each."""


@dataclass
class Outcome:
    """What became of the messages of one kind.

    Attributes:
        kind: where they went.
        messages: how many there were.
        seconds: how long it took [s].
        memory: of this process.
        wrong: what does not hold.
    """

    kind: str
    messages: int = 0
    seconds: float = 0.0
    memory: Trend | None = None
    wrong: list[str] = field(default_factory=list)

    def complaints(self) -> Iterator[str]:
        """What does not hold of what should."""
        yield from self.wrong
        if self.memory is not None and self.memory.growth > BOUND:
            yield f"memory has grown by {self.memory.growth:.1f} MB, at most {BOUND:g} are allowed"


class Hostility:
    """Makes hostile messages, and knows what should be counted of those with one fault each.

    Args:
        seed: the same one makes the same messages.
        faults: those to choose from.
    """

    def __init__(self, seed: int, faults: Iterable[str] = FAULTS) -> None:
        self._random = Random(seed)
        self._faults = [name for name in faults if name != "type"]  # another type does not arrive
        self._counted = [name for name in self._faults if name != "second"]  # whose good messages are no faults
        self._chaos = Chaos(seed=seed)
        self._uneven: Counter[str] = Counter()
        self._numbers = count()

    def with_one_fault(self) -> list[Any]:
        """Make what becomes of the next good message when one fault hits it."""
        self._chaos.faults = {self._random.choice(self._counted): 1.0}
        messages = self._next()
        for message in messages:
            missing = len(message.name) - len(message.position)
            self._uneven["short" if missing > 0 else "long"] += abs(missing)
        return messages

    def with_all_faults(self) -> list[Any]:
        """Make what becomes of the next good message when many faults hit it; now and then garbage."""
        if self._random.random() < GARBAGE:
            return [self._garbage()]
        self._chaos.faults = dict.fromkeys(self._faults, 0.3)
        return self._next()

    def counts(self) -> dict[str, int]:
        """What has to have been counted of the messages with one fault."""
        made = self._chaos.made
        return {kind: sum(made[name] for name in names) for kind, names in COUNTED.items()} | self._uneven

    def _next(self) -> list[Any]:
        actions = self._chaos.apply(swing(next(self._numbers)))
        return [action.message for action in actions if action.message is not None]

    def _garbage(self) -> JointState:
        random = self._random
        message = JointState(name=random.choices(NAMES, k=random.randrange(20)))
        message.position = [unpack("d", random.randbytes(8))[0] for _ in range(random.randrange(20))]
        message.header.stamp.sec = random.randrange(-(2**31), 2**31)
        message.header.stamp.nanosec = random.randrange(SECOND_NS)
        return message


def agree(counted: dict[str, int], made: dict[str, int]) -> Iterator[str]:
    """Say where what was counted is not what was made; what nobody counts is not compared."""
    for kind in made.keys() & counted.keys():
        if counted[kind] != made[kind]:
            yield f"{counted[kind]} {kind} were counted, but {made[kind]} made"


def match(messages: int, progress: Callable[[float], object]) -> Outcome:
    """Have a matcher match so many hostile messages.

    Args:
        messages: how many.
        progress: called with the number that is done.
    """
    outcome, memory = Outcome("matcher"), Memory()
    began = time.monotonic()
    hostility, matcher = Hostility(1), JointMatcher(dict.fromkeys(JOINTS, (-1.0, 1.0)))
    counted: Counter[str] = Counter()
    displayed: set[bool] = set()
    for make in (hostility.with_one_fault, hostility.with_all_faults):
        end = outcome.messages + messages // 2
        while outcome.messages < end:
            for message in make():
                positions, report = matcher.match(message)
                displayed.update(map(isfinite, positions.values()))
                counted.update(report.counts())
                str(report)
                outcome.messages += 1
            memory.look()
            progress(outcome.messages)
        if make == hostility.with_one_fault:
            outcome.wrong += agree(counted, hostility.counts())
    if False in displayed:
        outcome.wrong.append("joints were to be displayed where no number is")
    outcome.seconds, outcome.memory = time.monotonic() - began, memory.trend(WARM_UP)
    return outcome


def view(messages: int, progress: Callable[[float], object]) -> Outcome:
    """Have the viewer of step 3, as ``tank run step3 --headless`` is, show so many hostile messages.

    Args:
        messages: how many. Each is published when the one before it has been shown, so none is lost.
        progress: called with the number that is done.
    """
    with logged() as lines:
        outcome = asyncio.run(_view(messages, progress))
    if len(lines) > 2 + outcome.seconds:
        outcome.wrong.append(f"{len(lines)} lines were logged in {outcome.seconds:.0f} s")
    return outcome


async def _view(messages: int, progress: Callable[[float], object]) -> Outcome:
    outcome, memory = Outcome("viewer"), Memory()
    hostility = Hostility(2, (name for name in FAULTS if name != "second"))  # it follows one publisher
    shown = asyncio.Event()
    async with Host(Project.load(find_project("step3"))) as host:
        body = host.bodies["Tank"]
        body.on_change(lambda _: shown.set())
        running = asyncio.ensure_future(host.run())
        with NodeThread("hostile") as thread:
            publisher = thread.node.create_publisher(JointState, TOPIC, KEEP_ALL)
            while not publisher.get_subscription_count():
                await asyncio.sleep(0.01)
            began = time.monotonic()
            for make in (hostility.with_one_fault, hostility.with_all_faults):
                end = outcome.messages + messages // 2
                while outcome.messages < end:
                    for message in make():
                        shown.clear()
                        publisher.publish(message)
                        await asyncio.wait_for(shown.wait(), PATIENCE)
                        outcome.messages += 1
                        if not all(isfinite(joint.position) for joint in body.joints):
                            raise SystemExit(f"displayed where no number is: {body.joints}, after {message}")
                    memory.look()
                    progress(outcome.messages)
                if make == hostility.with_one_fault:
                    outcome.wrong += agree(host.record()["report"], hostility.counts())
            outcome.seconds, outcome.memory = time.monotonic() - began, memory.trend(WARM_UP)
        running.cancel()
        if host.error is not None:
            outcome.wrong.append(f"the viewer failed: {host.error!r}")
    return outcome


@contextmanager
def logged() -> Iterator[list[str]]:
    """Take down what the library logs, in place of the terminal."""
    lines: list[str] = []
    handler = logging.Handler()
    handler.emit = lambda record: lines.append(record.getMessage())  # type: ignore[method-assign]
    logger = logging.getLogger("tutorial")
    propagate, logger.propagate = logger.propagate, False
    logger.addHandler(handler)
    try:
        yield lines
    finally:
        logger.removeHandler(handler)
        logger.propagate = propagate


def table(outcomes: list[Outcome]) -> Table:
    """What became of the hostile messages."""
    shown = Table("hostile messages", "through the", "each [us]", "memory [MB]: start", "end", "growth")
    shown.caption = f"resident memory, after a warm-up of {WARM_UP:.0%}; each: made, sent and shown."
    for outcome in outcomes:
        memory = outcome.memory
        each = f"{1e6 * outcome.seconds / outcome.messages:.0f}"
        row = (f"{memory.start:.1f}", f"{memory.end:.1f}", f"{memory.growth:+.1f}")
        shown.add_row(f"{outcome.messages:,}", outcome.kind, each, *row)
    return shown


def hostile(duration: float, console: Console) -> list[str]:
    """Send hostile messages through a matcher and a viewer; print what became of them, and return what does not hold.

    Args:
        duration: how many messages there are, as the time of the other traffic: in 60 s they are all of them [s].
        console: where to print.
    """
    outcomes = []
    for run, in_a_minute in ((match, MATCHED_IN_A_MINUTE), (view, VIEWED_IN_A_MINUTE)):
        messages = max(round(in_a_minute * duration / 60), 1000)
        console.print(f"{messages:,} hostile messages to {run.__name__}:")
        with tqdm(total=messages, mininterval=2.0, ascii=" =") as bar:
            outcomes.append(run(messages, lambda done, bar=bar: bar.update(min(done, bar.total) - bar.n)))
    console.print(table(outcomes))
    return [f"{outcome.kind}: {complaint}" for outcome in outcomes for complaint in outcome.complaints()]
