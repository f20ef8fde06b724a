"""The exercise `keep_up`: a viewer that shows the newest message, with at most one waiting call.

Write the controller `CalmViewer` for messages that each contain the whole state. It works like `MyViewer`, but keeps
up with any publisher:

- While the main thread is busy, at most one call waits for it. When this call runs, it shows only the newest message.
- So the viewer may skip messages. But the last message is always shown, even if the publisher then falls silent, and
  even if it arrives while another message is being processed.

Hint 1: Look at what piles up while the main thread is busy. MyViewer posts a call for every message, although you will
see only the newest message. What has to happen to a waiting call when the next message arrives?

Hint 2: ControllerConfig offers two ways to post a call. With one of them, a new call replaces a waiting one if you post
both under the same key. The key identifies the calls that replace each other. Everything else is the same as in
MyViewer.

Hint 3: In configure, store config.call_latest instead of config.call_later. The first argument of call_latest is a
key, which has to be the same for every message, for example the body's name. The function and the message follow, as
before.

Notice what you lose: a replaced call never runs, so every message has to name all joints.
"""

from collections.abc import Callable, Sequence
from functools import partial
from itertools import count

from sensor_msgs.msg import JointState

from tutorial.checks.engine.cases import Case
from tutorial.checks.engine.interleave import interleave
from tutorial.checks.engine.viewer import Viewer
from tutorial.checks.engine.viewing import Step, steps, viewing
from tutorial.checks.exercise import Exercise
from tutorial.checks.show import ARRIVALS, FIRST, LAST, SWAPPED, joint_state
from tutorial.controller import ControllerConfig, SimpleController
from tutorial.joints import match_joints

BURST = 50
MOST = (
    10_000  # maximum number of instructions that a method may execute; the other thread interrupts it at each of them
)
BOTH = "TURRET_Y at {:g}, TURRET_P at {:g}"


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
        """Hand the message to the main thread, and replace any message that is still waiting there."""
        self.call_latest(self.body.name, self.update, message)

    def update(self, message: JointState) -> None:
        """Move the body's joints to the positions in the message."""
        positions, report = match_joints(self.body.joint_names, message)
        self.body.set_joint_positions(positions)
        self.body.calc_forward_kinematics()
        self.body.notify_change(report)

    def unconfigure(self) -> None:
        """Stop listening."""
        self.node.destroy_subscription(self.subscription)


POST = "self.call_latest(self.body.name, self.update, message)"


def burst(begin: int, look: Callable[[Viewer, Sequence[str]], str]) -> Step:
    """Make a step that delivers many messages while the main thread is busy, then makes an observation.

    Args:
        begin: the number of the burst's first message.
        look: returns the observation, given the viewer and descriptions of the messages' joint positions.
    """

    def step(viewer: Viewer) -> str:
        viewer.shown.clear()
        sent = [(0.001 * i, 0.002 * (i - begin)) for i in range(begin, begin + BURST)]
        for i, positions in enumerate(sent, begin):
            viewer.receive(joint_state("Y P", positions, 100_000 + 401 * i))
        seen = look(viewer, [BOTH.format(*positions) for positions in sent])
        viewer.drain()
        return seen

    return step


def waiting(viewer: Viewer, _places: Sequence[str]) -> str:
    """Observe how many calls are waiting."""
    return f"waiting calls: {len(viewer.calls)}" + ", under different keys" * (len(set(viewer.keys)) > 1)


def drawn(viewer: Viewer, places: Sequence[str]) -> str:
    """Observe what is drawn when the calls run."""
    viewer.drain()
    where = viewer.where()
    message = f"message {places.index(where) + 1} of {BURST}" if where in places else where
    return (
        f"it draws {len(viewer.shown)} times, the last time {message}"
        if len(viewer.shown) > 1
        else f"it draws {message}"
    )


def in_any_order(viewer: Viewer) -> str:
    """Observe what the viewer shows if either thread interrupts the other at any instruction."""
    stamps = count(100_000, 20)
    for interrupts_drawing in (True, False):
        for at in range(MOST):
            first, second = (partial(viewer.call_back, joint_state("Y P", (q, q), next(stamps))) for q in (0.3, 0.4))
            viewer.shown.clear()
            first()
            turns = (viewer.drain, second) if interrupts_drawing else (second, viewer.drain)
            more = interleave(viewer.trial, turns[0], turns[1], at)
            viewer.drain()
            if {where for where, _ in viewer.shown} - {BOTH.format(q, q) for q in (0.3, 0.4)}:
                return "a mix of both messages is shown"
            if not more:
                break
            if viewer.where() != BOTH.format(0.4, 0.4):
                return "the new message is never shown"
    return "the new message is shown"


OWN = [
    Case("50 messages while the main thread is busy", steps(burst(0, waiting), burst(500, waiting)),
         "Your code probably posts the calls with call_later, or under different keys. Use call_latest, and the "
         "same key for every call, such as the body's name: a new call then replaces the waiting call."),
    Case("50 messages, and then the main thread draws", steps(burst(0, drawn), burst(500, drawn)),
         "Your code probably draws an older message, or more than one message. "
         "Draw only the newest message: pass it to call_latest."),
    Case("a message that arrives while an earlier one is being drawn", steps(in_any_order),
         "Your code probably clears the flag of a waiting call too late, or stores a message's "
         "fields one by one. Pass the whole message to call_latest, and use no flag."),
]  # fmt: skip

CASES = [*FIRST, *OWN, *LAST]
keep_up = Exercise("keep_up", __doc__, viewing(CalmViewer, "joint_state", SWAPPED, ARRIVALS, CASES, POST))
