"""The exercise `keep_up`: a viewer that shows the newest message, and lets at most one call wait.

Write the controller `CalmViewer`, for messages that are whole states. It does what `MyViewer` does, but keeps up with
any publisher: while the main thread is busy, at most one call waits for it, and then it shows the newest message. It
always shows the last message before the publisher falls silent.

Hint 1: Look at what waits while the main thread is busy: with MyViewer a call for every message, although you will
see only the newest. What would have to happen to a call that still waits when the next message comes?

Hint 2: ControllerConfig has two ways to post. With one of them a new call replaces a waiting one, if you post both
under the same key: the key says what the call is about. All else stays as in MyViewer.

Hint 3: In configure keep config.call_latest in place of config.call_later. It takes a key first, which has to be the
same for every message and may be the body's name; then the function and the message, as before.

Notice what you lose: a call that is replaced never runs, so every message has to name all joints.
"""

from collections.abc import Sequence
from functools import partial
from itertools import count

from sensor_msgs.msg import JointState

from tutorial.checks.exercise import Exercise, Step, Viewer, interleave
from tutorial.checks.show import FIRST, LAST, MISTAKES, joint_state, viewing_joints
from tutorial.controller import ControllerConfig, SimpleController
from tutorial.joints import match_joints

BURST = 50
MOST = 10_000  # instructions of a method
EACH = "TURRET_Y at {0}, TURRET_P at {0}"


class CalmViewer(SimpleController):
    """Show the newest joint states that another program publishes."""

    def configure(self, config: ControllerConfig) -> None:
        """Subscribe to the topic that is named after the body."""
        self.body = config.body
        self.node = config.node
        self.call_latest = config.call_latest
        topic = f"{self.body.name}/joint_state"
        self.subscription = self.node.create_subscription(JointState, topic, self.on_joint_state, 1)

    def on_joint_state(self, message: JointState) -> None:
        """Hand the message to the main thread, in the place of one that still waits there."""
        self.call_latest(self.body.name, self.update, message)

    def update(self, message: JointState) -> None:
        """Move the body's joints to where the message says."""
        positions, report = match_joints(self.body.joint_names, message)
        self.body.set_joint_positions(positions)
        self.body.calc_forward_kinematics()
        self.body.notify_change(report)

    def unconfigure(self) -> None:
        """Stop listening."""
        self.node.destroy_subscription(self.subscription)


def burst(begin: int) -> Step:
    """Make a step: say what waits, and what is shown, when many messages come while the main thread is busy."""

    def step(viewer: Viewer) -> str:
        viewer.shown.clear()
        for i in range(begin, begin + BURST):
            viewer.receive(joint_state("Y P", (0.001 * i, 0.002 * (i - begin)), 100_000 + 401 * i))
        waiting = len(viewer.calls)
        viewer.drain()
        if waiting > 1:
            return "more than one call waits" + ", under different keys" * (len(set(viewer.keys)) > 1)
        return f"one call waits, and draws{' more than once' * (len(viewer.shown) > 1)}: {viewer.where()}"

    return step


def in_any_order(viewer: Viewer) -> str:
    """Observe what is shown when the turn of one thread comes at any instruction of the other."""
    stamps = count(100_000, 20)
    for interrupts_drawing in (True, False):
        for at in range(MOST):
            first, second = (partial(viewer.call_back, joint_state("Y P", (q, q), next(stamps))) for q in (0.3, 0.4))
            viewer.shown.clear()
            first()
            turns = (viewer.drain, second) if interrupts_drawing else (second, viewer.drain)
            more = interleave(turns[0], turns[1], at)
            viewer.drain()
            if {where for where, _ in viewer.shown} - {EACH.format(0.3), EACH.format(0.4)}:
                return "half of each is shown"
            if not more:
                break
            if viewer.where() != EACH.format(0.4):
                return "the second is never shown"
    return "the second is shown in the end"


OWN: dict[str, Sequence[Step]] = {
    "50 messages while the main thread is busy, twice": [burst(0), burst(500)],
    "a message that comes while another is drawn": [in_any_order],
}

MORE = """
# 50 messages while the main thread is busy, twice
the first of them is kept: the newest is what counts, and call_latest keeps that.
    self.node = config.node => self.node, self.busy = config.node, False
    $post => if self.busy: return // self.busy = True // $post
    self.body.calc_f => self.busy = False // self.body.calc_f
Most likely each is posted with call_later, which keeps every call, or under a key of its own, or more are drawn than
the newest: call_latest keeps one call, the newest, of those with the same key, the body's name.

# a message that comes while another is drawn
Most likely what says that a call waits is cleared after the message is taken, or the message is kept piece by piece:
leave the first to call_latest, and hand the message over as a whole, with the call.
"""
POST = "self.call_latest(self.body.name, self.update, message)"
CASES = viewing_joints(CalmViewer, tried={**FIRST, **OWN, **LAST}, table=MISTAKES + MORE, post=POST)
keep_up = Exercise("keep_up", __doc__, CASES)
