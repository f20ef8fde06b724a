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

from __future__ import annotations

import asyncio  # noqa: F401 - what some mistakes need
import threading  # noqa: F401
from collections.abc import Sequence
from functools import partial
from math import degrees, isnan, nan, radians  # noqa: F401
from string import Template

from sensor_msgs.msg import Imu, JointState  # noqa: F401

from tutorial.checks._requirements import Requirements, listed
from tutorial.checks._viewer import LISTENS, POSTS, TOLD, Attempt, Viewer, hands_over, heard, over_ros
from tutorial.checks._watch import Failure
from tutorial.checks.exercise import Exercise
from tutorial.controller import ControllerConfig, SimpleController
from tutorial.joints import match_joints

__all__ = ["FIRST", "LAST", "MISTAKES", "ON_ROS", "MyViewer", "at", "joint_state", "show"]

TRIES = 12  # messages, of which each is to be shown


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


def at(y: float, p: float) -> str:
    """Say where the tank's joints are [rad], as `Viewer.where` does."""
    return f"TURRET_Y at {y:g}, TURRET_P at {p:g}"


def shows(*said: tuple[str, Sequence[float]], stamps: Sequence[int] = range(100_000, 101_000, 20)) -> Attempt:
    """Observe where the joints are after messages, each some names and their positions; with stamps [ms]."""
    return Viewer.tries(heard(*(joint_state(*each, stamp) for each, stamp in zip(said, stamps))), Viewer.where)


def wait_together(viewer: Viewer) -> str:
    """Observe where the joints are after five messages that wait together."""
    for i, (name, position) in enumerate((("Y", 0.12), ("P", 0.13), ("Y", 0.14), ("Y", 0.15), ("P", 0.16))):
        viewer.receive(joint_state(name, [position], 100_000 + 20 * i))
    viewer.drain()
    return viewer.where() + f", drawn {len(viewer.shown)} times" * (viewer.where() != at(0.15, 0.16))


def does_not_wait(viewer: Viewer) -> str:
    """Observe what the callback does while the body is drawn."""
    viewer.while_drawn = partial(viewer.receive, joint_state("Y P", (0.22, 0.22), 100_020))
    try:
        heard(joint_state("Y P", (0.21, 0.21)))(viewer)
    except Failure as failure:
        return f"{failure.method}: {failure.error}"
    return "the callback does not wait for it"


def two(answer: type) -> str:
    """Observe two viewers at the same time, each of a body of its own."""
    with Viewer(answer) as tank, Viewer(answer, "crane", "Lift") as lift:
        for i in (1, 2):
            tank.receive(joint_state("Y P", (0.1 * i, 0.2 * i), 100_000 + 20 * i))
            lift.receive(joint_state("LUFF BRIDGE", (0.3 * i, 0.4 * i), 100_000 + 20 * i))
            tank.drain()
            lift.drain()
        return f"{tank.where()}; {lift.where()}"


STAMPS = (100_020, 100_000, 100_040, 5, 6)  # [ms]
SWINGS = [("Y P", (0.1 + 0.01 * i, 0.2 + 0.01 * i)) for i in range(1, 6)]
MESSAGES = [joint_state("Y P", (0.01 * i, 0.02 * i), 100_000 + 20 * i) for i in range(1, TRIES + 1)]

FIRST = {
    LISTENS: (Viewer.tries(Viewer.listens), "/Rover/joint_state of JointState"),
    "messages come": (Viewer.tries(hands_over(TRIES, *MESSAGES)), POSTS),
    "a message": (shows(("Y P", (0.1, 0.2))), at(0.1, 0.2)),
    "its joints in another order": (shows(("P Y", (0.2, 0.1))), at(0.1, 0.2)),
    "the news of it": (Viewer.tries(heard(joint_state("Y P", (0.1, 0.2))), Viewer.news), TOLD),
    "only TURRET_P, then only TURRET_Y": (shows(("Y P", (0.2, 0.3)), ("P", (-0.1,)), ("Y", (0.0,))), at(0, -0.1)),
    "the unknown name ANTENNA": (shows(("ANTENNA Y", (1.0, 0.2))), at(0.2, 0)),
    "NaN for one joint": (shows(("Y P", (nan, 0.07)), ("Y P", (0.06, nan))), at(0.06, 0.07)),
    "two names, one position or none": (shows(("P Y", (0.11,)), ("Y P", ())), at(0, 0.11)),
    "a late message, then a new start": (shows(*SWINGS, stamps=STAMPS), at(0.15, 0.25)),
    "a message that comes while the body is drawn": (Viewer.tries(does_not_wait), "the callback does not wait for it"),
    "one that waits when the controller leaves": (Viewer.tries(lambda viewer: viewer.leaves(MESSAGES[0])), at(0, 0)),
}
LAST = {
    "two viewers at once, one of the crane": (two, f"{at(0.2, 0.4)}; BRIDGE at 0.8, SLEW at 0, LUFF at 0.6"),
    "after unconfigure": (Viewer.tries(Viewer.leaves, Viewer.left), f"{at(0, 0)}, nothing is left"),
}
ON_ROS = over_ros(Viewer, "/Rover/joint_state", joint_state("P Y", (0.2, 0.1)))

