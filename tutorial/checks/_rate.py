"""Looking at when messages are sent, and how they are stamped: by simulated time, or by something else."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

from tutorial.checks._answer import missing
from tutorial.checks._node import WatchedPublisher
from tutorial.checks._topics import endpoint
from tutorial.checks._verdict import Finding, right, wrong
from tutorial.checks._watch import watch
from tutorial.checks._world import Moment, World
from tutorial.controller import SimpleController

__all__ = ["Rate", "judge_source", "judge_stamps", "steps_of"]

SECOND = 1_000_000_000  # [ns]

NOTHING = "Most likely control never comes to publish: look at the condition, io.step % steps_per_message == 0."
TIMER = (
    "Most likely a timer publishes: it goes by the wall clock, on the executor's thread. Count steps in control: "
    "simulated time is io.step * io.time_step."
)
THREAD = (
    "Most likely a thread of its own publishes: it goes by the wall clock, and the simulated body belongs to the "
    "simulation's thread. Publish in control, and count steps."
)
CLOCK = (
    "Most likely the computer's clock says when to publish: simulated time goes faster or slower. Count steps, "
    "io.step % steps_per_message == 0."
)
EVERY_STEP = "Most likely control publishes at every step: do so only when io.step % steps_per_message == 0."
TURNED = "Most likely the condition is turned round: publish when io.step % steps_per_message == 0, and not otherwise."
UNEVEN = "Most likely something else than the number of steps says when to publish: io.step % steps_per_message == 0."
STEPS = "round(1 / ({hz} * io.time_step))"
RATE_FOR_STEPS = f"Most likely the rate, {{hz}} in a second, is taken for the number of steps: that is {STEPS}."
ONE_OFF = f"Most likely the count is off by one: from one message to the next there are {STEPS} steps."
PERIOD = f"Most likely the period is another: it is {STEPS} steps."
FIXED_STEPS = "Most likely the number of steps is written down for 1 ms: compute it from io.time_step."
STAMP = "message.header.stamp = Time(nanoseconds=self.io.time_ns).to_msg()"
NO_STAMP = f"Most likely the stamp is left out: {STAMP}."
WALL_CLOCK = "Most likely that is the wall clock's time: take the simulation's, self.io.time_ns."
ONLY_SECONDS = f"Most likely only whole seconds are set, and nanosec stays 0: {STAMP} sets both."
ONLY_NANOSECONDS = f"Most likely only nanosec is set, and sec stays 0: {STAMP} sets both."
UNIT = f"Most likely the unit is wrong, {{}} for nanoseconds: {STAMP}."
FIXED_STAMP = f"Most likely the stamp is set once and kept: set it in control, for every message. {STAMP}."
OLD_STAMP = f"Most likely the stamp is that of another step: set it in control, right before sending. {STAMP}."
OTHER_STAMP = f"Compare with {STAMP}, at the time of sending."


def judge_source(answer: type[SimpleController], world: World) -> Finding | None:
    """Look whether messages come from somewhere else than control; None if not."""
    if world.ros.node.timers_made:
        return wrong("messages come from a timer", TIMER)
    if "thread" in watch.noted:
        return wrong("messages come from a thread of its own", THREAD, watch.noted["thread"])
    return missing(answer, "control")


@dataclass(frozen=True)
class Rate:
    """How often messages are asked for.

    Attributes:
        hz: in a simulated second.
        several: the cause of two messages at one step.
        others: other rates [Hz], each with the cause to name.
    """

    hz: int
    several: str
    others: Mapping[int, str]

    def judge(self, publisher: WatchedPublisher, time_step: float) -> Finding:
        """Look how often it has published in 1.2 s [simulated time]."""
        if len(publisher.sent) < 2:
            cause = CLOCK if "clock" in watch.noted else NOTHING
            return wrong(f"in 1.2 s, {('no message', '1 message')[len(publisher.sent)]} was sent", cause)
        steps = steps_of(publisher)
        periods = [b - a for a, b in pairwise(steps)]
        wanted = round(1 / (self.hz * time_step))
        said = f"it publishes {self.of(publisher, time_step)} times per simulated second"
        even = all(abs(period - wanted) <= 1 for period in periods)
        if even and abs(steps[-1] - steps[0] - wanted * len(periods)) <= 1:
            return right(f"{said}, with steps of {time_step * 1000:g} ms")
        return wrong(f"{said}, not {self.hz}", self._why(periods, time_step).format(hz=self.hz))

    def of(self, publisher: WatchedPublisher, time_step: float) -> float:
        """Return how often it publishes in a simulated second, a whole number unless that is near but not quite it."""
        steps = steps_of(publisher)
        exact = (len(steps) - 1) / ((steps[-1] - steps[0] or 1) * time_step)
        return round(exact) if round(exact) != self.hz or abs(exact - self.hz) < 0.05 else round(exact, 1)

    def judge_step(
        self, world: World, topic: str, message_type: type, usual: WatchedPublisher, finding: Finding
    ) -> Iterator[Finding]:
        """Look whether the rate is the same with another time step, be it the right one or not.

        Args:
            world: with the other time step, not entered yet; 600 steps of it pass.
            topic, message_type: of the publisher to look at; where there is none, nothing is said.
            usual: the publisher that was looked at with steps of 1 ms.
            finding: what was found then.
        """
        time_step = world.simulation.time_step
        with world:
            world.advance(600)
            publisher = endpoint(world.ros.node, WatchedPublisher, topic, message_type)
        if publisher is None:
            return
        other = self.judge(publisher, time_step)
        when = f"with steps of {time_step * 1000:g} ms"
        if finding.right:
            yield other if other.right else wrong(f"{when}, {other.text}", FIXED_STEPS)
        elif min(len(usual.sent), len(publisher.sent)) > 1 and steps_of(usual)[1] - steps_of(usual)[0] > 1:
            before, after = self.of(usual, 0.001), self.of(publisher, time_step)
            if abs(after - before) > 0.25 * before and finding.cause not in (CLOCK, RATE_FOR_STEPS.format(hz=self.hz)):
                yield wrong(f"{when}, it publishes {after} times per simulated second", FIXED_STEPS)

    def _why(self, periods: Sequence[int], time_step: float) -> str:
        """Name the likeliest cause of the numbers of steps between messages."""
        if "clock" in watch.noted:
            return CLOCK
        if 0 in periods:
            return self.several
        wanted = round(1 / (self.hz * time_step))
        others = {round(1 / (hz * time_step)): cause for hz, cause in self.others.items()}
        known = {1: EVERY_STEP, **others, self.hz: RATE_FOR_STEPS, wanted - 1: ONE_OFF, wanted + 1: ONE_OFF}
        if len(set(periods)) == 1:
            return known.get(periods[0], PERIOD)
        return TURNED if set(periods) == {1, 2} else UNEVEN


def steps_of(publisher: WatchedPublisher) -> list[int]:
    """Return the steps at which it has published."""
    return [moment.step for _, moment in publisher.sent]


def judge_stamps(sent: Sequence[tuple[Any, Moment]]) -> Finding:
    """Look whether the messages' stamps are simulated time."""
    stamps = [m.header.stamp.sec * SECOND + m.header.stamp.nanosec for m, _ in sent]
    times = [moment.time_ns for _, moment in sent]
    if _equal(stamps, times):
        return right("the stamps are simulated time")
    if not any(stamps) and times[-1] < SECOND:
        return wrong("the stamps are 0", NO_STAMP)
    if min(stamps) > 1_000_000 * SECOND or "clock" in watch.noted:
        return wrong("the stamps are not simulated time", WALL_CLOCK)
    guesses = (
        ([0] * len(times), "the stamps are 0", NO_STAMP),
        ([time - time % SECOND for time in times], "the stamps are whole seconds", ONLY_SECONDS),
        ([time % SECOND for time in times], "the stamps begin at 0 in every second", ONLY_NANOSECONDS),
        ([time // 1000 for time in times], "the stamps are a thousandth of it", UNIT.format("microseconds")),
        ([time // 1_000_000 for time in times], "the stamps are a millionth of it", UNIT.format("milliseconds")),
        ([time // SECOND for time in times], "the stamps are next to nothing", UNIT.format("seconds")),
        ([stamps[0]] * len(times), "the stamps are all the same", FIXED_STAMP),
        ([time + stamps[-1] - times[-1] for time in times], "the stamps are of another time", OLD_STAMP),
    )
    for guess, text, cause in guesses:
        if _equal(stamps, guess):
            return wrong(text, cause)
    return wrong("the stamps are not the simulated time of sending", OTHER_STAMP)


def _equal(stamps: Sequence[int], times: Sequence[int]) -> bool:
    """Whether stamps are times [ns], but for what a float may lose."""
    return all(abs(a - b) <= 2 for a, b in zip(stamps, times))
