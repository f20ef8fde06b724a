"""The exercise `show`: a displayed body moves as messages say. What it asks for, `keep_up` asks for, too.

Write the controller `MyViewer`. It listens to the topic `joint_state` of its body, which for the body `Tank` is
`/Tank/joint_state` (type `JointState`), and shows on the displayed body what it hears.

- The displayed body belongs to the main thread: the callback only posts, with `config.call_later`.
- What is posted matches by name (`match_joints`), sets the positions, computes the kinematics, and tells the
  observers.
- It works on any body, and when it leaves the body it has the node destroy its subscription.

Hint 1: Look at the two threads: the callback runs on the executor's, and the displayed body belongs to the main thread.
What moves it may only run there.

Hint 2: In configure keep config.body and config.call_later, and subscribe to a topic made from the body's name. The
callback has one line: it posts a method, with the message. That method matches, sets the positions, computes the
kinematics and notifies, in this order.

Hint 3: The callback: self.call_later(self.update, message), without parentheses after update. In update: positions,
report = match_joints(self.body.joint_names, message), then set_joint_positions, calc_forward_kinematics and
notify_change. In unconfigure: self.node.destroy_subscription(self.subscription).

Notice that the body's name and its joints come from the body, so the crane needed no other line.
"""

from __future__ import annotations

import asyncio  # noqa: F401 - what some mistakes need
import threading  # noqa: F401
from collections.abc import Callable, Sequence
from functools import partial
from math import degrees, isnan, nan, radians  # noqa: F401
from string import Template
from typing import Any

from sensor_msgs.msg import Imu, JointState  # noqa: F401

from tutorial.checks._node import ros_node, send
from tutorial.checks._requirements import Requirements, listed
from tutorial.checks._viewer import Viewer
from tutorial.checks._watch import Failure, watch
from tutorial.checks.exercise import Exercise
from tutorial.controller import ControllerConfig, SimpleController
from tutorial.joints import match_joints

__all__ = ["FIRST", "LAST", "MISTAKES", "MyViewer", "at", "joint_state", "over_ros", "show"]

TRIES = 12  # messages, of which each is to be shown
Attempt = Callable[[type], str]


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


def shows(
    *said: tuple[str, Sequence[float]], stamps: Sequence[int] = range(100_000, 101_000, 20), **body: Any
) -> Attempt:
    """Observe where the joints are after messages, each some names and their positions; with stamps [ms]."""

    def attempt(answer: type) -> str:
        with Viewer(answer, **body) as viewer:
            for (names, positions), stamp in zip(said, stamps):
                viewer.receive(joint_state(names, positions, stamp))
                viewer.drain()
            return viewer.where()

    return attempt


def listens(answer: type) -> str:
    """Observe what it listens to."""
    with Viewer(answer) as viewer:
        return viewer.listens()


def hands_over(answer: type) -> str:
    """Observe what the callback does, and what it leaves to the main thread."""
    posted = []
    with Viewer(answer) as viewer:
        viewer.guard.lenient = True
        for i in range(1, TRIES + 1):
            before = viewer.where()
            viewer.receive(joint_state("Y P", (0.01 * i, 0.02 * i), 100_000 + 20 * i))
            if "touch" in watch.noted:
                rest = "something" if viewer.uncallable else "the rest" if len(viewer.calls) else "nothing"
                return f"the body is touched on the executor's thread, and {rest} is posted"
            if "thread" in watch.noted or viewer.node.timers:
                return "a timer or a thread goes on beside the callback"
            waits = len(viewer.calls) > 0
            viewer.drain()
            posted.append(waits or viewer.where() != before)  # by way of the loop
    if all(posted):
        return "the callback posts, and leaves the body alone"
    return "some of them are not posted" if any(posted) else "nothing is posted"


def tells(answer: type) -> str:
    """Observe whether the links follow the joints, and what observers see."""
    with Viewer(answer) as viewer:
        viewer.receive(joint_state("Y P", (0.1, 0.2)))
        viewer.drain()
        if not viewer.links_follow():
            return "the links are where they were"
        when = "when" if (viewer.where(), True) in viewer.shown[-1:] else "before"
        return f"observers are told {when} all is in its place" if viewer.shown else "nobody is told"


