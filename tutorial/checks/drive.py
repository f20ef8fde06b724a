"""The exercise `drive`: convert the left stick's position to track speeds.

Write the controller `GentleTank`. It subscribes to the topic `joy` (type `Joy`), without a leading slash, so the topic
is in the node's namespace. It drives only the tracks, the actuators `TRACK_L` and `TRACK_R` of `io.body`, with the left
stick: `axes[0]` is `left_x`, positive to the left, and `axes[1]` is `left_y`, positive forward.

- The left track runs at `1.0 * left_y - 0.5 * left_x` [m/s], the right one at `1.0 * left_y + 0.5 * left_x`.
- An axis counts as 0 if its absolute value is at most 0.3. Check each axis separately, and use it unchanged outside
  this dead zone.
- A missing axis counts as 0. Before the first message, all axes count as 0.
- In every step, use the newest message, even if it arrived long ago, or before a restart of the simulation.
- In `unconfigure`, when the controller leaves the body, have the node destroy the subscription.

Mind the threads: the callback runs on the executor's thread, `control` on the simulation's thread. Only `control` may
set the tracks.

Hint 1: Which thread calls on_joy, and which one calls control? How does the message get from one thread to the other?
And what does control find before the first message, or in a message with too few axes?

Hint 2: In configure, make a Latest with an empty Joy() before you subscribe. The callback puts each message into this
Latest. In every step, control gets the message once, reads it with four_axes, applies the dead zone to each axis, and
sets both tracks.

Hint 3: In configure: self.node = config.node and self.joy = Latest(Joy()). In control: axes =
four_axes(self.joy.get()); then left_x, left_y = (axis if abs(axis) > 0.3 else 0.0 for axis in axes[:2]); then
set self.track_l.ctrl and self.track_r.ctrl. In unconfigure: self.node.destroy_subscription(self.subscription).

Notice that control gets the message once and reads both axes from it, and that your code needs no lock.
"""

from collections.abc import Callable
from functools import partial
from itertools import count
from typing import Any

from sensor_msgs.msg import Joy

from tutorial.checks.bound import four_axes
from tutorial.checks.engine.cases import Case, Cases, Mistake, both, replace
from tutorial.checks.engine.interleave import early, interleave
from tutorial.checks.engine.rig import Rig
from tutorial.checks.engine.trial import Trial
from tutorial.checks.exercise import Exercise
from tutorial.checks.fire import over_ros
from tutorial.controller import ControllerConfig, ControllerIO, SimpleController
from tutorial.handoff import Latest


class GentleTank(SimpleController):
    """Drive the tracks with the left stick, gently."""

    def configure(self, config: ControllerConfig) -> None:
        """Listen to the joystick."""
        self.node = config.node
        self.joy = Latest(Joy())
        self.subscription = self.node.create_subscription(Joy, "joy", self.on_joy, 1)

    def on_joy(self, message: Joy) -> None:
        """Store the newest state of the joystick."""
        self.joy.put(message)

    def initialize(self, io: ControllerIO) -> None:
        """Look up the tracks of the simulated tank."""
        self.track_l = io.body.actuator("TRACK_L")
        self.track_r = io.body.actuator("TRACK_R")

    def control(self) -> None:
        """Convert the stick's position to track speeds [m/s]."""
        axes = four_axes(self.joy.get())
        left_x, left_y = (axis if abs(axis) > 0.3 else 0.0 for axis in axes[:2])
        self.track_l.ctrl = 1.0 * left_y - 0.5 * left_x
        self.track_r.ctrl = 1.0 * left_y + 0.5 * left_x

    def unconfigure(self) -> None:
        """Stop listening."""
        self.node.destroy_subscription(self.subscription)


