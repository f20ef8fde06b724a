"""The exercise `drive`: turn the left stick into the speeds of the tracks.

Write the controller `GentleTank`. It listens to the topic `joy` (type `Joy`), without a slash in front, so the topic
is in the namespace of the node. It drives only the tracks, the actuators `TRACK_L` and `TRACK_R`, from the left
stick: `axes[0]` is `left_x`, positive to the left, and `axes[1]` is `left_y`, positive ahead.

- The left track runs at `1.0 * left_y - 0.5 * left_x` [m/s], the right one at `1.0 * left_y + 0.5 * left_x`.
- An axis within 0.3 of the middle counts as 0; each axis for itself.
- A missing axis counts as 0. Before the first message, all axes count as 0.
- In `unconfigure`, when it leaves the body, the node destroys the subscription.

Mind the threads: the callback runs on the executor's, `control` on the simulation's.

Hint 1: Look at the two threads: the callback runs on the executor's, control on the simulation's. And look at what is
true before the first message, and when a message is shorter than you expect.

Hint 2: Let the callback put the message into a Latest, which configure makes with an empty Joy(), before it
subscribes. Let control take it from there once in every step, read it with four_axes, apply the dead zone to each
axis, and set both tracks every time.

Hint 3: In configure: self.node = config.node and self.joy = Latest(Joy()). In control: axes =
four_axes(self.joy.get()); then left_x, left_y = (axis if abs(axis) > 0.3 else 0.0 for axis in axes[:2]); then
self.track_l.ctrl and self.track_r.ctrl. In unconfigure: self.node.destroy_subscription(self.subscription).

Notice that control takes the message once and reads both axes from it, and that you need no lock of your own.
"""

from collections.abc import Callable
from functools import partial
from itertools import count
from typing import Any

from sensor_msgs.msg import Joy

from tutorial.checks.bound import four_axes
from tutorial.checks.exercise import Cases, Exercise, Rig, early, interleave, watch
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
        """Keep the newest state of the joystick."""
        self.joy.put(message)

    def initialize(self, io: ControllerIO) -> None:
        """Look up the tracks of the simulated tank."""
        self.track_l = io.body.actuator("TRACK_L")
        self.track_r = io.body.actuator("TRACK_R")

    def control(self) -> None:
        """Turn the stick into track speeds [m/s]."""
        axes = four_axes(self.joy.get())
        left_x, left_y = (axis if abs(axis) > 0.3 else 0.0 for axis in axes[:2])
        self.track_l.ctrl = 1.0 * left_y - 0.5 * left_x
        self.track_r.ctrl = 1.0 * left_y + 0.5 * left_x

    def unconfigure(self) -> None:
        """Stop listening."""
        self.node.destroy_subscription(self.subscription)


MISTAKES = """
control does not use self.joy.get(), or assigns self.track_l = ... in place of self.track_l.ctrl = ...
    self.joy.put(message) => pass

nothing is set at rest, or the message is dropped, so the last speed stays: set 0 then.
    self.track_l.ctrl = 1 => if not left_x and not left_y: return // self.track_l.ctrl = 1

left and right are exchanged: to the left, the left track slows down and the right one speeds up.
    0.5 * left_x => -0.5 * left_x

it reads the right stick, or one axis of it: the left one is axes[0] and axes[1].
    axes[:2] => axes[2:] => axes[1:3] => [axes[2], axes[1]] => [axes[0], axes[3]]

the dead zone is another, as that of TankController, which is 0.2, or is missing: here it is 0.3, for both axes.
    > 0.3 => > -1 => > 0.03 => > 0.15 => > 0.2 => > 0.28 => > 0.32 => > 0.35 => > 0.45 => > 0.5

the two axes share one dead zone: it holds for each axis for itself.
    abs(axis) > 0.3 => max(map(abs, axes[:2])) > 0.3 => min(map(abs, axes[:2])) > 0.3 => abs(complex(*axes[:2])) > 0.3

an axis is shifted, rescaled, squared or cubed, or only its sign counts: outside of the dead zone it counts as it is.
    (axis if => (axis - 0.3 * axis / abs(axis) if => ((axis - 0.3 * axis / abs(axis)) / 0.7 if => (axis * abs(axis) if
    => (axis**3 if => (axis / abs(axis) if

#
In every step, by the newest message, TRACK_L of io.body runs at 1.0 * left_y - 0.5 * left_x, TRACK_R at 1.0 * left_y +
0.5 * left_x, unlimited, and nothing else moves. An axis counts as 0 unless abs(axis) > 0.3, each for itself.

# the topic, in the namespace /lab
Most likely it is "/joy", another topic or another type, or configure lacks create_subscription(Joy, "joy", ...).

# a message, before the next step
Most likely the callback sets the tracks: only control may, on its thread.

# before the first message
# axes
Most likely a message or its axes are taken for granted, or one with few is dropped: what it lacks counts as 0.

# a second step does the same
Most likely the speeds are smoothed, or a message counts for one step only: set them at once, and at every step.

# all sticks
Most likely a message is dropped when the sticks rest, so the tank drives on: keep every message, the newest counts.

# 300 steps without a message
# four messages between two steps
Most likely messages wait in a queue, are dropped by time, or count for a while: the newest counts, until the next.

# a message that comes before the start
# after a restart
Most likely initialize throws away the newest message, or keeps another: make what keeps it in configure.

# two tanks
Most likely what is kept belongs to the class: make it in configure, self.joy = ...

# control between the callback's instructions
Most likely the callback keeps the message piece by piece, and control runs between two: keep it whole, in a Latest.

# a message between control's instructions
Most likely control looks twice, and a message comes in between: take it once, and read both axes from that.
"""
DRIVES, AHEAD = (0.5, -0.8, 0.7, -0.9), (0.0, 1.0, 0.7, -0.9)
STICKS = (
    *((0.0, 1.0), (0.0, -1.0), (1.0, 0.0), (-0.6, 0.8), (1.0, 1.0), (0.16, -0.1), (-0.16, 0.1), (0.02, 0.02)),
    *((0.25, 1.0), (0.25, 0.0), (0.5, -0.29), (-0.33, 0.0), (0.0, -0.31), (0.0, 0.4)),
)
MESSAGES = ((0.0, 1.0), (), (1.0,), (1.0, -1.0, 0.7, -0.9, 0.1, 0.1, 0.3, 0.4))
WHOLE = (0.6, 0.5), (-0.4, -0.9), (0.0, 0.0)


