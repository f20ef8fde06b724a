"""What all exercises have in common whose controllers publish at a rate: the topic, the rate, the stamps, the end."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from string import Template
from typing import Any

from tutorial.checks._cases import Case, Mistake, mistakes, same
from tutorial.checks._diagnose import Misuse
from tutorial.checks._node import WatchedPublisher
from tutorial.checks._rig import Rig, Sent
from tutorial.checks._watch import Failure, watch
from tutorial.checks._world import World

__all__ = ["NOTHING", "Publishing", "Told", "say", "stamps_of"]

SECOND = 1_000_000_000  # [ns]
NOTHING = "no message"
WALL_CLOCK = 1_000_000_000 * SECOND  # [ns]; no simulated time is so late, nor an exchanged stamp

THREAD = (
    "Most likely a thread of its own publishes: it goes by the wall clock, and the simulated body belongs to the "
    "simulation's thread. Publish in control, and count steps."
)

TOPIC = """
the body's name is written into the topic: take it from config.body.name.
    {config.body.name}/$topic => Tank/$topic

the body's name is written into the topic: take it from config.body.name.
    f"{config.body.name}/$topic" => "/Tank/$topic"

the body's name is left out of the topic: it is f"{config.body.name}/$topic".
    {config.body.name}/$topic => $topic

the topic begins with a slash, so the node's namespace is left out: it is f"{config.body.name}/$topic".
    f"{config.body.name}/$topic" => f"/{config.body.name}/$topic"

