"""The exercise `thrift`: publish only the joints that have moved.

Write the controller `ThriftyPublisher`. It publishes a `JointState` on its body's topic `joint_state` (for the tank,
`Tank/joint_state`), but only if joints have moved:

- 50 times per simulated second, it finds the joints whose positions differ by more than 0.001 rad (or m) from those
  that it last sent. Do this every `round(1 / (50 * io.time_step))` steps, or at the steps nearest to the multiples
  of 1/50 s.
- The message contains only these joints, with their positions. If there are no such joints, no message is sent.
- The first message names all joints, and so does the first one after a restart of the simulation. On a restart,
  `initialize` is called again, but `io.step` and `io.time_ns` don't restart at 0.
- The stamp is the simulated time of publication. Velocity and effort stay empty.
- In `unconfigure`, have the node destroy the publisher.

Hint 1: What do you have to compare each position with? Use the position that you last sent for the same joint, however
long ago, and not the joint's position 20 ms ago. Compare each joint separately.

Hint 2: Keep a dict that maps each joint's name to the position that you last sent for it. At first, the dict is empty,
so you send all joints. Whenever a message is due, collect the joints that have moved. If any joints have
moved, send their positions, and store these positions in the dict.

Hint 3: news = {name: q for name, q in positions.items() if name not in self.sent or abs(q - self.sent[name]) > 0.001}.
If news is not empty: message.name = list(news), message.position = list(news.values()), publish, then
self.sent.update(news). In unconfigure: self.node.destroy_publisher(self.publisher).

Notice that a receiver of these messages has to match joints by name. The viewer of step 3 does, so it needs no changes.
"""

from collections.abc import Sequence
from typing import Any

from rclpy.time import Time
from sensor_msgs.msg import JointState

from tutorial.checks.engine.cases import Case, Mistake, Run, replace
from tutorial.checks.engine.publishing import ALL_JOINTS, SHARED_BY_ROBOTS, Publishing
from tutorial.checks.engine.rig import Rig, Sent
from tutorial.checks.engine.trial import Trial
from tutorial.checks.exercise import Exercise
from tutorial.controller import ControllerConfig, ControllerIO, SimpleController


class ThriftyPublisher(SimpleController):
    """Publish the positions of the joints that have moved."""

    def configure(self, config: ControllerConfig) -> None:
        """Create the publisher on a topic named after the body."""
        self.node = config.node
        self.publisher = self.node.create_publisher(JointState, f"{config.body.name}/joint_state", 10)

    def initialize(self, io: ControllerIO) -> None:
        """Forget the sent positions."""
        self.io = io
        self.sent: dict[str, float] = {}
        self.steps_per_look = round(1 / (50 * io.time_step))

    def control(self) -> None:
        """Publish the joints that have moved, if a message is due."""
        if self.io.step % self.steps_per_look == 0:
            positions = {joint.name: joint.position for joint in self.io.body.joints}
            news = {n: q for n, q in positions.items() if n not in self.sent or abs(q - self.sent[n]) > 0.001}
            if news:
                message = JointState(name=list(news), position=list(news.values()))
                message.header.stamp = Time(nanoseconds=self.io.time_ns).to_msg()
                self.publisher.publish(message)
                self.sent.update(news)

    def unconfigure(self) -> None:
        """Destroy the publisher."""
        self.node.destroy_publisher(self.publisher)


MISTAKES = [
    Mistake("your first message doesn't name all joints. Before the first message, nothing has been sent: "
            "start with an empty self.sent, so that all joints are new.",
            replace(": dict[str, float] = {}", "= {j.name: j.position for j in io.body.joints}",
                    "= dict.fromkeys(io.body.joint_names, 0)")),
    Mistake("your code sends all joints in every message. "
            "Name only the joints that have moved, and store the sent positions.",
            replace("if n not in self.sent or abs(q - self.sent[n]) > 0.001}", "}")),
    Mistake("your code treats a stored position of 0 as missing, as in `if not last`. "
            "Check whether the name is in self.sent.",
            replace("n not in self.sent or", "not self.sent.get(n) or")),
    Mistake("your code sends all joints as soon as one has moved. Name only the joints that have moved.",
            replace("message =", "news = positions\nmessage =")),
    Mistake("your code names only one of the joints that have moved, perhaps because of a break statement. "
            "Name all of them.",
            replace("if news:", "news = dict([*news.items()][:1])\nif news:",
                    "news = dict([*news.items()][-1:])\nif news:",
                    "news = dict([*news.items()][: 1 if self.sent else None])\nif news:")),
    Mistake("your code sends a message even if no joint has moved. In that case, send nothing.",
            replace("if news:", "if True:")),
    Mistake("your code compares the positions with those from 1/50 s ago, or from the time of the last "
            "message. Compare each position with the last one sent for the same joint.",
            replace("if news:", "self.sent = positions\nif news:",
                    "self.sent = positions if news else self.sent\nif news:")),
    Mistake("your code tests how fast a joint moves. Test how far it is "
            "from the position last sent: abs(a - b) > 0.001.",
            replace("abs(q - self.sent[n]) > 0.001", "abs(self.io.body.joint(n).velocity) > 0.001",
                    "abs(self.io.body.joint(n).velocity) > 0.05")),
    Mistake("your code compares a position with itself: it updates self.sent too early, or stores the joint instead of "
            "its position. Compare first.",
            replace("n not in self.sent or abs(q - self.sent[n]) > 0.001", "n not in self.sent")),
    Mistake("your code compares rounded positions. Compare the exact difference: abs(a - b) > 0.001.",
            replace("abs(q - self.sent[n]) > 0.001", "round(q, 3) != round(self.sent[n], 3)",
                    "int(q * 1000) != int(self.sent[n] * 1000)")),
    Mistake("your code omits abs, or applies it to each position instead of the difference. "
            "A joint can move in either direction: abs(a - b) > 0.001.",
            replace("abs(q - self.sent[n])", "(q - self.sent[n])", "(self.sent[n] - q)",
                    "abs(abs(q) - abs(self.sent[n]))")),
    Mistake("your code doesn't store the sent positions, or it replaces self.sent and loses the other positions. "
            "Write self.sent.update(news).",
            replace("self.sent.update(news)", "self.sent = news | self.sent", "self.sent = news")),
    Mistake("your threshold is too large. Send a joint's position as soon as it "
            "differs by more than 0.001 rad (or m) from the last one sent.",
            replace("> 0.001", "> 0.1", "> 0.01")),
    Mistake(ALL_JOINTS, replace("self.io.body.joints", "self.io.body.joints[:2]",
                                'map(self.io.body.joint, ("TURRET_Y", "TURRET_P"))')),
]  # fmt: skip
MEANING = ("Compare your code with this: when io.step % steps_per_look == 0, compare each joint's position with its "
           "last sent position. Each message has new lists, which contain "
           "only the names of the joints that have moved, and their positions.")  # fmt: skip