def speeds(rig: Rig) -> str:
    """Return what the tracks are commanded, in words, and whether something else is."""
    left, right, *turret = (rig.body.actuator(name).ctrl for name in ("TRACK_L", "TRACK_R", "TURRET_Y", "TURRET_P"))
    more = ", something else is moved" * any([*turret, *rig.displayed.data.ctrl])
    return f"the tracks run at {left:+z.2f} and {right:+z.2f} m/s{more}"


def played(answer: type, *script: Any, **options: Any) -> Rig:
    """Make a tank, and do with it: hear a message with these axes, go so many steps, call a method of this name."""
    rig = Rig(answer, **options)
    rig.displayed.data.ctrl[:] = 0.0
    for each in script:
        if isinstance(each, str):
            rig.body.data.ctrl[:] = 0.0
            getattr(rig, each)()
        elif isinstance(each, int):
            with watch.clocks_stand(ahead=each):  # as if a step took a second
                rig.advance(each)
        else:
            rig.hear(Joy(axes=each))
    return rig


def after(*script: Any) -> Callable[[type], str]:
    """Observe the speeds after that."""
    return lambda answer: speeds(played(answer, *script))


def stepped(rig: Rig) -> str:
    """Observe the speeds after the first step."""
    rig.start()
    rig.advance(1)
    return speeds(rig)


def two(answer: type) -> str:
    """Observe two tanks at the same time, each with a stick of its own."""
    first, second = played(answer, "start"), played(answer, "start", name="Tank", time_step=0.002)
    first.hear(Joy(axes=DRIVES))
    second.hear(Joy(axes=AHEAD))
    for each in (second, first):
        each.advance(1)
    return f"{speeds(first)}; {speeds(second)}"


def halved(answer: type, in_callback: bool) -> str:
    """Observe whether half of a message is used, in whatever order the callback and `control` run."""
    rig, seen = played(answer, "start"), list[str]()
    first, second, _ = (partial(rig.hear, Joy(axes=axes)) for axes in WHOLE)

    def control() -> None:
        rig.advance(1)
        seen.append(speeds(rig))

    function, between = (second, control) if in_callback else (control, second)
    for turn in (None,) if in_callback else count():
        first()
        if not interleave(function, between, turn):
            break
    whole = {after("start", axes, 1)(answer) for axes in WHOLE}
    return "half of it is used" if set(seen) - whole else "it is used as a whole, or not yet"


CASES = Cases(
    GentleTank,
    {
        "the topic, in the namespace /lab": lambda answer: Rig(answer, namespace="/lab").node.on(Joy, "joy"),
        "a message, before the next step": after("start", DRIVES),
        "before the first message": after("start", 1),
        "a second step does the same": lambda answer: len({after("start", DRIVES, n)(answer) for n in (1, 2)}) == 1,
        **{f"left_x {x:g}, left_y {y:g}": after("start", DRIVES, 1, (x, y, 0.7, -0.9), 1) for x, y in STICKS},
        "all sticks rest": after("start", DRIVES, 1, (0.0, 0.0, 0.0, 0.0), 1),
        "all sticks almost rest": after("start", DRIVES, 1, (0.1, -0.1, 0.2, 0.1), 1),
        **{f"a message with {len(axes)} axes": after("start", DRIVES, 1, axes, 1) for axes in MESSAGES},
        "300 steps without a message": after("start", DRIVES, 300),
        "four messages between two steps": after("start", DRIVES, AHEAD, DRIVES, AHEAD, 1),
        "a message that comes before the start": after(DRIVES, "start", 1),
        "after a restart": after("start", DRIVES, 1, "stop", "start", 1),
        "two tanks": two,
        "control between the callback's instructions": lambda answer: halved(answer, True),
        "a message between control's instructions": lambda answer: halved(answer, False),
        "a message as soon as there is a subscription": early(Rig, Joy(axes=DRIVES)),
        "after unconfigure": lambda answer: Rig(answer).leave(),
    },
    MISTAKES,
    str,
    crashes=["before the first message", " axes"],
    clock="300 steps without a message",
    on_ros=lambda answer: over_ros(answer, Joy(axes=DRIVES), stepped),
)
drive = Exercise("drive", __doc__, CASES)
