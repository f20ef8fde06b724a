"""The exercise `fire`: report whether the joystick's first button is pressed.

Write the callback `on_joy` of `FireButton`. After each message, `self.fire` holds `True` if button 0 is pressed in this
message, otherwise `False`. Put the value into the `Latest` that `__init__` created.

- In `message.buttons`, 1 means pressed, and 0 means released.
- A missing button counts as not pressed.
- `FireButton` doesn't need `self.joy`, but your callback may also put the message into it.

Hint 1: Think of messages in which button 0 isn't pressed: it is released, or the message has no buttons. What does
self.fire have to hold after such messages?

Hint 2: message.buttons is a list, and it can be empty. Check its length before you read its first entry. Then put the
result into self.fire, whether it is True or False.

Hint 3: pressed = len(message.buttons) > 0 and ..., then self.fire.put(pressed).

Notice that the callback only stores a value and returns.
"""

from collections.abc import Callable
from typing import Any

import numpy as np
from sensor_msgs.msg import Joy

from tutorial.checks.engine.cases import Case, Cases, Mistake, both, replace
from tutorial.checks.engine.failure import Failure, Misuse
from tutorial.checks.engine.interleave import early
from tutorial.checks.engine.real_dds import ros_node, send
from tutorial.checks.engine.rig import Rig
from tutorial.checks.engine.trial import Trial
from tutorial.checks.exercise import Exercise
from tutorial.controller import ControllerConfig, SimpleController
from tutorial.handoff import Latest


class Listener(SimpleController):
    """Listen to the joystick, as in the notebook."""

    def configure(self, config: ControllerConfig) -> None:
        """Listen to the joystick."""
        self.node = config.node
        self.joy = Latest(Joy())
        self.subscription = self.node.create_subscription(Joy, "joy", self.on_joy, 1)

    def on_joy(self, message: Joy) -> None:
        """Store the newest state of the joystick."""
        self.joy.put(message)

    def unconfigure(self) -> None:
        """Stop listening."""
        self.node.destroy_subscription(self.subscription)


class FireButton(Listener):
    """Report whether the joystick's first button is pressed."""

    def __init__(self) -> None:
        self.fire = Latest(False)

    def on_joy(self, message: Joy) -> None:
        """Store the newest state of the button."""
        pressed = len(message.buttons) > 0 and message.buttons[0] == 1
        self.fire.put(pressed)


MISTAKES = [
    Mistake("your configure method doesn't subscribe, so no message arrives. "
            "Call super().configure(config) in it, or remove the method.",
            replace("def on_joy(self,", "def configure(self, config): self.node = config.node\ndef on_joy(self,",
                    "def configure(self, config): pass\ndef unconfigure(self): pass\ndef on_joy(self,")),
    Mistake("on_joy never puts True into self.fire. Put message.buttons[0] == 1 into it: "
            "a whole list never equals 1, and the number 1 is not the object True.",
            replace("== 1", "is True")),
    Mistake("your code doesn't put False into self.fire when the button is released, or ignores messages that arrive "
            "in quick succession. Put the button's state from every message into self.fire.",
            replace("self.fire.put(pressed)", "pressed and self.fire.put(True)")),
    Mistake("your code toggles the value each time the button is pressed, "
            "like a light switch. Put True into self.fire while the button is pressed.",
            both(replace("self.fire = Latest(False)", "self.down, self.fire = False, Latest(False)"),
                 replace("self.fire.put(pressed)",
                         "self.fire.put(self.fire.get() != (pressed and not self.down))\nself.down = pressed"))),
    Mistake("your code waits for a second message with the same state (debouncing). "
            "Put the button's state from each message into self.fire immediately.",
            both(replace("self.fire = Latest(False)", "self.was, self.fire = None, Latest(False)"),
                 replace("self.fire.put(pressed)",
                         "pressed == self.was and self.fire.put(pressed)\nself.was = pressed"))),
    Mistake("your code reads the previous message, which self.joy still holds. Read the message that on_joy gets.",
            both(replace("pressed = ", "buttons = self.joy.get().buttons\nself.joy.put(message)\npressed = "),
                 replace("len(message.buttons) > 0 and message.buttons[0]", "len(buttons) > 0 and buttons[0]"))),
]  # fmt: skip
MEANING = "Compare your condition with this one: the message has at least one button, and message.buttons[0] is 1."
NO_LATEST = ("Your code probably assigns to self.fire. Use the Latest "
             "that __init__ made: self.fire.put(...) replaces its value.")  # fmt: skip