def wait_together(answer: type) -> str:
    """Observe where the joints are after five messages that wait together."""
    with Viewer(answer) as viewer:
        for i, (name, position) in enumerate((("Y", 0.12), ("P", 0.13), ("Y", 0.14), ("Y", 0.15), ("P", 0.16))):
            viewer.receive(joint_state(name, [position], 100_000 + 20 * i))
        viewer.drain()
        return viewer.where() + f", drawn {len(viewer.shown)} times" * (viewer.where() != at(0.15, 0.16))


def does_not_wait(answer: type) -> str:
    """Observe what the callback does while the body is drawn."""
    with Viewer(answer) as viewer:
        viewer.while_drawn = partial(viewer.receive, joint_state("Y P", (0.22, 0.22), 100_020))
        viewer.receive(joint_state("Y P", (0.21, 0.21)))
        try:
            viewer.drain()
        except Failure as failure:
            return f"{failure.method}: {failure.error}"
        return "the callback does not wait for it"


def two(answer: type) -> str:
    """Observe two viewers at the same time, each of a body of its own."""
    with Viewer(answer) as tank, Viewer(answer, "crane", "Lift") as lift:
        for i in (1, 2):
            tank.receive(joint_state("Y P", (0.1 * i, 0.2 * i), 100_000 + 20 * i))
            lift.receive(joint_state("BRIDGE SLEW LUFF", (0.3 * i, 0.4 * i, 0.5 * i), 100_000 + 20 * i))
            tank.drain()
            lift.drain()
        return f"{tank.where()}; {lift.where()}"


def leaves(answer: type) -> str:
    """Observe what is left after `unconfigure`."""
    with Viewer(answer) as viewer:
        viewer.leave()
        return str(viewer.node.check_left())


def leaves_while_one_waits(answer: type) -> str:
    """Observe what comes of a message that waits."""
    with Viewer(answer) as viewer:
        viewer.leave(joint_state("Y P", (0.1, 0.2)))
        viewer.drain()
        return viewer.where()


def over_ros(answer: type) -> str:
    """Observe where the joints are after a message from another node."""
    with ros_node() as node, Viewer(answer, node=node) as viewer:
        before = viewer.where()

        def is_shown() -> bool:
            viewer.drain()
            return viewer.where() != before

        send(node, "/Tank/joint_state", joint_state("P Y", (0.2, 0.1)), is_shown)
        return viewer.where()


LIFT: dict[str, Any] = {"model": "crane", "name": "Lift", "namespace": "/lab"}
STAMPS = (100_020, 100_000, 100_040, 5, 6)  # [ms]
SWINGS = [("Y P", (0.1 + 0.01 * i, 0.2 + 0.01 * i)) for i in range(1, 6)]

FIRST = {
    "it listens to": (listens, "/Tank/joint_state of JointState"),
    "messages come": (hands_over, "the callback posts, and leaves the body alone"),
    "a message": (shows(("Y P", (0.1, 0.2))), at(0.1, 0.2)),
    "its joints in another order": (shows(("P Y", (0.2, 0.1))), at(0.1, 0.2)),
    "the news of it": (tells, "observers are told when all is in its place"),
    "a message with only TURRET_P": (shows(("Y P", (0.3, 0.2)), ("P", (0.05,))), at(0.3, 0.05)),
    "the unknown name ANTENNA": (shows(("ANTENNA Y", (1.0, 0.2))), at(0.2, 0)),
    "0, and less": (shows(("Y P", (0.1, 0.2)), ("Y P", (0.0, 0.05)), ("P", (-0.1,))), at(0, -0.1)),
    "NaN for one joint": (shows(("Y P", (nan, 0.07)), ("Y P", (0.06, nan))), at(0.06, 0.07)),
    "two names, one position or none": (shows(("P Y", (0.11,)), ("Y P", ())), at(0, 0.11)),
    "a late message, then a new start": (shows(*SWINGS, stamps=STAMPS), at(0.15, 0.25)),
    "a message that comes while the body is drawn": (does_not_wait, "the callback does not wait for it"),
    "one that waits when the controller leaves": (leaves_while_one_waits, at(0, 0)),
}
LAST = {
    "the crane Lift": (shows(("LUFF BRIDGE", (0.1, 0.2)), **LIFT), "BRIDGE at 0.2, SLEW at 0, LUFF at 0.1"),
    "two viewers at once": (two, f"{at(0.2, 0.4)}; BRIDGE at 0.6, SLEW at 0.8, LUFF at 1"),
    "after unconfigure": (leaves, "nothing is left"),
}

