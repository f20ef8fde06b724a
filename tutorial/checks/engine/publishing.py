"""Publishing: the cases and mistakes shared by all exercises about controllers that publish at a fixed rate."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

from rclpy.qos import qos_profile_sensor_data

from tutorial.checks.engine.cases import Case, Cases, Mistake, Run, both, replace
from tutorial.checks.engine.failure import Failure, Misuse
from tutorial.checks.engine.observe import same
from tutorial.checks.engine.real_dds import ros_node, wait
from tutorial.checks.engine.rig import APART, Rig, Sent
from tutorial.checks.engine.trial import Trial

NOTHING = "no message"
IN_CONFIGURE = (
    "Your code probably creates the publisher in initialize, which runs each time the simulation starts. "
    "Create the publisher once, in configure."
)
TOGETHER = (
    "Your code probably sends a message for each joint, or calls publish twice. Send a single message for all joints."
)
ALL_JOINTS = "your code hard-codes the joints' names, or their number. Use all joints of the body: io.body.joints."
SHARED_BY_ROBOTS = (
    "Your code probably stores state on the class, which all robots share. Store it on self, in initialize."
)
RESTART = (
    "Your code probably keeps state from the previous run, or counts steps or time from 0. "
    "After a restart, io.step and the time don't begin at 0."
)

# Returns an observation, given the rig and the sent messages.
Look = Callable[[Any, list[Sent]], Any]


@dataclass(frozen=True)
class Publishing:
    """An exercise whose controller publishes at a fixed rate.

    Attributes:
        kind: the class of the messages.
        topic: the topic without the body's name.
        hz: how many messages to send per simulated second.
        scene: makes a rig, given a trial and options for `Rig`.
        content: describes the content of messages, given the rig and the sent messages.
        time: the solution's expression for the stamp [ns].
        namespaces: whether the topic has to be in the node's namespace.
    """

    kind: type
    topic: str
    hz: int
    scene: Callable[..., Any]
    content: Look
    time: str = "self.io.time_ns"
    namespaces: bool = True

    def cases(self, solution: type, own: Sequence[Case], mistakes: Sequence[Mistake], meaning: str) -> Cases:
        """Combine an exercise's own cases and mistakes with those that all exercises about publishers share.

        Args:
            solution: the right answer.
            own: the exercise's own cases. They replace the shared cases that have the same label.
            mistakes: the exercise's own mistakes.
            meaning: the default `meaning` of a case; see `Cases`.
        """
        labels = {case.label for case in own}
        last = [
            Case("the stamp", self.stamps, self._stamp),
            Case("two robots in turn", self.two, SHARED_BY_ROBOTS),
            Case("after a restart", self.restarted, RESTART),
            Case("after unconfigure", lambda trial: self.play(trial, 0.1).leave()),
        ]
        tried = [*self._first(), *own, *(case for case in last if case.label not in labels)]
        return Cases(solution, tried, [*self._mistakes(), *mistakes], meaning, describe, on_ros=self.on_ros)

    def _first(self) -> list[Case]:
        made = f'config.node.create_publisher({self.kind.__name__}, f"{{config.body.name}}/{self.topic}", 1)'
        topic = f"Your code probably uses the wrong topic or type. In configure, write {made}, without a leading slash."
        condition = f"Your code probably tests the wrong condition. A message is due when {self.when}."
        return [
            Case("on the body Rover", self.topics("/"), topic),
            *[Case("on the body Rover, in the namespace /lab", self.topics("/lab"), topic)] * self.namespaces,
            Case("with steps of 1 ms", self.rate(1), condition),
            *(Case(f"with steps of {ms} ms", self.rate(ms), self.wrong_steps) for ms in (2, 3, 6)),
        ]

    def _mistakes(self) -> list[Mistake]:
        return [
            Mistake("your code uses the displayed body, config.body. The simulated body is io.body.",
                    both(replace("self.node = config.node", "self.node, self.shown = config.node, config.body"),
                         replace("self.io = io", "self.io, io.body = io, self.shown"))),
            Mistake(f"your code publishes at every step. Publish only if {self.when}.",
                    replace("self.io.step %", "0 * self.io.step %")),
        ]  # fmt: skip

    @property
    def when(self) -> str:
        """The solution's condition for publishing, in Python."""
        return f"io.step % round(1 / ({self.hz} * io.time_step)) == 0"

    @property
    def wrong_steps(self) -> str:
        """The `meaning` of a case with too many or too few messages."""
        return (
            "Your code probably hard-codes the number of steps between messages, truncates it, doesn't round it, "
            "or measures time instead of counting steps. "
            f"Publish when {self.when}."
        )

    @property
    def _stamp(self) -> str:
        return (
            "Your code probably doesn't set the stamp, sets it to a step count, reads a different clock, "
            "or computes sec or nanosec wrongly: nanosec restarts at 0 every second. "
            f"Set both: Time(nanoseconds={self.time}).to_msg()."
        )

    def messages(self, rig: Rig) -> list[Sent]:
        """Return the messages that were sent on the topic, or, if there are none, the messages on other topics."""
        sent = [each for each in rig.sent if isinstance(each.message, self.kind)]
        return [each for each in sent if each.topic.endswith(f"/{rig.body.name}/{self.topic}")] or sent

    def play(self, trial: Trial, seconds: float, ms: float = 10, begins: Sequence[int] = (0, 1), **options: Any) -> Any:
        """Simulate for `seconds`, with time steps of `ms` milliseconds, and return the rig.

        If the first message is not sent at step 0, repeat the simulation from step 1: then an answer that counts steps
        publishes at the same steps as the solution.
        """
        for begin in begins:
            rig = self.scene(trial, time_step=ms / 1000, **options)
            rig.start(begin)
            rig.advance(round(seconds * 1000 / ms))
            rig.stop()
            if rig.sent and rig.sent[0].step == 0:
                break
        return rig

    def sent(self, seconds: float, look: Look | None = None, **options: Any) -> Run:
        """Observe the content of the messages, or whatever `look` returns for them."""
        return lambda trial: self.held(self.play(trial, seconds, **options), look)

    def held(self, rig: Rig, look: Look | None = None) -> Any:
        """Describe the content of a rig's messages."""
        sent = self.messages(rig)
        return (look or self.content)(rig, sent) if sent else NOTHING

    def topics(self, namespace: str) -> Run:
        """Observe which topic the answer uses on a node in the given namespace."""

        def run(trial: Trial) -> str:
            node = self.scene(trial, namespace=namespace).node
            if not node.made:
                raise Failure("configure", Misuse("it creates no publisher", IN_CONFIGURE))
            return str(node.on(self.kind, f"Rover/{self.topic}"))

        return run

    def rate(self, ms: float) -> Run:
        """Observe how often a message is sent, with time steps of `ms` milliseconds."""
        return lambda trial: self.often(self.play(trial, 4.3 / self.hz, ms))

    def often(self, rig: Rig) -> Any:
        """Describe how often a message was sent; if the rate is wrong, include the number of steps between messages."""
        time_step, steps = rig.io.time_step, [each.step for each in self.messages(rig)]
        if len(steps) < 2:
            if rig.has_threads:
                raise Failure("control", Misuse("it starts its own thread", APART), rig.trial.noted.get("thread"))
            return f"{len(steps) or 'no'} message in {rig.io.time:.2g} s"
        if len({*steps}) < len(steps) and not rig.has_threads:
            raise Failure("control", Misuse("it publishes several messages in one step", TOGETHER))
        if self._is_regular(rig, steps):
            return f"{self.hz} times per simulated second"
        periods = [b - a for a, b in pairwise(steps)]
        rate, first = len(periods) / (sum(periods) * time_step or 1), steps[0] * time_step
        return {f"{rate:.3g} times per simulated second, starting at {first:.3g} s": periods}

    def _is_regular(self, rig: Rig, steps: list[int]) -> bool:
        """Return whether messages were sent at the right rate from the start, with intervals rounded to whole steps."""
        exact = 1 / (self.hz * rig.io.time_step)
        late = max(abs(step - steps[0] - i * exact) for i, step in enumerate(steps))
        is_even = {b - a for a, b in pairwise(steps)} == {round(exact)}
        return len(steps) > 3 and steps[0] - rig.begun <= exact + 2 and (late <= 1 or is_even)

    def stamps(self, trial: Trial) -> Any:
        """Compare each stamp with the time when its message was sent, using steps of 6 ms."""
        sent = self.messages(self.play(trial, 1.3, 6, (1,)))
        if not sent:
            cause = f"Your code probably counts from 0, but a run can start at any step. Publish when {self.when}."
            raise Failure("control", Misuse("it publishes nothing if the simulation starts at step 1", cause))
        return compared_stamps([(each.stamp_ns, each.step * 6_000_000) for each in sent])

    def restarted(self, trial: Trial, **options: Any) -> Any:
        """Restart the simulation ten periods after its first start, and observe the messages sent after the restart."""
        rig = self.scene(trial, time_step=0.01, **options)
        for begin in (0, 1000 // self.hz):
            rig.sent.clear()
            rig.start(begin)
            rig.advance(460 // self.hz)
            rig.stop()
        return [self.often(rig), self.held(rig)]

    def two(self, trial: Trial, **options: Any) -> Any:
        """Observe two robots whose simulations run alternately."""
        rover = self.scene(trial, time_step=0.01, **options)
        lift = self.scene(trial, time_step=0.02, **{"model": "crane", "name": "Lift", **options})
        for rig in (rover, lift):
            rig.start()
        for rig in (rover, lift) * 3:
            rig.advance(150 // self.hz)
        for rig in (rover, lift):
            rig.stop()
        return [look(rig) for rig in (rover, lift) for look in (self.often, self.held)]

    def on_ros(self, trial: Trial) -> str:
        """Observe whether messages arrive when the answer runs on rclpy's own node."""
        with ros_node() as node:
            rig, arrived = self.scene(trial, node=node, time_step=0.002), list[Any]()
            node.create_subscription(self.kind, f"/Rover/{self.topic}", arrived.append, qos_profile_sensor_data)
            rig.start()

            def arrives() -> bool:
                rig.advance(550 // self.hz)
                return bool(arrived)

            wait(arrives, "no message arrives")
            rig.stop()
            rig.do("unconfigure")
        return "its messages arrive"


def compared(pairs: Sequence[tuple[Any, Any]], right: str, word: Callable[[Any], str]) -> Any:
    """Return a description of the first wrong value together with all values, or `right` if no value is wrong.

    Args:
        pairs: the values that were sent, each paired with the expected value.
        right: the result if no value is wrong.
        word: describes a value.
    """
    odd = [f"{word(seen)} instead of {word(wanted)}" for seen, wanted in pairs if not same(seen, wanted)]
    return {odd[0]: [seen for seen, _ in pairs]} if odd else right


def compared_stamps(pairs: Sequence[tuple[int, int]]) -> Any:
    """Describe stamps [ns], each paired with the expected stamp [ns]."""
    if not pairs:
        return NOTHING
    if any(stamp > 10**18 for stamp, _ in pairs):
        return "the wall clock's time"
    return compared(pairs, "the simulated time", lambda ns: f"{ns / 1e9:g} s")


def describe(seen: Any) -> str:
    """Describe an observation; for a mapping, only its keys."""
    return "; ".join(map(describe, seen)) if isinstance(seen, list | dict) else str(seen)
