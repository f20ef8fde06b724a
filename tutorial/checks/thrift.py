"""The exercise `thrift`: publish the joints that have moved.

Write the controller `ThriftyPublisher`. It publishes a `JointState` on the topic `joint_state` of its body, but only
what is new:

- 50 times per simulated second, as nearly as whole steps allow, it looks which joints are more than 0.001 rad (or m)
  away from the position that it last sent for them;
- the message names these joints, with their positions; if there are none, it sends nothing;
- the first message names all joints, and so does the first one after a restart of the simulation;
- the stamp is the simulated time at which it is sent. Velocity and effort stay empty.
- In `unconfigure`, when it leaves the body, the node destroys its publisher.

Hint 1: Look at what you compare with what: each joint's position with the one that you last sent for this joint,
which may have been long ago. Not with that of the last look, and not all joints together.

Hint 2: Keep a dict from each joint's name to the position that you last sent for it. It is empty at the beginning, so
all joints are new. Look every so many steps; collect what is new; only if there is any, send it, and only then note
what you have sent.

Hint 3: news = {name: q for name, q in positions.items() if name not in self.sent or abs(q - self.sent[name]) >
0.001}. If it is not empty: message.name = list(news), message.position = list(news.values()), publish, then
self.sent.update(news). In unconfigure: self.node.destroy_publisher(self.publisher).

Notice that receivers have to match these messages by name: the viewer of step 3 shows them without a change.
"""

from collections.abc import Sequence
from typing import Any

from rclpy.time import Time
from sensor_msgs.msg import JointState

from tutorial.checks.exercise import Case, Exercise, Publishing, Rig, Sent
from tutorial.controller import ControllerConfig, ControllerIO, SimpleController


class ThriftyPublisher(SimpleController):
    """Publish the positions of the joints that have moved."""

    def configure(self, config: ControllerConfig) -> None:
        """Announce the topic, named after the body."""
        self.node = config.node
        self.publisher = self.node.create_publisher(JointState, f"{config.body.name}/joint_state", 10)

    def initialize(self, io: ControllerIO) -> None:
        """Begin with nothing sent."""
        self.io = io
        self.sent: dict[str, float] = {}
        self.steps_per_look = round(1 / (50 * io.time_step))

    def control(self) -> None:
        """Look, when it is time to, what is news."""
        if self.io.step % self.steps_per_look == 0:
            positions = {joint.name: joint.position for joint in self.io.body.joints}
            news = {n: q for n, q in positions.items() if n not in self.sent or abs(q - self.sent[n]) > 0.001}
            if news:
                message = JointState(name=list(news), position=list(news.values()))
                message.header.stamp = Time(nanoseconds=self.io.time_ns).to_msg()
                self.publisher.publish(message)
                self.sent.update(news)

    def unconfigure(self) -> None:
        """Take the topic back."""
        self.node.destroy_publisher(self.publisher)


MISTAKES = """
the first message is forgotten: nothing was sent yet, so self.sent is empty, and all are news.
    : dict[str, float] = {} => = {j.name: j.position for j in io.body.joints} => = dict.fromkeys(io.body.joint_names, 0)

every joint is sent every time, and not only at first: name those that have moved, and note what was sent for them.
    if n not in self.sent or abs(q - self.sent[n]) > 0.001} => }

a position of 0 is taken for none, as in `if not last`: ask whether the name is in self.sent.
    n not in self.sent or => not self.sent.get(n) or

the whole message is sent as soon as one joint moves: name only those that did.
    message = => news = positions // message =

only one of the joints that have moved is named, the first, as with break, or the last: name all that have.
    if news: => news = dict([*news.items()][:1]) // if news: => news = dict([*news.items()][-1:]) // if news:
    => news = dict([*news.items()][: 1 if self.sent else None]) // if news:

a message is sent even if no joint has moved: then send none.
    if news: => if True:

positions are compared with those of the last look or message: compare each with what was last sent for this joint.
    if news: => self.sent = positions // if news: => self.sent = positions if news else self.sent // if news:

what was sent is renewed before it is compared, or is the same object, or the velocity is compared: compare first.
    n not in self.sent or abs(q - self.sent[n]) > 0.001 => n not in self.sent

the changes of all joints are added up: compare each joint for itself with 0.001.
    abs(q - self.sent[n]) > => sum(abs(p - self.sent[m]) for m, p in positions.items()) >

rounded or truncated positions are compared: how far they are apart counts, abs(a - b) > 0.001.
    abs(q - self.sent[n]) > 0.001 => round(q, 3) != round(self.sent[n], 3) => int(q * 1000) != int(self.sent[n] * 1000)

the sign gets in the way: compare abs(a - b) with 0.001.
    abs(q - self.sent[n]) => (q - self.sent[n]) => (self.sent[n] - q) => abs(abs(q) - abs(self.sent[n]))

what was sent is not remembered, or self.sent = ... forgets the other joints: self.sent.update(news), whenever you send.
    self.sent.update(news) => self.sent = news | self.sent => self.sent = news

the threshold is another, or any change counts: only more than 0.001 does, in rad (or m).
    > 0.001 => > 0 => > 0.1 => > 0.01 => > 0.0001 => > radians(0.001)

#
Compare each joint's position with the one that was last sent for it, when io.step % steps_per_look == 0, not counted
from the last message. Each has new lists: the names of these joints, unchanged, and their positions, nothing else.

# each position
Send where each joint is, joint.position, neither rounded nor converted, and not how far it has moved.

# after a restart
Most likely self.sent is kept from the run before, or step 0 is waited for: make it anew in initialize.

# the joints of the tank
the joints' names are typed, or how many there are: take them from io.body.joints.
    self.io.body.joints => self.io.body.joints[:2] => map(self.io.body.joint, ("TURRET_Y", "TURRET_P"))
"""