MISTAKES = """
# it listens to
the topic's name is another: it is f"{config.body.name}/joint_state".
    /joint_state" => /joint_states"
config.node.create_subscription(JointState, topic, self.on_joint_state, 1) is missing, or not reached.
    self.subscription = self.node.create_subscription(JointState, topic, self.on_joint_state, 1) => pass
the type of the messages is another: give JointState first.
    (JointState, => (Imu,

# messages come
the callback moves the body itself: all that touches it belongs into what is posted, $post; a lock does not help.
    $post => self.update(message) => self.update(message) // $post
the parentheses call it at once, and post what it returns: give the function and its arguments apart, $post.
    self.update, message) => self.update(message))
$post is missing, or not reached: the callback posts nothing.
    $post => pass
a timer or a thread of its own posts, whether there is news or not: the callback posts, once for each message, $post.
    $post => threading.Thread(target=lambda: $post).start() => self.node.create_timer(0.1, print)
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

# a message with only TURRET_P
a joint that the message does not name is set to 0, or looked up: leave it where it is.
    positions(positions) => positions({name: positions.get(name, 0.0) for name in self.body.joint_names})\
 => positions({name: positions[name] for name in self.body.joint_names})
a message that does not name all joints is dropped: show the joints that it names.
    self.body.set => if len(message.name) == len(self.body.joint_names): self.body.set

# the unknown name ANTENNA
a name that the body does not have is looked up, or spoils the message: match_joints leaves such names out.
    positions(positions) => positions(dict(zip(message.name, message.position)))

# 0, and less
positions below 0 are left out, or changed: a joint turns both ways.
    positions(positions) => positions({name: abs(q) for name, q in positions.items()})
0.0 is taken for nothing, as in `if position`: it is a position like any other.
    positions(positions) => positions({name: q for name, q in positions.items() if q})

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

# one that waits when the controller leaves
it goes to the event loop by itself: $post is asked for, and drops what still waits when the controller leaves its body.
    self.node = config.node => self.node, self.loop = config.node, asyncio.get_running_loop()
    $post => self.loop.call_soon_threadsafe(self.update, message)

# a message that comes while the body is drawn
a lock is held while the body is moved and drawn, so the callback waits for the main thread: hold it only to take the
message, and draw when it is free again.
    self.node = config.node => self.node, self.lock = config.node, threading.Lock()
    $post => with self.lock: $post
    self.body.notify_change(report) => with self.lock: self.body.notify_change(report)

# the crane Lift
the body's name or its joints are typed: take them from config.body.
    {self.body.name}/joint_state => Tank/joint_state
    match_joints(self.body.joint_names, => match_joints(("TURRET_Y", "TURRET_P"),

# two viewers at once
$name.body is shared by all objects of the class: keep in each what is its own, self.body = ..., and make it in
__init__, configure or initialize.
    self.body = config.body => type(self).body = config.body
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
        {**FIRST, "five messages that wait together": (wait_together, at(0.15, 0.16)), **LAST},
        Template(MISTAKES + MORE).substitute(post="self.call_later(self.update, message)", name="MyViewer"),
    ),
    on_ros=over_ros,
)

show = Exercise("show", __doc__, REQUIREMENTS.judge, MyViewer)