MISTAKES = """
# on a body called Rover it listens to
the topic is another: it is f"{config.body.name}/joint_state".
    {self.body.name}/joint_state" => {self.body.name}/joint_states" => Tank/joint_state"
config.node.create_subscription(JointState, topic, self.on_joint_state, 1) is missing, or not reached.
    self.subscription = self.node.create_subscription(JointState, topic, self.on_joint_state, 1) => pass
the type of the messages is another: give JointState first.
    (JointState, => (Imu,

# messages come
$post is missing, or not reached: the callback posts nothing.
    $post => pass
messages are dropped by time or by count: post and show every one, whenever it comes.
    $post => if message.position[0] < 0.05: $post

# a message
the positions are changed on the way, as to degrees: set them as match_joints returns them, in rad.
    positions(positions) => positions({name: -q for name, q in positions.items()})\
 => positions({name: degrees(q) for name, q in positions.items()})\
 => positions({name: radians(q) for name, q in positions.items()})
the positions are computed but not set: self.body.set_joint_positions(positions).
    self.body.set_joint_positions(positions) => pass

# its joints in another order
positions are matched by their place in the message: match them by name, wherever it is, with match_joints.
    positions(positions) => positions(dict(zip(self.body.joint_names, message.position)))\
 => positions({n: positions[n] for n, m in zip(self.body.joint_names, message.name) if n == m})

# the news of it
self.body.calc_forward_kinematics() is missing, or called before set_joint_positions: the links stay behind the joints.
    self.body.calc_forward_kinematics() => pass
self.body.notify_change() is missing, or not reached: nobody is told to draw.
    self.body.notify_change(report) => pass
notify_change comes too early: first the positions, then the kinematics, then the news of it.
    self.body.notify_change(report) => pass
    self.body.set_joint => self.body.notify_change() // self.body.set_joint

# only TURRET_P, then only TURRET_Y
a joint that the message does not name is set to 0, or looked up: leave it where it is.
    positions(positions) => positions({name: positions.get(name, 0.0) for name in self.body.joint_names})\
 => positions({name: positions[name] for name in self.body.joint_names})
a message that does not name all joints is dropped: show the joints that it names.
    self.body.set => if len(message.name) == len(self.body.joint_names): self.body.set
positions below 0, or 0.0 as in `if position`, are left out or changed: they are positions like any other.
    positions(positions) => positions({name: abs(q) for name, q in positions.items()})\
 => positions({name: q for name, q in positions.items() if q})

# the unknown name ANTENNA
a name that the body does not have is looked up, or spoils the message: match_joints leaves such names out.
    positions(positions) => positions(dict(zip(message.name, message.position)))

# NaN for one joint
NaN is set as a position: leave out that joint, and it stays where it is. match_joints does.
    positions, report = => report = dict(zip(message.name, message.position)) // positions, _ =
    positions(positions) => positions({name: q for name, q in report.items() if name in self.body.joint_names})
one NaN makes the whole message invalid: leave out only that joint, as match_joints does.
    positions(positions) => positions({} if any(map(isnan, message.position)) else positions)

# two names, one position or none
an index goes beyond the end: there may be fewer positions than names. match_joints knows that.
    positions, report = => _ = [message.position[i] for i in range(len(message.name))] // positions, report =

# a late message, then a new start
a message with an older stamp is dropped for ever: stamps begin anew when the publisher is started again.
    self.node = config.node => self.node, self.newest = config.node, 0
    positions, report = => if message.header.stamp.sec < self.newest: return // positions, report =
    self.body.set => self.newest = message.header.stamp.sec // self.body.set

# a message that comes while the body is drawn
a lock is held while the body is drawn, so the callback waits for that: hold it only to take the message.
    self.node = config.node => self.node, self.lock = config.node, threading.Lock()
    $post => with self.lock: $post
    self.body.notify_change(report) => with self.lock: self.body.notify_change(report)

# two viewers at once, one of the crane
the body's name or its joints are typed: take them from config.body.
    match_joints(self.body.joint_names, => match_joints(("TURRET_Y", "TURRET_P"),

# one that waits when the controller leaves
it goes to the event loop by itself: $post is asked for, and drops what still waits when the controller leaves its body.
    self.node = config.node => self.node, self.loop = config.node, asyncio.get_running_loop()
    $post => self.loop.call_soon_threadsafe(self.update, message)
"""

MORE = """
# five messages that wait together
a message is dropped while another one waits: call_later keeps all, in order, and each has to be shown.
    self.node = config.node => self.node, self.busy = config.node, False
    $post => if not self.busy: $post // self.busy = True
    self.body.set => self.busy = False // self.body.set
it is posted with call_latest, which replaces a call that waits: call_later keeps all, in order.
    self.call_later = config.call_later => self.call_later = lambda *call: config.call_latest(0, *call)
the posted call takes the message from self, where the next one has replaced it: give it along, $post.
    $post => self.message = message // $post
    positions, report = => message = self.message // positions, report =
the newest of those that wait is taken first: the oldest comes first, and the newest stays shown.
    self.node = config.node => self.node, self.inbox = config.node, []
    $post => self.inbox.append(message) // $post
    positions, report = => message = self.inbox.pop() // positions, report =
"""
REQUIREMENTS = Requirements(
    MyViewer,
    listed(
        {**FIRST, "five messages that wait together": (Viewer.tries(wait_together), at(0.15, 0.16)), **LAST},
        Template(MISTAKES + MORE).substitute(post="self.call_later(self.update, message)"),
    ),
    on_ros=ON_ROS,
)

show = Exercise("show", __doc__, REQUIREMENTS.judge, MyViewer)