LOOK = 0.02  # [s]
Move = tuple[float, float, float]  # [m, rad, rad] of the crane's joints
REST: Move = (0.0, 0.0, 0.0)
SLEW: Move = (0.0, 0.05, 0.0)


def moving(answer: type, moves: Sequence[Move] = (), **options: Any) -> Rig:
    """Make a rig whose joints move between looks, from the second one on; without moves at every step, and fast."""

    def move() -> None:
        look, rest = divmod(rig.io.step, round(LOOK / rig.io.time_step))
        at_once = moves[look - 1] if rest == 5 and 0 < look <= len(moves) else REST
        for joint, distance in zip(rig.body.joints, at_once if moves else (0.01, 0.01, 0.01)):
            joint.position += distance

    rig = Rig(answer, move, **options)
    rig.displayed.set_joint_positions({name: 0.3 + 0.1 * i for i, name in enumerate(rig.body.joint_names)})
    return rig


def looks(rig: Rig, sent: list[Sent]) -> dict[str, list[str]]:
    """Observe at which look which joints are named; the first two looks count as one."""
    steps = round(LOOK / rig.io.time_step)
    found = [f"{named(each.message)} at look {max((each.step - rig.begun + 1) // steps, 1)}" for each in sent]
    return {", ".join(found[:6]): found}


def named(message: Any) -> str:
    """Say which joints a message names, and what is odd about that."""
    count, more = len(message.position), len(message.velocity) + len(message.effort)
    odd = f" and {count} positions" * (count != len(message.name)) + " and velocity or effort" * (more > 0)
    return (" and ".join(sorted(message.name)) or "no joint") + odd


def positions(_rig: Rig, sent: list[Sent]) -> dict[str, list[Any]]:
    """Observe the positions."""
    seen = [sorted(zip(each.message.name, each.message.position)) for each in sent]
    return {", ".join(f"{name} {position:.6g}" for name, position in seen[-1]): seen}


PUBLISHING = Publishing(JointState, "joint_state", 50, moving, looks, namespaces=False)


def moved(*moves: Move, look: Any = None, **options: Any) -> Case:
    """Observe what is sent of a crane that moves."""
    return PUBLISHING.sent(LOOK * (len(moves) + 2), look, ms=1, moves=moves, **{"model": "crane", **options})


TRIED = {
    "with steps of 0.5 ms": PUBLISHING.rate(0.5),
    "nothing moves": moved(*[REST] * 4),
    "SLEW moves far, then by little, and rests": moved((0.0, 2.0, 0.0), (0.0, 0.0015, 0.0), REST),
    "all creep, each by little": moved((0.001, 0.0006, 0.0006)),
    "LUFF moves, and trembles": moved(*[(0.0, 0.0, by) for by in (0.2996, 0.0007, -0.0009, 0.0007)]),
    "LUFF creeps": moved(*[(0.0, 0.0, 0.00035)] * 8),
    "BRIDGE and SLEW move": moved((0.006, 0.05, 0.0)),
    "LUFF creeps on while SLEW moves": moved(*[(0.0, 0.05, 0.00035)] * 9),
    "BRIDGE moves back": moved((0.02, 0.0, 0.0), (-0.04, 0.0, 0.0), REST, REST),
    "each position": moved((0.1, 0.3004, -0.2004), SLEW, (0.0, 0.0, 0.05), look=positions),
    "the joints of the tank": moved(SLEW, model="tank"),
    "two robots in turns": lambda answer: PUBLISHING.two(answer, moves=(REST,), model="crane"),
    "after a restart": lambda answer: PUBLISHING.restarted(answer, moves=(REST,), model="crane"),
}
thrift = Exercise("thrift", __doc__, PUBLISHING.cases(ThriftyPublisher, TRIED, MISTAKES))
