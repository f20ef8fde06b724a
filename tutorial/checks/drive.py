"""The exercise `drive`: turn the left stick into the speeds of the tracks.

Write the controller `GentleTank`. It listens to the topic `joy` (type `Joy`), without a slash in front: so it is
in the namespace of the node. It drives only the tracks, the actuators `TRACK_L` and `TRACK_R`, from the left
stick: `axes[0]` is `left_x`, positive to the left, and `axes[1]` is `left_y`, positive ahead.

- The left track runs at `1.0 * left_y - 0.5 * left_x` [m/s], the right one at `1.0 * left_y + 0.5 * left_x`.
- An axis within 0.3 of the middle counts as 0; each axis for itself.
- An axis that the message lacks counts as 0, and so does everything before the first message.
- When it leaves the body it has the node destroy the subscription, in `unconfigure`.

Mind the threads: the callback runs on the executor's, `control` on the simulation's.

Hint 1: Look at the two threads: the callback runs on the executor's, control on the simulation's. And at what is true
before the first message, and when one is shorter than you expect.

Hint 2: Let the callback put the message into a Latest, which configure makes with an empty Joy(). Let control take it
from there once in every step, read it with four_axes, apply the dead zone to each axis, and set both tracks every time.

Hint 3: In configure: self.node = config.node and self.joy = Latest(Joy()). In control: axes =
four_axes(self.joy.get()); then left_x, left_y = (axis if abs(axis) > 0.3 else 0.0 for axis in axes[:2]); then
self.track_l.ctrl and self.track_r.ctrl. In unconfigure: self.node.destroy_subscription(self.subscription).

Notice that control takes the message once and reads both axes from it, and that no lock is to be seen.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from itertools import count
from typing import Any

from sensor_msgs.msg import Joy

from tutorial.body import Actuator, Body
from tutorial.checks._cases import Cases, mistakes
from tutorial.checks._interleave import interleave
from tutorial.checks._publishing import say
from tutorial.checks._rig import Rig
from tutorial.checks._watch import watch
from tutorial.checks.bound import four_axes
from tutorial.checks.exercise import Exercise
from tutorial.checks.fire import over_ros
from tutorial.controller import ControllerConfig, ControllerIO, SimpleController
from tutorial.handoff import Latest

__all__ = ["GentleTank", "drive"]


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


MISTAKES = mistakes("""
the stick is read once, in initialize: control has to look at every step, self.joy.get().
    self.track_l = io => self.once = self.joy.get() // self.track_l = io
    self.joy.get()) => self.once)

the tracks are those of config.body, the displayed copy: what is simulated is io.body.
    self.node = config.node => self.node, self.shown = config.node, config.body
    io.body. => self.shown.

control does not see what the callback keeps, self.joy.get(), or sets no self.track_l.ctrl and self.track_r.ctrl.
    self.joy.put(message) => pass

messages wait in a queue, one for each step: only the newest counts, until there is another one. Latest keeps it.
    self.node = config.node => self.node, self.queue = config.node, []
    self.joy.put(message) => self.queue.append(message)
    axes = => if self.queue: self.joy.put(self.queue.pop(0)) // axes =
    => self.joy.put(self.queue.pop(0) if self.queue else Joy()) // axes =

a message counts for one step only: the stick is where it was last seen, until there is another one. Latest keeps it.
    left_x, left_y = => self.joy.put(Joy()) // left_x, left_y =

