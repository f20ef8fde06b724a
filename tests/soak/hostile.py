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
from collections.abc import Awaitable, Callable, Iterable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from itertools import count
from math import isfinite
from random import Random
from struct import unpack
from typing import Any

import tutorial  # noqa: F401 - promises an rclpy

# isort: split
from harness import GROWTH, MEMORY, Memory, above, console, show
from rclpy.qos import HistoryPolicy, QoSProfile
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

WARM_UP = 0.1
GARBAGE = 0.05  # of the messages of the second half
PATIENCE = 60.0  # [s] until the viewer has shown a message
NAMES = (*JOINTS, *MARKUP, *CONTROL, "", "x" * 10_000)
COUNTED = {"unknown": ("rename", "markup", "control"), "duplicate": ("duplicate",), "late": ("late",)}
COUNTED |= {"non_finite": ("nan", "infinite")}
"""By what is counted of messages, the faults that cause one each."""


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
        messages = self._next({self._random.choice(self._counted): 1.0})
        for message in messages:
            missing = len(message.name) - len(message.position)
            self._uneven["short" if missing > 0 else "long"] += abs(missing)
        return messages

    def with_all_faults(self) -> list[Any]:
        """Make what becomes of the next good message when many faults hit it; now and then garbage."""
        random = self._random
        if random.random() >= GARBAGE:
            return self._next(dict.fromkeys(self._faults, 0.3))
        message = JointState(name=random.choices(NAMES, k=random.randrange(20)))
        message.position = [unpack("d", random.randbytes(8))[0] for _ in range(random.randrange(20))]
        message.header.stamp.sec = random.randrange(-(2**31), 2**31)
        message.header.stamp.nanosec = random.randrange(SECOND_NS)
        return [message]

    def disagreements(self, counted: dict[str, int]) -> Iterator[str]:
        """Say where what was counted of the messages with one fault is not what was made of them."""
        made = {kind: sum(self._chaos.made[name] for name in names) for kind, names in COUNTED.items()} | self._uneven
        for kind in made.keys() & counted.keys():
            if counted[kind] != made[kind]:
                yield f"{counted[kind]} {kind} were counted, but {made[kind]} made"

    def _next(self, faults: dict[str, float]) -> list[Any]:
        self._chaos.faults = faults
        actions = self._chaos.apply(swing(next(self._numbers)))
        return [action.message for action in actions if action.message is not None]


@dataclass
class Outcome:
    """What has become of hostile messages: how many there were, in how many seconds, the memory, and what is wrong."""

    messages: int
    progress: Callable[[int], object]
    seconds: float = 0.0
    memory: tuple[float, float] = (0.0, 0.0)
    wrong: list[str] = field(default_factory=list)

    async def send(
        self,
        hostility: Hostility,
        take: Callable[[Any], Awaitable[Iterable[float]]],
        counted: Callable[[], dict[str, int]],
    ) -> None:
        """Send both halves: `take` takes a message and returns the positions displayed."""
        memory, began, done = Memory(), time.monotonic(), 0
        for make in (hostility.with_one_fault, hostility.with_all_faults):
            end = done + self.messages // 2
            while done < end:
                for message in make():
                    if not all(map(isfinite, await take(message))):
                        self.wrong.append(f"displayed where no number is, after {message}"[:500])
                    done += 1
                memory.look()
                self.progress(done)
            if make == hostility.with_one_fault:
                self.wrong += hostility.disagreements(counted())
        self.messages, self.seconds, self.memory = done, time.monotonic() - began, memory.trend(WARM_UP)


async def match(outcome: Outcome) -> None:
    """Have a matcher match hostile messages."""
    matcher = JointMatcher(dict.fromkeys(JOINTS, (-1.0, 1.0)))
    counted: Counter[str] = Counter()

    async def take(message: Any) -> Iterable[float]:
        positions, report = matcher.match(message)
        counted.update(report.counts())
        str(report)
        return positions.values()

    await outcome.send(Hostility(1), take, lambda: counted)


async def view(outcome: Outcome) -> None:
    """Have the viewer of step 3, as ``tank run step3 --headless`` is, show hostile messages.

    Each is published when the one before it has been shown, so none is lost.
    """
    shown = asyncio.Event()
    with logged() as lines:
        async with Host(Project.load(find_project("step3"))) as host:
            body = host.bodies["Tank"]
            body.on_change(lambda _: shown.set())
            running = asyncio.ensure_future(host.run())
            with NodeThread("hostile") as thread:
                keep_all = QoSProfile(history=HistoryPolicy.KEEP_ALL)
                publisher = thread.node.create_publisher(JointState, TOPIC, keep_all)
                while not publisher.get_subscription_count():
                    await asyncio.sleep(0.01)

                async def take(message: Any) -> Iterable[float]:
                    shown.clear()
                    publisher.publish(message)
                    await asyncio.wait_for(shown.wait(), PATIENCE)
                    return [joint.position for joint in body.joints]

                hostility = Hostility(2, (name for name in FAULTS if name != "second"))  # it follows one publisher
                await outcome.send(hostility, take, lambda: host.record()["report"])
            running.cancel()
            outcome.wrong += [] if host.error is None else [f"the viewer failed: {host.error!r}"]
    if len(lines) > 2 + outcome.seconds:
        outcome.wrong.append(f"{len(lines)} lines were logged in {outcome.seconds:.0f} s")


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


def hostile(duration: float) -> list[str]:
    """Send hostile messages through a matcher and a viewer; print what became of them, and return what does not hold.

    Args:
        duration: how many messages there are, as the time of the other traffic: in 60 s they are all of them [s].
    """
    outcomes = {}
    for run, in_a_minute in ((match, 1_000_000), (view, 100_000)):
        messages = max(round(in_a_minute * duration / 60), 1000)
        console.print(f"{messages:,} hostile messages to {run.__name__}:")
        with tqdm(total=messages, mininterval=2.0, ascii=" =") as bar:
            outcome = Outcome(messages, lambda done, bar=bar: bar.update(min(done, bar.total) - bar.n))
            asyncio.run(run(outcome))
        outcome.wrong += above((outcome.memory[1] - outcome.memory[0], GROWTH, MEMORY))
        outcomes[run.__name__] = outcome
    rows = (
        f"{name} {each.messages:,} {1e6 * each.seconds / each.messages:.0f} {each.memory[0]:.1f} {each.memory[1]:.1f} "
        f"{each.memory[1] - each.memory[0]:+.1f}".split()
        for name, each in outcomes.items()
    )
    show(
        ("hostile messages to", "messages", "each [us]", "memory [MB]: start", "end", "growth"),
        rows,
        f"resident memory, after a warm-up of {WARM_UP:.0%}; each: made, sent and shown.",
    )
    return [f"{name}: {complaint}" for name, each in outcomes.items() for complaint in each.wrong[:10]]
