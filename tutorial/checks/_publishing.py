"""What all exercises have in common whose controllers publish at a rate: the topic, the rate, the stamps, the end."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from string import Template
from typing import Any

from rclpy.qos import qos_profile_sensor_data

from tutorial.checks._cases import Case, Cases, same
from tutorial.checks._rig import APART, Rig, Sent, ros_node, wait
from tutorial.checks._watch import Failure, Misuse, watch

NOTHING = "no message"
SHARED = """
it asks the displayed copy, config.body, on which nothing moves: what is simulated is io.body.
    self.node = config.node => self.node, self.shown = config.node, config.body
    self.io = io => self.io, io.body = io, self.shown

control publishes at every step: it does so only if io.step % round(1 / ($hz * io.time_step)) == 0.
    self.io.step % => 0 * self.io.step %

# on the body Rover
Compare with config.node.create_publisher($kind, f"{config.body.name}/$topic", 1), in configure, no slash in front.

# with steps of
Most likely the number of steps is written down for another step, cut off or not rounded, or counted in a time: publish
when io.step % round(1 / ($hz * io.time_step)) == 0.

# with steps of 1 ms
Most likely the condition is another: one message comes when io.step % round(1 / ($hz * io.time_step)) == 0.

# the stamp
Most likely it is left out, counted, or another clock's, or sec and nanosec are exchanged, or one is missing: set both,
for each message, with Time(nanoseconds=$time).to_msg().

# two robots in turns
Most likely what is kept belongs to the class: make it in initialize.

# after a restart
Most likely something of the run before is kept, or steps or times are counted from 0: after stop, time goes on.

#"""
TOGETHER = "Most likely each joint has a message of its own, or publish is called twice: send one message with all."

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
        time: what the solution stamps a message with [ns].
        namespaces: whether the topic has to be in the node's namespace.
    """

    kind: type
    topic: str
    hz: int
    scene: Callable[..., Any]
    content: Look
    time: str = "self.io.time_ns"
    namespaces: bool = True

    def cases(self, solution: type, own: Mapping[str, Case], table: str) -> Cases:
        """Put together what is tried and known of all such exercises, and of this one."""
        words = {**vars(self), "kind": self.kind.__name__}
        tried = {
            "on the body Rover": self.topics("/"),
            **({"on the body Rover, in the namespace /lab": self.topics("/lab")} if self.namespaces else {}),
            **{f"with steps of {ms} ms": self.rate(ms) for ms in (1, 2, 3, 6)},
            **own,
            "the stamp": self.stamps,
            "two robots in turns": self.two,
            "after a restart": self.restarted,
            "after unconfigure": lambda answer: self.play(answer, 0.1).leave(),
        }
        return Cases(solution, {**tried, **own}, Template(SHARED + table).substitute(words), say, on_ros=self.on_ros)

    def messages(self, rig: Rig) -> list[Sent]:
        """Return what was sent on the topic; on another where nothing was."""
        sent = [each for each in rig.sent if isinstance(each.message, self.kind)]
        return [each for each in sent if each.topic.endswith(f"/{rig.body.name}/{self.topic}")] or sent

    def play(self, answer: type, seconds: float, ms: float = 10, begins: Sequence[int] = (0, 1), **options: Any) -> Any:
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
        return lambda answer: self.scene(answer, namespace=namespace).node.on(self.kind, f"Rover/{self.topic}")

    def rate(self, ms: float) -> Case:
        """Observe how often a message is sent, with steps of so many milliseconds."""
        return lambda answer: self.often(self.play(answer, 4.3 / self.hz, ms))

    def often(self, rig: Rig) -> Any:
        """Put into words how often a message was sent; with it comes the number of steps from each to the next."""
        time_step, steps = rig.io.time_step, [each.step for each in self.messages(rig)]
        if len(steps) < 2:
            if rig.has_threads:
                raise Failure("control", Misuse("it starts a thread of its own", APART), watch.noted.get("thread"))
            return f"{len(steps) or 'no'} message in {rig.io.time:.2g} s"
        if len({*steps}) < len(steps) and not rig.has_threads:
            raise Failure("control", Misuse("it publishes several messages in one step", TOGETHER))
        exact, periods = 1 / (self.hz * time_step), [b - a for a, b in pairwise(steps)]
        late = max(abs(step - steps[0] - i * exact) for i, step in enumerate(steps))
        if len(steps) > 3 and steps[0] - rig.begun <= exact + 2 and (late <= 1 or set(periods) == {round(exact)}):
            return f"{self.hz} times per simulated second"
        rate, first = len(periods) / (sum(periods) * time_step or 1), steps[0] * time_step
        return {f"{rate:.3g} times per simulated second, from {first:.3g} s on": periods}

    def stamps(self, answer: type) -> Any:
        """Observe the stamps, with steps of 6 ms, beside the times of sending."""
        sent = self.messages(self.play(answer, 1.3, 6, (1,)))
        return compared_stamps([(each.stamp_ns, each.step * 6_000_000) for each in sent])

    def restarted(self, answer: type, **options: Any) -> Any:
        """Observe what is sent after a restart of the simulation, ten periods later."""
        rig = self.scene(answer, time_step=0.01, **options)
        for begin in (0, 1000 // self.hz):
            rig.sent.clear()
            rig.start(begin)
            rig.advance(460 // self.hz)
            rig.stop()
        return [self.often(rig), self.held(rig)]

    def two(self, answer: type, **options: Any) -> Any:
        """Observe two robots in turns."""
        rover = self.scene(answer, time_step=0.01, **options)
        lift = self.scene(answer, time_step=0.02, **{"model": "crane", "name": "Lift", **options})
        for rig in (rover, lift):
            rig.start()
        for rig in (rover, lift) * 3:
            rig.advance(150 // self.hz)
        for rig in (rover, lift):
            rig.stop()
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
            rig.do("unconfigure")
        return "its messages arrive"


def compared(pairs: Sequence[tuple[Any, Any]], right: str, word: Callable[[Any], str]) -> Any:
    """Put into words the first of what was sent that differs from what stands beside it; with it comes all of it.

    Args:
        pairs: what was sent, each with what is wanted.
        right: what to say if nothing differs.
        word: puts one of them into words.
    """
    odd = [f"{word(seen)} in place of {word(wanted)}" for seen, wanted in pairs if not same(seen, wanted)]
    return {odd[0]: [seen for seen, _ in pairs]} if odd else right


def compared_stamps(pairs: Sequence[tuple[int, int]]) -> Any:
    """Put into words stamps [ns], each with what it should be [ns]."""
    if not pairs:
        return NOTHING
    if any(stamp > 10**18 for stamp, _ in pairs):
        return "the wall clock's time"
    return compared(pairs, "the simulated time", lambda ns: f"{ns / 1e9:g} s")


def say(seen: Any) -> str:
    """Put what is observed into words; of a mapping, its keys."""
    return "; ".join(map(say, seen)) if isinstance(seen, list | dict) else str(seen)