LOOK = 0.02  # [s]
Move = tuple[float, float, float]  # the moves of the crane's joints [m, rad, rad]
REST: Move = (0.0, 0.0, 0.0)
SLEW: Move = (0.0, 0.05, 0.0)


def moving(trial: Trial, moves: Sequence[Move] = (), **options: Any) -> Rig:
    """Make a rig whose joints jump once per period, from the second period on, or in every step if `moves` is empty."""

    def move() -> None:
        look, rest = divmod(rig.io.step, round(LOOK / rig.io.time_step))
        at_once = moves[look - 1] if rest == 5 and 0 < look <= len(moves) else REST
        for joint, distance in zip(rig.body.joints, at_once if moves else (0.01, 0.01, 0.01)):
            joint.position += distance

    rig = Rig(trial, move, **options)
    rig.body.data.qvel[:] = 0.0 if moves else 10.0
    rig.displayed.set_joint_positions({name: 0.3 + 0.1 * i for i, name in enumerate(rig.body.joint_names)})
    return rig


def looks(rig: Rig, sent: list[Sent]) -> dict[str, list[str]]:
    """Observe which joints the messages name in each period of 1/50 s; the first two periods are treated as one."""
    steps = round(LOOK / rig.io.time_step)
    found = [f"{named(each.message)} in period {max((each.step - rig.begun + 1) // steps, 1)}" for each in sent]
    return {", ".join(found[:6]): found}


def named(message: Any) -> str:
    """Describe which joints a message names, and what is wrong with its lists."""
    count, more = len(message.position), len(message.velocity) + len(message.effort)
    odd = f" and {count} positions" * (count != len(message.name)) + " and velocity or effort" * (more > 0)
    return (" and ".join(sorted(message.name)) or "no joint") + odd


def positions(_rig: Rig, sent: list[Sent]) -> dict[str, list[Any]]:
    """Observe the positions."""
    seen = [sorted(zip(each.message.name, each.message.position)) for each in sent]
    return {", ".join(f"{name} {position:.6g}" for name, position in seen[-1]): seen}


PUBLISHING = Publishing(JointState, "joint_state", 50, moving, looks, namespaces=False)


def moved(*moves: Move, look: Any = None, **options: Any) -> Run:
    """Observe the messages that are sent while a robot (by default, the crane) moves."""
    return PUBLISHING.sent(LOOK * (len(moves) + 2), look, ms=1, moves=moves, **{"model": "crane", **options})


CASES = [
    Case("with steps of 0.5 ms", PUBLISHING.rate(0.5), PUBLISHING.wrong_steps),
    Case("nothing moves", moved(*[REST] * 4)),
    Case("SLEW moves far, then a little, then rests", moved((0.0, 2.0, 0.0), (0.0, 0.0015, 0.0), REST)),
    Case("no joint moves by more than 0.001", moved((0.001, 0.0006, 0.0006))),
    Case("LUFF moves, then trembles", moved(*[(0.0, 0.0, by) for by in (0.2996, 0.0007, -0.0009, 0.0007)])),
    Case("LUFF creeps", moved(*[(0.0, 0.0, 0.00035)] * 8)),
    Case("BRIDGE and SLEW move", moved((0.006, 0.05, 0.0))),
    Case("LUFF keeps creeping while SLEW moves", moved(*[(0.0, 0.05, 0.00035)] * 9)),
    Case("BRIDGE moves back", moved((0.02, 0.0, 0.0), (-0.04, 0.0, 0.0), REST, REST)),
    Case("each position", moved((0.1, 0.3004, -0.2004), SLEW, (0.0, 0.0, 0.05), look=positions),
         "Your code probably sends how far the joint has moved, or a rounded "
         "or converted position. Send joint.position, unchanged."),
    Case("the joints of the tank", moved(SLEW, model="tank"), f"Most likely {ALL_JOINTS}"),
    Case("two robots in turn", lambda trial: PUBLISHING.two(trial, moves=(REST,), model="crane"), SHARED_BY_ROBOTS),
    Case("after a restart", lambda trial: PUBLISHING.restarted(trial, moves=(REST,), model="crane"),
         "Your code probably keeps self.sent from the previous run, or waits for step 0. "
         "Create self.sent in initialize, which runs each time the simulation starts."),
]  # fmt: skip
thrift = Exercise("thrift", __doc__, PUBLISHING.cases(ThriftyPublisher, CASES, MISTAKES, MEANING))