the publisher is made at every start, and only the last one destroyed: make it once, in configure.
    self.publisher = self.node.create_publisher($kind, => self.arguments = (
    self.io = io => self.io = io // self.publisher = self.node.create_publisher($kind, *self.arguments)
"""

RATE = """
control publishes at every step: do so only when io.step % $steps == 0.
    if self.io.step % self.$steps == 0: => if True:

the condition is turned round: publish when io.step % $steps == 0, and not otherwise.
    if self.io.step % self.$steps == 0: => if self.io.step % self.$steps:

that is the rate of $lesson; here it is $hz Hz.
    round(1 / ($hz * io.time_step)) => round(1 / ($lesson_hz * io.time_step))

the rate, $hz in a second, is taken for the number of steps: that is round(1 / ($hz * io.time_step)).
    round(1 / ($hz * io.time_step)) => $hz

the count is off by one: from one message to the next there are round(1 / ($hz * io.time_step)) steps.
    round(1 / ($hz * io.time_step)) => round(1 / ($hz * io.time_step)) + 1

the count is off by one: from one message to the next there are round(1 / ($hz * io.time_step)) steps.
    round(1 / ($hz * io.time_step)) => round(1 / ($hz * io.time_step)) - 1

the number of steps is written down for 1 ms: compute it from io.time_step.
    round(1 / ($hz * io.time_step)) => $typed

the number of steps is cut off, which is one too few where round(1 / ($hz * io.time_step)) is the nearest.
    round(1 / ($hz * io.time_step)) => int(1 / ($hz * io.time_step))

a message waits until the whole time has passed, one step too many where round(1 / ($hz * io.time_step)) is the nearest.
    round(1 / ($hz * io.time_step)) => -int(-1 / ($hz * io.time_step)//1)

the time has to be a multiple of $period_ms ms, which few steps meet if they are of 3 ms: count steps, io.step % $steps.
    self.io.step % self.$steps == 0 => self.io.time_ns % ($period_ms * 1_000_000) == 0
"""

STAMPS = """
the stamp is left out: message.header.stamp = Time(nanoseconds=$time).to_msg().
    message.header.stamp = Time(nanoseconds=$time).to_msg() => pass

that is the wall clock's time: take the simulation's, self.io.time_ns.
    Time(nanoseconds=$time) => self.node.get_clock().now()

only whole seconds are set, and nanosec stays 0: Time(nanoseconds=$time).to_msg() sets both.
    Time(nanoseconds=$time) => Time(nanoseconds=$time - $time % 1_000_000_000)

only nanosec is set, and sec stays 0: Time(nanoseconds=$time).to_msg() sets both.
    Time(nanoseconds=$time) => Time(nanoseconds=$time % 1_000_000_000)

sec and nanosec are exchanged: Time(nanoseconds=$time).to_msg() sets both.
    Time(nanoseconds=$time) => Time(nanoseconds=$time % 1_000_000_000 * 1_000_000_000 + int($time / 1e9))

the unit is wrong, microseconds for nanoseconds: message.header.stamp = Time(nanoseconds=$time).to_msg().
    Time(nanoseconds=$time) => Time(nanoseconds=int($time / 1e3))

the unit is wrong, milliseconds for nanoseconds: message.header.stamp = Time(nanoseconds=$time).to_msg().
    Time(nanoseconds=$time) => Time(nanoseconds=int($time / 1e6))

the unit is wrong, seconds for nanoseconds: message.header.stamp = Time(nanoseconds=$time).to_msg().
    Time(nanoseconds=$time) => Time(nanoseconds=int($time / 1e9))

the stamp is set once and kept: take the time anew for every message.
    Time(nanoseconds=$time) => Time(nanoseconds=self.__dict__.setdefault("kept_ns", $time))

the messages are counted for the stamp: from one to the next it is not always $period_ms ms, so take self.io.time_ns.
    self.io = io => self.io = io // self.numbers = iter(range(9_999))
    self.io.time_ns => $period_ms * 1_000_000 * next(self.numbers)
"""

LEAVING = """
unconfigure is missing, or does not call self.node.destroy_publisher(self.publisher): a flag or None does not destroy
the publisher.
    self.node.destroy_publisher(self.publisher) => pass

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

    def __hash__(self) -> int:
        return 0

    def __str__(self) -> str:
        return self.text


@dataclass(frozen=True)
class Publishing:
    """An exercise whose controller publishes at a rate.

    Attributes:
        kind: the class of the messages.
        topic: without the body's name.
        hz: how often they are to be sent in a simulated second.
        scene: makes a rig, given an answer and options of `Rig`.
        content: puts into words what the messages of a rig hold: a text, or `Told`.
        words: what the solution and the lesson call things: ``steps`` is the attribute that has the steps from message
            to message, ``time`` the stamp [ns]; ``lesson`` the controller of the lesson and ``lesson_hz`` its rate.
    """

    kind: type
    topic: str
    hz: int
    scene: Callable[..., Any]
    content: Callable[[Any], Any]
    words: Mapping[str, object]

    def mistakes(self, own: str) -> tuple[Mistake, ...]:
        """Read the mistakes of the exercise, those of all such exercises about them."""
        known = {"kind": self.kind.__name__, "topic": self.topic, "hz": self.hz, "typed": 1000 // self.hz}
        table = Template(TOPIC + RATE + own + STAMPS + LEAVING)
        return mistakes(table.substitute(known, period_ms=1000 // self.hz, **self.words))

    def messages(self, rig: Rig) -> list[Sent]:
        """Return what was sent on the topic; on another where nothing was."""
        right = [each for each in rig.sent if each.topic.endswith(f"/{rig.body.name}/{self.topic}")]
        return right or [each for each in rig.sent if each.message is not None]

    def play(self, answer: type, seconds: float, ms: int = 10, begins: Sequence[int] = (0, 1), **options: Any) -> Any:
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

    def topics(self, namespace: str) -> Case:
        """Observe the topic on a node with a namespace."""

        def observe(answer: type) -> str:
            made = self.scene(answer, namespace=namespace).node.publishers
            found = [f"it publishes {each.kind.__name__} on {each.topic}" for each in made]
            wanted = f"it publishes {self.kind.__name__} on {namespace.rstrip('/')}/Rover/{self.topic}"
            return wanted if wanted in found else found[0] if found else "configure makes no publisher"

        return observe

    def rate(self, ms: int) -> Case:
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
        """Observe the stamps, with steps of 6 ms."""
        rig = self.play(answer, 1.3, 6, begins=(1,))
        return stamps_of((each.stamp_ns, each.step * 6_000_000) for each in self.messages(rig))

    def restarted(self, answer: type) -> Any:
        """Observe what is sent after a restart of the simulation."""
        rig = self.scene(answer, time_step=0.01)
        for _ in range(2):
            rig.sent.clear()
            rig.start()
            rig.advance(260 // self.hz)
            rig.stop()
        return self.content(rig)

    def two(self, answer: type) -> Any:
        """Observe two robots in turns."""
        rover = self.scene(answer, time_step=0.01)
        lift = self.scene(answer, time_step=0.02, model="crane", name="Lift")
        rover.start()
        lift.start()
        for _ in range(3):
            rover.advance(160 // self.hz)
            lift.advance(100 // self.hz)
        rover.stop()
        lift.stop()
        return [look(rig) for rig in (rover, lift) for look in (self.often, self.content)]

    def left(self, answer: type) -> str:
        """Observe what is left after `unconfigure`."""
        rig = self.play(answer, 0.1)
        return str(rig.leave())

    def on_ros(self, answer: type, prepare: Callable[[World], None] = lambda _: None) -> str:
        """Observe whether messages are sent, and the publisher is gone in the end, with rclpy's own node."""
        with World(answer, name="Rover", time_step=0.002) as world:
            prepare(world)
            world.advance(550 // self.hz)
            world.leave()
            made = world.ros.node.watched(WatchedPublisher)
            sent, left = [each for one in made for each in one.sent], [one for one in made if not one.destroyed]
            return f"{'messages are' if sent else 'nothing is'} sent, and {len(left) or 'nothing'} left in the end"


def stamps_of(pairs: Iterable[tuple[int, int]]) -> Any:
    """Observe stamps [ns], each beside what it should be [ns]."""
    both = list(pairs)
    odd = [(stamp, time) for stamp, time in both if abs(stamp - time) > 2]  # a float may lose so much
    if not odd:
        return "the simulated time" if both else NOTHING
    if min(odd)[0] > WALL_CLOCK:
        return "the wall clock's time"
    stamp, time = odd[0]
    return Told(f"{stamp / 1e9:g} s at {time / 1e9:g} s", [stamp for stamp, _ in both])


def say(seen: Any) -> str:
    """Put what is observed into words."""
    if isinstance(seen, list):
        return "; ".join(map(say, seen))
    return str(seen)
