"""The exercise `show`: a displayed body moves as messages say. What it asks for, `keep_up` asks for, too.

Write the controller `MyViewer`. It listens to the topic `joint_state` of its body, which for the body `Tank` is
`/Tank/joint_state` (type `JointState`), and shows on the displayed body what it hears.

- The displayed body belongs to the main thread: the callback only posts, with `config.call_later`.
- The posted call matches by name (`match_joints`), sets the positions, computes the kinematics, and notifies
  (`notify_change`).
- It works on any body. In `unconfigure`, when it leaves the body, the node destroys its subscription.

Hint 1: Look at the two threads: the callback runs on the executor's, and the displayed body belongs to the main
thread. Code that moves the body may only run there.

Hint 2: In configure keep config.body and config.call_later, and then subscribe to a topic made from the body's name:
the callback may run at once. The callback has one line: it posts a method, with the message. That method matches,
sets the positions, computes the kinematics and notifies, in this order.

Hint 3: The callback: self.call_later(self.update, message), without parentheses after update. In update: positions,
report = match_joints(self.body.joint_names, message), then set_joint_positions, calc_forward_kinematics and
notify_change. In unconfigure: self.node.destroy_subscription(self.subscription).

Notice that the body's name and its joints come from the body, so the crane needed no other line.
"""

from collections.abc import Sequence
from functools import partial
from itertools import count
from math import nan

from sensor_msgs.msg import JointState

from tutorial.checks.exercise import Exercise, Step, Viewer, hands_over, heard, side_by_side, viewing
from tutorial.controller import ControllerConfig, SimpleController
from tutorial.joints import match_joints

TRIES = 12  # messages, of which each is to be shown
LATER = count(100_000, 20)  # [ms]


class MyViewer(SimpleController):
    """Show the joint states that another program publishes."""

    def configure(self, config: ControllerConfig) -> None:
        """Subscribe to the topic that is named after the body."""
        self.body = config.body
        self.node = config.node
        self.call_later = config.call_later
        topic = f"{self.body.name}/joint_state"
        self.subscription = self.node.create_subscription(JointState, topic, self.on_joint_state, 1)

    def on_joint_state(self, message: JointState) -> None:
        """Hand the message to the main thread."""
        self.call_later(self.update, message)

    def update(self, message: JointState) -> None:
        """Move the body's joints to where the message says."""
        positions, report = match_joints(self.body.joint_names, message)
        self.body.set_joint_positions(positions)
        self.body.calc_forward_kinematics()
        self.body.notify_change(report)

    def unconfigure(self) -> None:
        """Stop listening."""
        self.node.destroy_subscription(self.subscription)


def joint_state(names: str, positions: Sequence[float], milliseconds: int = 100_000) -> JointState:
    """Make a message, with a stamp in milliseconds; Y and P stand for the tank's joints."""
    short = {"Y": "TURRET_Y", "P": "TURRET_P"}
    message = JointState(name=[short.get(name, name) for name in names.split()], position=list(positions))
    message.header.stamp.sec, rest = divmod(milliseconds, 1000)
    message.header.stamp.nanosec = rest * 1_000_000
    return message


def state(names: str, positions: Sequence[float]) -> Step:
    """Make a step: a message comes, later than those before, and is shown."""
    return heard(joint_state(names, positions, next(LATER)))


def wait_together(viewer: Viewer) -> str:
    """Observe where the joints are after five messages that wait together."""
    for i, (name, position) in enumerate((("Y", 0.12), ("P", 0.13), ("Y", 0.14), ("Y", 0.15), ("P", 0.16))):
        viewer.receive(joint_state(name, [position], 100_000 + 20 * i))
    viewer.drain()
    right = viewer.where() == "TURRET_Y at 0.15, TURRET_P at 0.16"
    return viewer.where() + ("" if right else f", drawn {len(viewer.shown)} times")


def while_drawn(viewer: Viewer) -> None:
    """Have a message come while the next one is drawn."""
    late = [joint_state("Y P", (0.22, 0.22), 100_020)]

    def observe(_report: object) -> None:
        if late:
            viewer.receive(late.pop())

    viewer.body.on_change(observe)


def its_own(viewer: Viewer) -> None:
    """Have a message come for a body that nobody else is to show."""
    first, second = (0.2, 0.4) if viewer.body.name == "Rover" else (0.6, 0.8)
    viewer.receive(joint_state("Y P LUFF BRIDGE", (first, second, first, second)))