MISTAKES = [
    Mistake("control never gets the message, or sets no speed. Call "
            "self.joy.get(), and set self.track_l.ctrl, not self.track_l.",
            replace("self.joy.put(message)", "pass")),
    Mistake("your code also moves the turret or the barrel. Set only the "
            "tracks. (TankController's control also sets the turret.)",
            both(replace("self.track_l =",
                         'self.turret, self.turned = io.body.actuator("TURRET_Y"), 0.0\nself.track_l ='),
                 replace("self.track_l.ctrl = 1",
                         "self.turned += axes[2]\nself.turret.ctrl = self.turned\nself.track_l.ctrl = 1",
                         "self.turret.ctrl = axes[2]\nself.track_l.ctrl = 1",
                         "self.turret.ctrl = 1.0\nself.track_l.ctrl = 1"))),
    Mistake("your code sets no speed or ignores messages while the stick is at rest, "
            "so the tank keeps its last speed. Set the speed to 0.",
            replace("self.track_l.ctrl = 1", "if not left_x and not left_y: return\nself.track_l.ctrl = 1")),
    Mistake("your code swaps left and right. If you push the stick to the left (left_x > 0), the left track has "
            "to run slower and the right track faster.",
            replace("0.5 * left_x", "-0.5 * left_x")),
    Mistake("your code swaps left_x and left_y. axes[0] is left_x (sideways), and axes[1] is left_y (forward).",
            replace("left_x, left_y =", "left_y, left_x =")),
    Mistake("your code reads an axis of the right stick. The left stick's axes are axes[0] and axes[1].",
            replace("axes[:2]", "axes[2:]", "axes[1:3]", "[axes[2], axes[1]]", "[axes[0], axes[3]]")),
    Mistake("your code uses TankController's speeds, 2 y - x and 2 y + x. "
            "GentleTank's tracks run half as fast: 1.0 * left_y and 0.5 * left_x.",
            both(replace("1.0 * left_y", "2.0 * left_y"), replace("0.5 * left_x", "1.0 * left_x"))),
    Mistake("your code has no dead zone. An axis counts as 0 if abs(axis) <= 0.3.", replace("> 0.3", "> -1")),
    Mistake("your dead zone has the wrong width. It has to be 0.3 for each axis (TankController's is 0.2).",
            replace("> 0.3", "> 0.03", "> 0.15", "> 0.2", "> 0.28", "> 0.32", "> 0.35", "> 0.45", "> 0.5")),
    Mistake("your code uses a single dead zone for both axes. Check each axis separately: abs(axis) > 0.3.",
            replace("abs(axis) > 0.3", "max(map(abs, axes[:2])) > 0.3", "min(map(abs, axes[:2])) > 0.3",
                    "abs(complex(*axes[:2])) > 0.3")),
    Mistake("your code subtracts the dead zone from the axis, or rescales the "
            "axis. Outside the dead zone, use the axis unchanged.",
            replace("(axis if", "(axis - 0.3 * axis / abs(axis) if", "((axis - 0.3 * axis / abs(axis)) / 0.7 if")),
]  # fmt: skip
MEANING = ("Compare your code with this: in every step, TRACK_L of io.body runs at 1.0 * left_y - 0.5 "
           "* left_x, TRACK_R at 1.0 * left_y + 0.5 * left_x, unclamped, and nothing else "
           "moves. Check each axis separately: it counts as 0 if abs(axis) <= 0.3.")  # fmt: skip
DRIVES, AHEAD = (0.5, -0.8, 0.7, -0.9), (0.0, 1.0, 0.7, -0.9)
STICKS = (
    *((0.0, 1.0), (0.0, -1.0), (1.0, 0.0), (-0.6, 0.8), (1.0, 1.0), (0.16, -0.1), (-0.16, 0.1), (0.02, 0.02)),
    *((0.25, 1.0), (0.25, 0.0), (0.5, -0.29), (-0.33, 0.0), (0.0, -0.31), (0.0, 0.4)),
)
WHOLE = (0.6, 0.5), (-0.4, -0.9), (0.0, 0.0)


def speeds(rig: Rig) -> str:
    """Describe the commanded speeds, and report any other commands."""
    left, right, *turret = (rig.body.actuator(name).ctrl for name in ("TRACK_L", "TRACK_R", "TURRET_Y", "TURRET_P"))
    more = ", and the turret or the barrel also moves" * any(turret)
    more += ", and the displayed copy also receives commands" * any(rig.displayed.data.ctrl)
    return f"left {left:+z.2f}, right {right:+z.2f} m/s{more}"


def played(trial: Trial, *script: Any, **options: Any) -> Rig:
    """Make a tank, and play a script: each item is a message's axes, a number of steps, or a method's name."""
    rig = Rig(trial, **options)
    rig.displayed.data.ctrl[:] = 0.0
    for each in script:
        if isinstance(each, str):
            rig.body.data.ctrl[:] = 0.0
            getattr(rig, each)()
        elif isinstance(each, int):
            with trial.clocks_stand(ahead=each):  # as if a step took a second
                rig.advance(each)
        else:
            rig.hear(Joy(axes=each))
    return rig


def after(*script: Any) -> Callable[[Trial], str]:
    """Observe the speeds after a script."""
    return lambda trial: speeds(played(trial, *script))


def second_step(trial: Trial) -> str:
    """Observe whether a second step without a new message commands the same speeds as the first step."""
    one, both = (after("start", DRIVES, steps)(trial) for steps in (1, 2))
    return "yes" if one == both else f"no, first {one}, then {both}"


def stepped(rig: Rig) -> str:
    """Observe the speeds after the first step."""
    rig.start()
    rig.advance(1)
    return speeds(rig)


def two(trial: Trial) -> str:
    """Observe two tanks at the same time, each with its own stick."""
    first, second = played(trial, "start"), played(trial, "start", name="Tank", time_step=0.002)
    first.hear(Joy(axes=DRIVES))
    second.hear(Joy(axes=AHEAD))
    for each in (second, first):
        each.advance(1)
    return f"{speeds(first)}; {speeds(second)}"


