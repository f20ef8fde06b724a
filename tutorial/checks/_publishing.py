"""What all exercises have in common whose controllers publish at a rate: the topic, the rate, the stamps, the end."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from itertools import pairwise
from string import Template
from typing import Any

from rclpy.qos import qos_profile_sensor_data

from tutorial.checks._cases import Case, Cases, mistakes, same
from tutorial.checks._diagnose import Misuse
from tutorial.checks._node import ros_node, wait
from tutorial.checks._rig import THREAD, Rig, Sent
from tutorial.checks._watch import Failure, watch

__all__ = ["Publishing", "Told", "told_stamps"]

NOTHING = "no message"
SLASH = """
the topic begins with a slash, so the node's namespace is left out: it is f"{config.body.name}/$topic".
    f"{config.body.name}/$topic" => f"/{config.body.name}/$topic"
"""

FIRST = """
the body's name is written into the topic: take it from config.body.name.
    {config.body.name}/ => Tank/ => /Tank/

the body's name is left out of the topic: it is f"{config.body.name}/$topic".
    {config.body.name}/ =>

the publisher is made at every start, and only the last one destroyed: make it once, in configure.
    self.publisher = self.node.create_publisher($kind, => self.arguments = (
    self.io = io => self.io = io // self.publisher = self.node.create_publisher($kind, *self.arguments)

control publishes at every step: do so only when io.step % $steps == 0.
    self.io.step % self.$steps == 0 => True

the condition is turned round: publish when io.step % $steps == 0, and not otherwise.
    self.io.step % self.$steps == 0 => self.io.step % self.$steps

the rate is another, as that of the lesson; here it is $hz Hz.
    ($hz * io.time_step) => (2 * $hz * io.time_step) => ($hz / 2 * io.time_step)

the rate, $hz in a second, is taken for the number of steps: that is round(1 / ($hz * io.time_step)).
    round(1 / ($hz * io.time_step)) => $hz

the count is off by one: from one message to the next there are round(1 / ($hz * io.time_step)) steps.
    * io.time_step)) => * io.time_step)) + 1 => * io.time_step)) - 1

the number of steps is written down for 1 ms: compute it from io.time_step.
    * io.time_step => * 0.001