MESSAGES = [joint_state("Y P", (0.01 * i, 0.02 * i), 100_000 + 20 * i) for i in range(1, TRIES + 1)]
STAMPS = (100_020, 100_000, 100_040, 5, 5)  # [ms]
LATE = [joint_state("Y P", (0.1 + 0.01 * i, 0.2 + 0.01 * i), ms) for i, ms in enumerate(STAMPS)]

FIRST: dict[str, Sequence[Step]] = {
    "messages come": [hands_over(*MESSAGES)],
    "a message": [state("Y P", (0.1, 0.2)), Viewer.where],
    "its joints in another order": [state("P Y", (0.2, 0.1)), Viewer.where],
    "the news of it": [state("Y P", (0.1, 0.2)), Viewer.news] * 2,
    "only TURRET_P, then TURRET_Y": [state("Y P", (0.2, 0.3)), state("P", [-0.1]), state("Y", [0.0]), Viewer.where],
    "the unknown name ANTENNA": [state("ANTENNA", [1.0]), state("ANTENNA Y", (1.0, 0.2)), Viewer.where],
    "NaN for one joint": [state("Y P", (nan, 0.07)), state("Y P", (0.06, nan)), Viewer.where],
    "two names, one position or none": [state("P Y", [0.11]), state("Y P", []), Viewer.where],
    "a late message, then a new start": [heard(*LATE), Viewer.where],
    "a message that comes while the body is drawn": [while_drawn, state("Y P", (0.21, 0.21)), Viewer.news],
    "one that waits when the controller leaves": [lambda viewer: viewer.leaves(MESSAGES[0])],
}
LAST: dict[str, Sequence[Step]] = {
    "two viewers at once, one of the crane": [side_by_side(its_own, Viewer.drain, Viewer.where)],
    "after unconfigure": [Viewer.leaves, Viewer.left],
}

MISTAKES = """
# a message
The positions are not set, or changed on the way, as to degrees: self.body.set_joint_positions(positions), in rad.

# its joints in another order
positions are matched by their place in the message: match them by name, wherever it is, with match_joints.
    positions(positions) => positions(dict(zip(self.body.joint_names, message.position)))

# only TURRET_P, then TURRET_Y
a joint that the message does not name is set to 0 or looked up, the message is dropped, or a position of 0 or below is
left out: show the joints that it names, as they are, and leave the others where they are.
    positions(positions) => positions({name: positions.get(name, 0.0) for name in self.body.joint_names})

# the unknown name ANTENNA
a name that the body does not have is looked up, or spoils the message: match_joints leaves such names out.
    positions(positions) => positions(dict(zip(message.name, message.position)))

# NaN for one joint
NaN is set as a position: leave out that joint, and it stays where it is. match_joints does.
    positions(positions) => positions({n: q for n, q in zip(message.name, message.position) if n != "ANTENNA"})

# two names, one position or none
an index goes beyond the end: there may be fewer positions than names. match_joints knows that.
    positions, report = => _ = [message.position[i] for i in range(len(message.name))] // positions, report =

# a late message, then a new start
a message is dropped for its stamp: it may be equal or older, as when the publisher is started again.
    positions, report = => if message.header.stamp.sec < 1: return // positions, report =

# a message that comes while the body is drawn
Most likely a lock is held while the body is drawn, so the callback waits for that: hold it only to take the message.

# two viewers at once, one of the crane
Most likely the body's name or its joints are typed: take them from config.body.
"""

MORE = """
# five messages that wait together
the posted call takes the message from self, where the next one has replaced it: give it along, $post.
    $post => self.message = message // $post
    positions, report = => message = self.message // positions, report =
Not all are shown, in the order in which they came: post each one, with call_later, which keeps every call.
"""
viewing_joints = partial(
    viewing,
    topic="joint_state",
    message=joint_state("P Y", (0.2, 0.1)),
    crashes=("order", "only TURRET_P", "ANTENNA", "NaN", "two names", "late", "two viewers"),
)
TRIED = {**FIRST, "five messages that wait together": [wait_together], **LAST}
show = Exercise("show", __doc__, viewing_joints(MyViewer, tried=TRIED, table=MISTAKES + MORE))
