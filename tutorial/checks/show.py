"""The exercise `show`: show joint states on a displayed body. `keep_up` has the same requirements and one more.

Write the controller `MyViewer`. It subscribes to its body's topic `joint_state` (for the tank, `Tank/joint_state`; type
`JointState`), and shows the received states on the displayed body. The node has no namespace, so a leading slash makes
no difference.

- The displayed body belongs to the main thread. The callback only posts a call (`config.call_later`) and returns.
- The posted call matches joints by name, sets the positions, computes the kinematics (`calc_forward_kinematics`), and
  calls `notify_change`. Match joints with your `match_by_name`, or the library's `match_joints` or `JointMatcher`.
- Show every message, even a repeated one, and even if its stamp is earlier because the publisher has restarted. You
  may drop a message that is merely late, as `JointMatcher` does.
- `MyViewer` works on any body. In `unconfigure`, have the node destroy the subscription.

Hint 1: Look at the two threads. The callback runs on the executor's thread, but the displayed body belongs to the main
thread: code that moves the body must run there.

Hint 2: In configure, store config.body, config.node and config.call_later. Subscribe last, because the callback can run
immediately, and derive the topic from the body's name. The callback has one line, which posts a call to another method,
with the message as its argument. That method matches the joints, sets the positions, computes the kinematics and calls
notify_change, in this order.

Hint 3: In the callback, call self.call_later(self.update, message), without parentheses after update. In update:
positions, report = match_joints(self.body.joint_names, message), then set_joint_positions, calc_forward_kinematics and
notify_change. In unconfigure: self.node.destroy_subscription(self.subscription).

Notice that the topic's name and the joints come from the body, so the same code can also show a crane.
"""

from collections.abc import Sequence
from math import nan

from sensor_msgs.msg import JointState

from tutorial.checks.engine.cases import Case
from tutorial.checks.engine.viewer import Viewer
from tutorial.checks.engine.viewing import MOVES, PAST_THE_QUEUE, Step, hands_over, heard, side_by_side, steps, viewing
from tutorial.checks.exercise import Exercise
from tutorial.controller import ControllerConfig, SimpleController
from tutorial.joints import match_joints

TRIES = 12  # number of different messages; the last one is repeated


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
        """Move the body's joints to the positions in the message."""
        positions, report = match_joints(self.body.joint_names, message)
        self.body.set_joint_positions(positions)
        self.body.calc_forward_kinematics()
        self.body.notify_change(report)

    def unconfigure(self) -> None:
        """Stop listening."""
        self.node.destroy_subscription(self.subscription)


def joint_state(names: str, positions: Sequence[float], milliseconds: int = 100_000) -> JointState:
    """Make a message with a stamp [ms]. In `names`, Y and P are short for the tank's joints."""
    short = {"Y": "TURRET_Y", "P": "TURRET_P"}
    message = JointState(name=[short.get(name, name) for name in names.split()], position=list(positions))
    message.header.stamp.sec, rest = divmod(milliseconds, 1000)
    message.header.stamp.nanosec = rest * 1_000_000
    return message


def states(*messages: tuple[str, Sequence[float]]) -> Step:
    """Make a step that delivers messages, stamped 20 ms apart, and runs the posted calls."""
    return heard(*[joint_state(*each, 100_200 + 20 * i) for i, each in enumerate(messages)])


def wait_together(viewer: Viewer) -> str:
    """Observe the joints after five messages whose posted calls are all waiting at once."""
    for i, (name, position) in enumerate((("Y", 0.12), ("P", 0.13), ("Y", 0.14), ("Y", 0.15), ("P", 0.16))):
        viewer.receive(joint_state(name, [position], 100_000 + 20 * i))
    viewer.drain()
    right = viewer.where() == "TURRET_Y at 0.15, TURRET_P at 0.16"
    return viewer.where() + ("" if right else f", number of draws: {len(viewer.shown)}")


def while_drawn(viewer: Viewer) -> None:
    """Prepare to deliver a message while an earlier one is being drawn."""
    late = [joint_state("Y P", (0.22, 0.22), 100_020)]

    def observe(_report: object) -> None:
        if late:
            viewer.receive(late.pop())

    viewer.body.on_change(observe)