def halved(trial: Trial, in_callback: bool) -> str:
    """Observe whether a step uses only part of a message, with the callback and `control` interleaved in all orders."""
    rig, seen = played(trial, "start"), list[str]()
    first, second, _ = (partial(rig.hear, Joy(axes=axes)) for axes in WHOLE)

    def control() -> None:
        rig.advance(1)
        seen.append(speeds(rig))

    function, between = (second, control) if in_callback else (control, second)
    for turn in (None,) if in_callback else count():
        first()
        if not interleave(trial, function, between, turn):
            break
    whole = {after("start", axes, 1)(trial) for axes in WHOLE}
    return "a step uses only part of a message" if set(seen) - whole else "each step uses a whole message"


AT_REST = "Your code probably drops messages with centred sticks, so the tank keeps moving. Store every message."
MISSING = ("Your code probably expects every axis to be present, or drops messages with too few axes. Missing "
           "axes count as 0; four_axes(message) fills them in.")  # fmt: skip
NEWEST = ("Your code probably lets messages expire, or drops messages that arrive too "
          "close together. Use the newest message until the next one arrives.")  # fmt: skip
KEPT = "Your code probably creates self.joy in initialize, so the last message is lost. Create self.joy in configure."
CASES = [
    Case("the topic, in the namespace /lab", lambda trial: Rig(trial, namespace="/lab").node.on(Joy, "joy"),
         "Your code probably uses \"/joy\" or a different topic or type, or doesn't "
         'subscribe. In configure, call create_subscription(Joy, "joy", ...).'),
    Case("after a message, before the next step", after("start", DRIVES),
         "The callback probably sets the track speeds. Set them only in control, on the simulation's thread."),
    Case("before the first message", after("start", 1),
         "Your code probably assumes that a message has already arrived. "
         "Until the first message arrives, use an empty message: Latest(Joy()).",
         crashes=True),
    Case("the second step commands the same speeds", second_step,
         "Your code probably smooths the speeds, or uses a message in only one step. "
         "Set the full speeds immediately, and in every step."),
    *(Case(f"left_x {x:g}, left_y {y:g}", after("start", DRIVES, 1, (x, y, 0.7, -0.9), 1)) for x, y in STICKS),
    Case("all sticks at rest", after("start", DRIVES, 1, (0.0, 0.0, 0.0, 0.0), 1), AT_REST),
    Case("all sticks almost at rest", after("start", DRIVES, 1, (0.1, -0.1, 0.2, 0.1), 1), AT_REST),
    Case("a message with 2 axes", after("start", DRIVES, 1, (0.0, 1.0), 1), MISSING, crashes=True),
    Case("a message with 0 axes", after("start", DRIVES, 1, (), 1), MISSING, crashes=True),
    Case("a message with 1 axis", after("start", DRIVES, 1, (1.0,), 1), MISSING, crashes=True),
    Case("a message with 8 axes", after("start", DRIVES, 1, (1.0, -1.0, 0.7, -0.9, 0.1, 0.1, 0.3, 0.4), 1),
         "Your code probably requires a fixed number of axes. "
         "A message can have more than four: four_axes(message) returns the first four.",
         crashes=True),
    Case("300 steps without a message", after("start", DRIVES, 300), NEWEST),
    Case("four messages between two steps", after("start", DRIVES, AHEAD, DRIVES, AHEAD, 1),
         "Your code probably queues the messages, or uses the first message. "
         "Keep only the newest message: put each one into the same Latest."),
    Case("a message before the start", after(DRIVES, "start", 1), KEPT),
    Case("after a restart", after("start", DRIVES, 1, "stop", "start", 1), KEPT),
    Case("two tanks", two,
         "Your code probably stores the message on the class, so all tanks share it. Create self.joy in configure."),
    Case("control runs between the callback's instructions", lambda trial: halved(trial, True),
         "Your callback probably stores a message's axes one by one, "
         "and control runs in between. Put the whole message into self.joy."),
    Case("a message arrives between control's instructions", lambda trial: halved(trial, False),
         "Your control method probably reads self.joy twice, and a message "
         "arrives in between. Get the message once, and read both axes from it."),
    Case("a message arrives as soon as the subscription exists", early(Rig, Joy(axes=DRIVES))),
    Case("after unconfigure", lambda trial: Rig(trial).leave()),
]  # fmt: skip


def on_ros(trial: Trial) -> str:
    """Observe the speeds after a message from another node."""
    return over_ros(trial, Joy(axes=DRIVES), stepped)


drive = Exercise("drive", __doc__, Cases(GentleTank, CASES, MISTAKES, MEANING, clock=NEWEST, on_ros=on_ros))