a message with few axes is dropped, or counts as rest: only the axes that it lacks count as 0, the others as they are.
    self.joy.put(m => len(message.axes) > 0 and self.joy.put(m => len(message.axes) > 1 and self.joy.put(m
    => len(message.axes) > 3 and self.joy.put(m => len(message.axes) == 4 and self.joy.put(m
    => self.joy.put(Joy() if len(message.axes) < 2 else m

the speeds are limited to 1 m/s, which nobody asked for: in the corner it is 1.5 m/s.
    + 0.5 * left_x => + 0.5 * left_x // for t in (self.track_l, self.track_r): t.ctrl = min(max(t.ctrl, -1.0), 1.0)

both tracks have one formula: the left one has - 0.5 * left_x, the right one + 0.5 * left_x.
    + 0.5 * left_x => - 0.5 * left_x => + 0.5 * left_x // self.track_l.ctrl = self.track_r.ctrl

one track is forgotten: set the ctrl of TRACK_L and that of TRACK_R.
    + 0.5 * left_x => + 0.5 * left_x // self.track_l.ctrl = 0.0 => + 0.5 * left_x // self.track_r.ctrl = 0.0

nothing is set at rest, so the last speed stays: set 0 then.
    self.track_l.ctrl = 1 => if not left_x and not left_y: return // self.track_l.ctrl = 1

it reads the right stick: the left one is axes[0] and axes[1].
    axes[:2] => axes[2:]

the two axes are exchanged: axes[0] is x, to the left, axes[1] is y, ahead.
    left_x, left_y = => left_y, left_x =

the sign of left_y is wrong: forward is positive, for the stick and the tracks.
    1.0 * left_y => -1.0 * left_y

left and right are exchanged: to the left, the left track slows down and the right one speeds up.
    0.5 * left_x => -0.5 * left_x

left_x is left out, so the tank never turns: -0.5 * left_x and +0.5 * left_x.
    0.5 * left_x => 0.0 * left_x

the numbers are others, as those of TankController: here they are 1.0 * left_y and 0.5 * left_x.
    self.track_l.ctrl = 1 => left_x, left_y = 2 * left_x, 2 * left_y // self.track_l.ctrl = 1
    => left_x = 2 * left_x // self.track_l.ctrl = 1 => left_y = left_y / 2 // self.track_l.ctrl = 1
    => left_x, left_y = 2 * left_x, left_y / 2 // self.track_l.ctrl = 1

the dead zone is missing, or that of one axis: both axes count as 0 within 0.3 of the middle.
    self.track_l.ctrl = 1 => left_x, left_y, *_ = axes // self.track_l.ctrl = 1
    => left_x = axes[0] // self.track_l.ctrl = 1 => left_y = axes[1] // self.track_l.ctrl = 1

the dead zone is another, as that of TankController, which is 0.2: here it is 0.3.
    > 0.3 => > 0.03 => > 0.15 => > 0.2 => > 0.28 => > 0.32 => > 0.35 => > 0.45 => > 0.5

the dead zone is turned round, or not the same on both sides: an axis counts if abs(axis) > 0.3.
    abs(axis) > 0.3 => abs(axis) <= 0.3 => axis > 0.3 => not 0.0 <= axis <= 0.3

the two axes share one dead zone: it holds for each axis for itself.
    abs(axis) > 0.3 => max(map(abs, axes[:2])) > 0.3 => min(map(abs, axes[:2])) > 0.3 => abs(complex(*axes[:2])) > 0.3

an axis is shifted, rescaled, squared or cubed, or only its sign counts: outside of the dead zone it counts as it is.
    (axis if => (axis - 0.3 * axis / abs(axis) if => ((axis - 0.3 * axis / abs(axis)) / 0.7 if => (axis * abs(axis) if
    => (axis**3 if => (axis / abs(axis) if
""")
DRIVES, AHEAD = (0.5, -0.8, 0.7, -0.9), (0.0, 1.0, 0.7, -0.9)
MESSAGES = {
    "a message with 2 axes": (0.0, 1.0),
    "a message without axes": (),
    "a message with 1 axis": (1.0,),
    "a message with 8 axes": (1.0, -1.0, 0.7, -0.9, 0.1, 0.1, 0.3, 0.4),
}
AXES = "Most likely a number of axes is taken for granted: one that is lacking counts as 0, and more do not count."
KEPT = "the stick is where it was last seen, until there is another message. Latest keeps it."
TOPIC = (
    "Most likely it is another topic, as one with a slash in front or a body's name, or another type: it is "
    'config.node.create_subscription(Joy, "joy", self.on_joy, 1), in configure.'
)
OTHERWISE = {
    "": "Compare with left: 1.0 * left_y - 0.5 * left_x, right: 1.0 * left_y + 0.5 * left_x.",
    "the topic, in the namespace /lab": TOPIC,
    "a message, before the next step": "Most likely the callback sets the tracks: it runs on the executor's thread, "
    "and the simulated tank belongs to the simulation's. Only keep the message there, and set the tracks in control.",
    "before the first message": "Most likely a message, and its axes, are taken for granted: before the first one "
    "everything counts as 0, as four_axes reads an empty Joy().",
    "control leaves the actuators": "Most likely self.track_l = ... puts a number in the place of the actuator: "
    "it is self.track_l.ctrl = ..., the actuator takes the speed.",
    "a second step does the same": "Most likely the speeds are smoothed, step by step: set them at once.",
    **dict.fromkeys(MESSAGES, AXES),
    "300 steps without a message": f"Most likely a message counts for a while only: {KEPT}",
    "four messages between two steps": "Most likely messages are dropped, or wait in a row: only the newest counts.",
    **dict.fromkeys(
        ("a message that comes before the start", "after a restart"),
        "Most likely initialize throws away what has come before, or it keeps another: the newest message counts. "
        "Make what keeps it in configure, and only there.",
    ),
    "two tanks": "Most likely what is kept belongs to the class: make it in configure, self.joy = ...",
    "what else is commanded": "GentleTank drives only TRACK_L and TRACK_R.",
    "control between the callback's instructions": "Most likely the callback keeps the message piece by piece, so "
    "control can run between two pieces: keep it as a whole, in a Latest.",
    "a message between control's instructions": "Most likely control looks twice, and a message comes in between: take "
    "it once, and read both axes from that.",
}
BETWEEN = ("control between the callback's instructions", "a message between control's instructions")
STICKS = {
    "ahead": [(0.0, 1.0)],
    "back": [(0.0, -1.0)],
    "a turn to the left on the spot": [(1.0, 0.0)],
    "ahead and to the right": [(-0.6, 0.8)],
    "near the middle, at (0.16, -0.1), (-0.16, 0.1) and (0.02, 0.02)": [(0.16, -0.1), (-0.16, 0.1), (0.02, 0.02)],
    "0.25 to the left, and ahead or not": [(0.25, 1.0), (0.25, 0.0)],
    "ahead and to the left, in the corner": [(1.0, 1.0)],
    "0.33 to the right, 0.31 back, 0.4 ahead": [(-0.33, 0.0), (0.0, -0.31), (0.0, 0.4)],
    "0.29 back, and half to the left": [(0.5, -0.29)],
}


def speeds(body: Body) -> str:
    """Return what the tracks are commanded, in words."""
    left, right = (body.actuator(name).ctrl for name in ("TRACK_L", "TRACK_R"))
    return f"the tracks run at {left:+z.2f} and {right:+z.2f} m/s"


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
    return lambda answer: speeds(played(answer, *script).body)


def unmoved(answer: type) -> str:
    """Observe the speeds after a message, while `control` has not run yet."""
    rig = played(answer)
    rig.learner.initialize(rig.io)
    rig.hear(Joy(axes=DRIVES))
    return speeds(rig.body)


def stepped(rig: Rig) -> str:
    """Observe the speeds after the first step."""
    rig.start()
    rig.advance(1)
    return speeds(rig.body)


def at(*messages: tuple[float, ...]) -> Callable[[type], list[str]]:
    """Observe the speeds that messages with these axes lead to, each after one that drives."""
    return lambda answer: [after("start", DRIVES, 1, axes, 1)(answer) for axes in messages]


def left_alone(answer: type) -> bool:
    """Observe whether `control` leaves the learner's attributes that are actuators."""
    tanks = (played(answer, "start", steps).learner.inner for steps in (0, 1))
    before, now = (sum(isinstance(each, Actuator) for each in vars(tank).values()) for tank in tanks)
    return before == now


def others(answer: type) -> str:
    """Name what is commanded besides the tracks."""
    rig = played(answer, "start", DRIVES, 1)
    turret = [name for name in ("TURRET_Y", "TURRET_P") if rig.body.actuator(name).ctrl]
    return ", ".join(turret + ["the displayed tank"] * any(rig.displayed.data.ctrl)) or "nothing"


def two(answer: type) -> list[str]:
    """Observe two tanks at the same time, of which the first one's stick is moved."""
    first, second = played(answer, "start"), played(answer, "start", name="Tank", time_step=0.002)
    first.hear(Joy(axes=DRIVES))
    second.advance(1)
    first.advance(1)
    return [speeds(first.body), speeds(second.body)]


def halved(answer: type, in_callback: bool) -> str:
    """Observe whether half of a message is used, in whatever order the callback and `control` run."""
    rig, seen = played(answer, "start"), list[str]()

    def control() -> None:
        rig.advance(1)
        seen.append(speeds(rig.body))

    for axes in ((0.6, -0.9), (-0.4, 0.5), (0.6, 0.5), (-0.4, -0.9)):  # two that are mixed, and two that come
        rig.hear(Joy(axes=axes))
        control()
    mixed, seen = set(seen[:2]) - set(seen[2:]), []
    message, step = partial(rig.hear, Joy(axes=(-0.4, -0.9))), partial(rig.advance, 1)
    order = (message, control) if in_callback else (step, message)
    for turn in (None, None) if in_callback else count():  # Python 3.13 stops only in what was traced before
        rig.hear(Joy(axes=(0.6, 0.5)))
        if not interleave(*order, turn):
            break
        seen.append(speeds(rig.body))
    return "half of it is used" if mixed & set(seen) else "it is used as a whole, or not yet"


CASES = Cases(
    GentleTank,
    {
        "the topic, in the namespace /lab": lambda answer: Rig(answer, namespace="/lab").hears(Joy, "joy", TOPIC),
        "a message, before the next step": unmoved,
        "before the first message": after("start", 1),
        "control leaves the actuators": left_alone,
        "a second step does the same": lambda answer: len({after("start", DRIVES, n)(answer) for n in (1, 2)}) == 1,
        **{label: at(*((*stick, 0.7, -0.9) for stick in sticks)) for label, sticks in STICKS.items()},
        **{label: at(axes) for label, axes in MESSAGES.items()},
        "300 steps without a message": after("start", DRIVES, 300),
        "four messages between two steps": after("start", DRIVES, AHEAD, DRIVES, AHEAD, 1),
        "a message that comes before the start": after(DRIVES, "start", 1),
        "after a restart": after("start", DRIVES, 1, "stop", "start", 1),
        "two tanks": two,
        "what else is commanded": others,
        BETWEEN[0]: lambda answer: halved(answer, True),
        BETWEEN[1]: lambda answer: halved(answer, False),
        "after unconfigure": lambda answer: Rig(answer).leave(),
    },
    MISTAKES,
    say,
    OTHERWISE,
    {label: OTHERWISE[label] for label in ("before the first message", *MESSAGES, *BETWEEN)},
    clock=f"Most likely messages are dropped by time, or count for a while only: {KEPT}",
    on_ros=lambda answer: over_ros(answer, Joy(axes=DRIVES), stepped),
)

drive = Exercise("drive", __doc__, CASES.judge, GentleTank)