def its_own(viewer: Viewer) -> None:
    """Deliver a message that only this viewer may show."""
    first, second = (0.2, 0.4) if viewer.body.name == "Rover" else (0.6, 0.8)
    viewer.receive(joint_state("Y P LUFF BRIDGE", (first, second, first, second)))


def repeated(viewer: Viewer) -> str:
    """Observe the effect of a message that repeats the previous one, as the messages of a robot at rest do."""
    for _ in range(2):
        viewer.shown.clear()
        heard(joint_state("Y P", (0.1, 0.2)))(viewer)
    return viewer.news()


MESSAGES = [joint_state("Y P", (0.01 * min(i, TRIES), 0.02), 100_000 + 20 * i) for i in range(1, TRIES + 3)]
STAMPS = (100_020, 100_000, 100_040, 5, 5)  # [ms]
LATE = [joint_state("Y P", (0.1 + 0.01 * i, 0.2 + 0.01 * i), ms) for i, ms in enumerate(STAMPS)]


FIRST = [
    Case("a message", steps(states(("Y P", (0.1, 0.2))), Viewer.where),
         "Your code probably doesn't set any positions, or changes the received positions first. "
         "Call self.body.set_joint_positions(positions), with positions in rad."),
    Case("the joints in a different order", steps(states(("P Y", (0.2, 0.1))), Viewer.where),
         "Your code probably matches positions by their index in the message. "
         "Match them by name, as match_joints does."),
    Case("after each move", steps(*[states(("Y P", (0.1, 0.2))), Viewer.news] * 2), MOVES),
    Case("only TURRET_P, then TURRET_Y", steps(states(("Y P", (0.2, 0.3)), ("P", [-0.1]), ("Y", [0.0])), Viewer.where),
         "Your code probably expects every joint in every message, or skips positions of 0 or below. Set all "
         "joints that the message names, and no others.", crashes=True),
    Case("the unknown name ANTENNA", steps(states(("ANTENNA", [1.0]), ("ANTENNA Y", (1.0, 0.2))), Viewer.where),
         "Your code probably uses the name of a joint that the body does not have. Skip that joint, and show the other "
         "joints, as match_joints does.", crashes=True),
    Case("NaN for one joint", steps(states(("Y P", (nan, 0.07)), ("Y P", (0.06, nan))), Viewer.where),
         "Your code probably sets NaN as a position. Leave that joint where it is, as match_joints does."),
    Case("two names, but only one position, or none", steps(states(("P Y", [0.11]), ("Y P", [])), Viewer.where),
         "Your code probably uses an index beyond the end of the positions: there can "
         "be fewer positions than names. match_joints handles that.", crashes=True),
    Case("a late message, then a restart of the publisher", steps(heard(*LATE), Viewer.where),
         "Your code probably drops a message because of its stamp. After the publisher "
         "restarts, its stamps are smaller than before, and two messages can have the same stamp."),
    Case("the same message again", steps(repeated), "Your code probably skips a message that repeats the "
         "positions of the previous one. Show every message, and call notify_change for each one."),
    Case("a message that arrives while the body is being drawn",
         steps(while_drawn, states(("Y P", (0.21, 0.21))), Viewer.news),
         "Your code probably holds a lock while it draws, so the callback has to wait. "
         "Hold the lock only while you get the message."),
    Case("a call that is waiting when the controller leaves the body", steps(lambda viewer: viewer.leaves(MESSAGES[0])),
         PAST_THE_QUEUE),
]  # fmt: skip
LAST = [
    Case("two viewers at once, one of them for the crane", steps(side_by_side(its_own, Viewer.drain, Viewer.where)),
         "Your code probably hard-codes the names of the body or its joints. Get them from config.body.", crashes=True),
    Case("after unconfigure", steps(Viewer.leaves, Viewer.left)),
]  # fmt: skip
SWAPPED = joint_state("P Y", (0.2, 0.1))
ARRIVALS = [hands_over(*MESSAGES)]
CASES = [
    *FIRST,
    Case("five messages whose calls are waiting at the same time", steps(wait_together),
         "Your code probably loses messages, or changes their order. Post one call for each message: "
         "self.call_later(self.update, message)."),
    *LAST,
]  # fmt: skip
show = Exercise("show", __doc__, viewing(MyViewer, "joint_state", SWAPPED, ARRIVALS, CASES))
