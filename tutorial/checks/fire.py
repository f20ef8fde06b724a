"""The exercise `fire`: hear whether the joystick's first button is pressed.

Write the callback `on_joy` of `FireButton`: it puts `True` into `self.fire` if button 0 of the message is pressed,
else `False`. In `message.buttons` a pressed button is 1, else 0. If the message lacks button 0, it is not pressed.

Hint 1: Look at what you put, and when: something at every message, also when the button is released, and when there
are no buttons.

Hint 2: message.buttons is a list, which may be empty: ask for its len before its first entry.

Hint 3: pressed = len(message.buttons) > 0 and ..., and then self.fire.put(pressed).

Notice that the callback only leaves a value behind, and returns.
"""

from collections.abc import Callable

import numpy as np
from sensor_msgs.msg import Joy

from tutorial.checks.exercise import Cases, Exercise, Failure, Misuse, Rig, early, ros_node, send
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
        """Keep the newest state of the joystick."""
        self.joy.put(message)

    def unconfigure(self) -> None:
        """Stop listening."""
        self.node.destroy_subscription(self.subscription)


class FireButton(Listener):
    """Say whether the joystick's first button is pressed."""

    def __init__(self) -> None:
        self.fire = Latest(False)

    def on_joy(self, message: Joy) -> None:
        """Keep the newest state of the button."""
        pressed = len(message.buttons) > 0 and message.buttons[0] == 1
        self.fire.put(pressed)


MISTAKES = """
it never puts True: a slice or a list is compared, `is True` is asked, or put is not reached: message.buttons[0] == 1.
    == 1 => is True

#
Compare with: this message has buttons, whatever else there is, and its buttons[0] is 1.

# the topic
Most likely configure lacks what Listener's does: super().configure(config) listens to "joy".

# button 0 is pressed
Most likely another button is read, or True and False are exchanged: the first button is message.buttons[0].

# it is held
Most likely True is put only when the button goes down: it is True as long as the button is pressed.

# it is released
Most likely nothing is put while the button is not pressed, so that the last one stays: put False then.

# another button
# both
Most likely it looks at another button, or at all of them: only the first one counts, buttons[0].

# without buttons
Most likely nothing is put, so the last one stays, or buttons are taken for granted: put False if len is 0.

# one button
Most likely more buttons are asked for: one is enough, len(message.buttons) > 0, and buttons[0] counts.
"""
NO_LATEST = "Most likely self.fire is assigned anew: what it holds is replaced by self.fire.put(...)."
NO_TRUTH = "Put whether the button is pressed: True or False. bool(...) makes one of them of anything."


def held(rig: Rig, *states: tuple[int, ...]) -> bool:
    """Return what `fire` holds after messages with these buttons; one has a stick at its end, too."""
    tank = rig.learner
    before = getattr(tank, "fire", None)
    for buttons in states:
        rig.hear(Joy(axes=[float(buttons == (0, 1)), 0.0], buttons=buttons))
    latest = getattr(tank, "fire", None)
    if latest is not before or not isinstance(latest, Latest):
        raise Failure("on_joy", Misuse("self.fire is not the Latest that it was", NO_LATEST), None)
    value = latest.get()
    if not np.isscalar(value) or value not in (0, 1):
        raise Failure("on_joy", Misuse(f"what it puts is of the type {type(value).__name__}", NO_TRUTH), None)
    return bool(value)


def after(*states: tuple[int, ...]) -> Callable[[type[SimpleController]], bool]:
    """Observe what `fire` holds after messages with these buttons."""
    return lambda answer: held(Rig(answer), *states)


def two(answer: type[SimpleController]) -> list[bool]:
    """Observe what two tanks hold, of which the first one has heard its button."""
    first, second = Rig(answer), Rig(answer, name="Tank")
    return [held(first, (1,)), held(second)]


def over_ros(answer: type[SimpleController], message: Joy, look: Callable[[Rig], str]) -> str:
    """Observe something after a message from another node, with rclpy's own node."""
    with ros_node() as node:
        rig = Rig(answer, node=node)
        before = look(rig)
        send(node, "/joy", message, lambda: look(rig) != before)
        return look(rig)


TRIED = {
    "the topic": lambda answer: Rig(answer).node.on(Joy, "joy"),
    "button 0 is pressed": after((1, 0)),
    "it is held": after((1, 0), (1, 0)),
    "it is released": after((1, 0), (0, 0)),
    "another button is pressed": after((0, 1)),
    "both are pressed": after((1, 1)),
    "a message without buttons": after((1, 1), ()),
    "a message with one button, pressed": after((1,)),
    "two tanks at the same time, and the button of the first one is pressed": two,
    "a message as soon as there is a subscription": early(Rig, Joy(buttons=[1])),
    "after unconfigure": lambda answer: Rig(answer).leave(),
}


def on_ros(answer: type[SimpleController]) -> str:
    """Observe what `fire` holds after a message from another node."""
    return over_ros(answer, Joy(buttons=[1]), lambda rig: str(held(rig)))


CASES = Cases(FireButton, TRIED, MISTAKES, str, crashes=["without buttons", "one button"], on_ros=on_ros)
fire = Exercise("fire", __doc__, CASES, parts=("on_joy",))