NO_TRUTH = "Put True or False into self.fire. bool(...) converts any value to True or False."
NO_CLOCK = (
    "Your code reads the computer's clock, probably to ignore messages for a while (debouncing). "
    "Put the button's state from each message into self.fire immediately."
)


def held(rig: Rig, *states: tuple[int, ...]) -> bool:
    """Return the value of `fire` after messages with these buttons.

    In a message where only button 1 is pressed, a stick is also fully deflected.
    """
    tank = rig.learner
    before = getattr(tank, "fire", None)
    for buttons in states:
        rig.hear(Joy(axes=[float(buttons == (0, 1)), 0.0], buttons=buttons))
    latest = getattr(tank, "fire", None)
    if latest is not before or not isinstance(latest, Latest):
        raise Failure("on_joy", Misuse("self.fire is no longer the Latest that __init__ made", NO_LATEST), None)
    value = latest.get()
    if not np.isscalar(value) or value not in (0, 1):
        raise Failure("on_joy", Misuse(f"it puts a value of type {type(value).__name__}", NO_TRUTH), None)
    return bool(value)


def after(*states: tuple[int, ...]) -> Callable[[Trial], bool]:
    """Observe the value of `fire` after messages with these buttons."""
    return lambda trial: held(Rig(trial), *states)


def two(trial: Trial) -> list[bool]:
    """Observe two tanks after button 0 has been pressed on the first tank's joystick only."""
    first, second = Rig(trial), Rig(trial, name="Tank")
    return [held(first, (1,)), held(second)]


def over_ros(trial: Trial, message: Joy, look: Callable[[Rig], str]) -> str:
    """Observe the effect of a message that arrives through rclpy's own node."""
    with ros_node() as node:
        rig = Rig(trial, node=node)
        before = look(rig)
        send(node, "/joy", message, lambda: look(rig) != before)
        return look(rig)


BUTTON_0_IS_PRESSED = ("Your code probably reads the wrong button, or swaps True "
                       "and False. The first button is message.buttons[0].")  # fmt: skip
BUTTON_1_IS_PRESSED = ("Your code probably reads the wrong button, or all buttons. "
                       "Read only the first button: message.buttons[0].")  # fmt: skip
CASES = [
    Case("the topic", lambda trial: Rig(trial).node.on(Joy, "joy"),
         "Your configure method probably doesn't subscribe to "
         '"joy". Call super().configure(config) in it, or remove the method.'),
    Case("button 0 is pressed", after((1, 0)), BUTTON_0_IS_PRESSED),
    Case("button 0 is still pressed in a second message", after((1, 0), (1, 0)),
         "Your code probably puts True into self.fire only when the button goes down. "
         "Put True into it while the button is pressed."),
    Case("button 0 is released", after((1, 0), (0, 0)),
         "Your code probably doesn't put False into self.fire when the button is released, "
         "or ignores messages that arrive in quick succession."),
    Case("button 0 is pressed, after a message in which it is released", after((0, 0), (1, 0)), BUTTON_0_IS_PRESSED),
    Case("button 0 is pressed again", after((1, 0), (0, 0), (1, 0)), BUTTON_0_IS_PRESSED),
    Case("button 1 is pressed", after((0, 1)), BUTTON_1_IS_PRESSED),
    Case("both buttons are pressed", after((1, 1)), BUTTON_1_IS_PRESSED),
    Case("a message without buttons, after a message in which button 0 is pressed", after((1, 1), ()),
         "Your code probably reads message.buttons[0] without checking "
         "that it exists, or doesn't change self.fire. Put False into self.fire if there is no button.", crashes=True),
    Case("a message with a single button, which is pressed", after((1,)),
         "Your code probably requires more than one button. One is enough: len(message.buttons) > 0.", crashes=True),
    Case("two tanks, and button 0 is pressed on the first tank's joystick", two),
    Case("a message arrives as soon as the subscription exists", early(Rig, Joy(buttons=[1]))),
    Case("after unconfigure", lambda trial: Rig(trial).leave()),
]  # fmt: skip


def describe(seen: Any) -> str:
    """Describe the value of `fire`, for one tank or for two."""
    if isinstance(seen, list):
        return ", and ".join(map(describe, seen))
    return f"self.fire holds {seen}" if isinstance(seen, bool) else str(seen)


def on_ros(trial: Trial) -> str:
    """Observe the value of `fire` after a message has arrived through rclpy's own node."""
    return over_ros(trial, Joy(buttons=[1]), lambda rig: describe(held(rig)))


fire = Exercise(
    "fire",
    __doc__,
    Cases(FireButton, CASES, MISTAKES, MEANING, describe, clock=NO_CLOCK, on_ros=on_ros),
    parts=("on_joy",),
)