the number of steps is cut off, which is one too few where round(1 / ($hz * io.time_step)) is the nearest.
    round(1 / ( => int(1 / ( => int(1//(

a message waits until the whole time has passed, one step too many where round(1 / ($hz * io.time_step)) is the nearest.
    round(1 / => round(0.4999 + 1 /

the time has to be a multiple of $ms ms, which few steps meet if they are of 3 ms: count steps, io.step % $steps.
    self.io.step % self.$steps == 0 => self.io.time_ns % ($ms * 1_000_000) == 0 => self.io.time % ($ms / 1000) == 0
"""

LAST = """
the stamp is left out, or set only once: message.header.stamp = Time(nanoseconds=$time).to_msg(), for every message.
    message.header.stamp = Time(nanoseconds=$time) => stamp = Time(nanoseconds=$time)
    => message.header.stamp = Time(nanoseconds=self.__dict__.setdefault("kept_ns", $time))

that is the wall clock's time: take the simulation's, self.io.time_ns.
    Time(nanoseconds=$time) => self.node.get_clock().now()

only sec or only nanosec is set, or they are exchanged: Time(nanoseconds=$time).to_msg() sets both.
    Time(nanoseconds=$time) => Time(nanoseconds=$time//10**9 * 10**9) => Time(nanoseconds=$time % 10**9)
    => Time(nanoseconds=$time % 10**9 * 10**9 + $time//10**9)

the unit is wrong: the stamp is made of nanoseconds, Time(nanoseconds=$time).to_msg().
    Time(nanoseconds=$time) => Time(nanoseconds=$time//1_000) => Time(nanoseconds=$time//1_000_000)
    => Time(nanoseconds=$time//10**9)

the messages or steps are counted for the stamp, as if each took as long: take self.io.time_ns.
    Time(nanoseconds=$time) => Time(nanoseconds=self.io.step * 1_000_000)
    => Time(nanoseconds=self.io.step//self.$steps * $ms * 1_000_000)

unconfigure is missing, or does not call self.node.destroy_publisher(self.publisher): a flag, None or
self.publisher.destroy() do not tell the node.
    self.node.destroy_publisher(self.publisher) => pass => self.publisher.destroy()

config.node belongs to the whole program: unconfigure destroys only the publisher,
self.node.destroy_publisher(self.publisher).
    self.node.destroy_publisher(self.publisher) => self.node.destroy_node()

configure makes two, and keeps only one, as when super().configure(config) has made one already: make only the publisher
that was asked for.
    self.node = config.node => self.node = config.node // self.node.create_publisher($kind, "another", 1)
"""


@dataclass(frozen=True, eq=False)
class Told:
    """What is observed, in words: as much of it as fits a line. Two are equal if all that was observed is."""

    text: str
    data: Any

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Told) and same(self.data, other.data)

    __hash__ = None  # type: ignore[assignment]

    def __str__(self) -> str:
        return self.text


Look = Callable[[Any, list[Sent]], Any]


@dataclass(frozen=True)
class Publishing:
    """An exercise whose controller publishes at a rate.

    Attributes:
        kind: the class of the messages.
        topic: without the body's name.
        hz: how often they are to be sent in a simulated second.
        scene: makes a rig, given an answer and options of `Rig`.
        content: puts into words what messages hold, given the rig and what was sent.
        steps: the solution's attribute that has the steps from message to message.
        time: what the solution stamps a message with [ns].
        namespaces: whether the topic has to be in the node's namespace.
    """

    kind: type
    topic: str
    hz: int
    scene: Callable[..., Any]
    content: Look
    steps: str = "steps_per_message"
    time: str = "self.io.time_ns"
    namespaces: bool = True

    def cases(self, solution: type, own: Mapping[str, Case], table: str, otherwise: Mapping[str, str]) -> Cases:
        """Put together what is tried and known of all such exercises, and of this one."""
        steps = (
            f"Most likely the period is another: from one message to the next there are round(1 / ({self.hz} * "
            f"io.time_step)) steps, and io.step % {self.steps} == 0 says when."
        )
        topic, stamp = f'f"{{config.body.name}}/{self.topic}"', f"Time(nanoseconds={self.time}).to_msg()"
        restart = "Most likely something of the run before is kept: initialize is called at every start."
        expected = {
            "on the body Rover": f"Compare with config.node.create_publisher({self.kind.__name__}, {topic}, 1).",
            **dict.fromkeys((f"with steps of {ms} ms" for ms in (1, 2, 3, 6)), steps),
            "the stamp": f"Compare with message.header.stamp = {stamp}, at every message.",
            "two robots in turns": "Most likely what is kept belongs to the class: make it in initialize.",
            "after a restart": restart,
            "after unconfigure": "Compare with self.node.destroy_publisher(self.publisher), in unconfigure.",
        }
        tried = {
            "on the body Rover": self.topics("/"),
            **({"in the namespace /lab": self.topics("/lab")} if self.namespaces else {}),
            "with steps of 1 ms": self.rate(1),
            **own,
            "the stamp": self.stamps,
            **{f"with steps of {ms} ms": self.rate(ms) for ms in (2, 3, 6)},
            "two robots in turns": self.two,
            "after a restart": self.restarted,
            "after unconfigure": lambda answer: self.play(answer, 0.1).leave(),
        }
        words = {"kind": self.kind.__name__, "topic": self.topic, "hz": self.hz, "ms": 1000 // self.hz}
        text = Template(SLASH * self.namespaces + FIRST + table + LAST).substitute(
            words, steps=self.steps, time=self.time
        )
        causes = {**expected, **otherwise}
        return Cases(solution, {**tried, **own}, mistakes(text), say, causes, on_ros=self.on_ros)

    def messages(self, rig: Rig) -> list[Sent]:
        """Return what was sent on the topic; on another where nothing was."""
        sent = [each for each in rig.sent if isinstance(each.message, self.kind)]
        return [each for each in sent if each.topic.endswith(f"/{rig.body.name}/{self.topic}")] or sent

    def play(
        self, answer: type, seconds: float, ms: float = 10, begins: tuple[int, ...] = (0, 1), **options: Any
    ) -> Any:
        """Simulate with steps of so many milliseconds, and return the rig.

        If the first message comes later than at step 0, the simulation begins anew with step 1: an answer that counts
        then sends when the solution does.
        """
        for begin in begins:
            rig = self.scene(answer, time_step=ms / 1000, **options)
            rig.start(begin)
            rig.advance(round(seconds * 1000 / ms))
            rig.stop()
            if rig.sent and rig.sent[0].step == 0:
                break
        return rig

    def sent(self, seconds: float, look: Look | None = None, **options: Any) -> Case:
        """Observe what messages hold, or something else of them."""
        return lambda answer: self.held(self.play(answer, seconds, **options), look)

    def held(self, rig: Rig, look: Look | None = None) -> Any:
        """Put into words what the messages of a rig hold."""
        sent = self.messages(rig)
        return (look or self.content)(rig, sent) if sent else NOTHING

    def topics(self, namespace: str) -> Case:
        """Observe the topic on a node with a namespace."""

        def observe(answer: type) -> str:
            made = self.scene(answer, namespace=namespace).node.publishers
            found = [f"it publishes {each.kind.__name__} on {each.topic}" for each in made]
            wanted = f"it publishes {self.kind.__name__} on {namespace.rstrip('/')}/Rover/{self.topic}"
            return wanted if wanted in found else found[0] if found else "configure makes no publisher"

        return observe

    def rate(self, ms: float) -> Case:
        """Observe how often a message is sent, with steps of so many milliseconds."""
        return lambda answer: self.often(self.play(answer, 4.3 / self.hz, ms))

    def often(self, rig: Rig) -> Any:
        """Put into words how often a message was sent; beside it stands the number of steps from each to the next."""
        time_step, steps = rig.io.time_step, [each.step for each in self.messages(rig)]
        if len(steps) < 2 and rig.has_threads:
            misuse = Misuse("messages come from a thread of its own", THREAD)
            raise Failure("control", misuse, watch.noted.get("thread"))
        if len(steps) < 2:
            return f"{len(steps) or 'no'} message in {rig.io.time:.2g} s"
        exact, periods = 1 / (self.hz * time_step), [b - a for a, b in pairwise(steps)]
        late = max(abs(step - steps[0] - i * exact) for i, step in enumerate(steps))
        is_near = len(steps) > 3 and steps[0] <= exact + 1 and all(abs(each - exact) <= 1 for each in periods)
        if is_near and (late <= 1 or set(periods) == {round(exact)}):
            return f"{self.hz} times per simulated second"
        return Told(f"{len(periods) / (sum(periods) * time_step or 1):.3g} times per simulated second", periods)

    def stamps(self, answer: type) -> Any:
        """Observe the stamps, with steps of 6 ms, beside the times of sending."""
        sent = self.messages(self.play(answer, 1.3, 6, (1,)))
        return told_stamps([(each.stamp_ns, each.step * 6_000_000) for each in sent])

    def restarted(self, answer: type, **options: Any) -> Any:
        """Observe what is sent after a restart of the simulation."""
        rig = self.scene(answer, time_step=0.01, **options)
        for _ in range(2):
            rig.sent.clear()
            rig.start()
            rig.advance(260 // self.hz)
            rig.stop()
        return self.held(rig)

    def two(self, answer: type, **options: Any) -> Any:
        """Observe two robots in turns."""
        rover = self.scene(answer, time_step=0.01, **options)
        lift = self.scene(answer, time_step=0.02, **{"model": "crane", "name": "Lift", **options})
        rover.start()
        lift.start()
        for _ in range(3):
            rover.advance(160 // self.hz)
            lift.advance(100 // self.hz)
        rover.stop()
        lift.stop()
        return [look(rig) for rig in (rover, lift) for look in (self.often, self.held)]

    def on_ros(self, answer: type) -> str:
        """Observe whether messages arrive, with rclpy's own node."""
        with ros_node() as node:
            rig, arrived = self.scene(answer, node=node, time_step=0.002), list[Any]()
            node.create_subscription(self.kind, f"/Rover/{self.topic}", arrived.append, qos_profile_sensor_data)
            rig.start()

            def arrives() -> bool:
                rig.advance(550 // self.hz)
                return bool(arrived)

            wait(arrives, "no message arrives")
            rig.stop()
            rig.learner.unconfigure()
        return "its messages arrive"


def told_stamps(pairs: list[tuple[int, int]]) -> Any:
    """Put into words stamps [ns], each beside what it should be [ns]."""
    odd = [(stamp, time) for stamp, time in pairs if abs(stamp - time) > 2]  # a float may lose so much
    if not odd:
        return "the simulated time" if pairs else NOTHING
    stamp, time = odd[0]
    if stamp > 10**18:
        return "the wall clock's time"
    return Told(f"{stamp / 1e9:g} s at {time / 1e9:g} s", [stamp for stamp, _ in pairs])


def say(seen: Any) -> str:
    """Put what is observed into words."""
    return "; ".join(map(say, seen)) if isinstance(seen, list) else str(seen)
