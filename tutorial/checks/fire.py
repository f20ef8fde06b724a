"""The exercise `fire`: hear whether the joystick's first button is pressed."""

from __future__ import annotations

from collections.abc import Callable
from contextlib import closing
from functools import cache
from typing import Any

import numpy as np
from rclpy.logging import get_logger
from sensor_msgs.msg import Joy

from tutorial.body import Body
from tutorial.checks._cases import Cases, mistakes
from tutorial.checks._diagnose import Misuse
from tutorial.checks._node import CheckThread, WatchedSubscription
from tutorial.checks._topics import endpoint
from tutorial.checks._watch import Failure
from tutorial.checks._world import MODELS, Watched
from tutorial.checks.exercise import Exercise
from tutorial.controller import ControllerConfig, SimpleController
from tutorial.handoff import Latest
from tutorial.world import Placement

__all__ = ["FireButton", "Listener", "fire"]


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


MISTAKES = mistakes("""
nothing is put, or always False: on_joy calls self.fire.put(...), with True if the button is pressed, else False.
    self.fire.put(pressed) => pass

it looks at message.axes: the buttons are in message.buttons.
    message.buttons => message.axes

it looks whether there are buttons, not whether buttons[0] is 1.
    self.fire.put => pressed = len(message.buttons) > 0 // self.fire.put

it looks at the second button: the first one is buttons[0].
    message.buttons[0] => sum(message.buttons[1:2])

it looks at the last button: the first one is buttons[0].
    message.buttons[0] => message.buttons[-1]

it looks at all buttons: only buttons[0] counts.
    self.fire.put => pressed = any(message.buttons) // self.fire.put

all buttons have to be pressed: only buttons[0] counts.
    > 0 => > 0 and all(message.buttons)

True and False are exchanged.
    self.fire.put => pressed = not pressed // self.fire.put

True and False are exchanged.
    == 1 => != 1

nothing is put while the button is not pressed, so that it stays: put False then.
    self.fire.put => if pressed: self.fire.put

nothing is put if there are no buttons, so that the last one stays: put False then.
    pressed = => if not message.buttons: return // pressed =

True is put only when the button goes down: it counts as long as it is pressed.
    self.fire.put => pressed = pressed and not self.fire.get() // self.fire.put

the button turns it on and off: it is True as long as the button is pressed, else False.
    self.fire.put => pressed = pressed != self.fire.get() // self.fire.put

the node still has the subscription: unconfigure calls self.node.destroy_subscription(self.subscription), as
Listener's does; a flag, None or subscription.destroy() do not tell the node.
    def on_joy => def unconfigure(self): pass // def on_joy
""")
LISTEN = 'Most likely configure does not do what Listener\'s does: super().configure(config) listens to "joy".'
NO_LATEST = "Most likely self.fire is assigned anew: what it holds is replaced by self.fire.put(...)."
NO_TRUTH = "Put whether the button is pressed: True or False. bool(...) makes one of them of anything."
OTHERWISE = {"": "Compare with: whether there is a buttons[0], and it is 1."}
CRASHES = {
    "a message without buttons": "Most likely the code takes for granted that there are buttons: ask for "
    "len(message.buttons) first.",
    "a message with one button, pressed": "Most likely more buttons are taken for granted than there are: only "
    "buttons[0] counts.",
}


class MemoryNode:
    """As much of a node as a listener uses, without ROS 2.

    What a node has not begins with an underscore, so that no learner is told of it.
    """

    def __init__(self) -> None:
        self._taps: list[Any] = []

    def create_subscription(self, msg_type: type, topic: str, callback: Any, qos_profile: Any) -> Any:  # noqa: ARG002
        """Create a subscription."""
        self._taps.append(WatchedSubscription(self, msg_type, f"/{topic.lstrip('/')}", callback))
        self._taps[-1].destroy = lambda: None
        return self._taps[-1]

    def destroy_subscription(self, subscription: Any) -> None:
        """Destroy a subscription, if it is one."""
        self._taps = [tap for tap in self._taps if tap is not subscription]

    def get_logger(self) -> Any:
        """Return a logger."""
        return get_logger("tank")

    def watched(self, _kind: type) -> list[Any]:
        """Return the subscriptions that are not destroyed."""
        return self._taps


class Tank(Watched):
    """A tank that an answer has joined.

    Args:
        answer: the learner's class.
        node: what it is given for a node.
        name: the tank's.
    """

    def __init__(self, answer: type[SimpleController], node: Any, name: str = "Tank") -> None:
        super().__init__(answer)
        self.node = node
        self.configure(ControllerConfig(_body(name), node, _drop, _drop))
        self.latest = getattr(self.inner, "fire", None)

    @property
    def subscription(self) -> WatchedSubscription:
        """What it hears the joystick with."""
        found = endpoint(self.node, WatchedSubscription, "/joy", Joy)
        if found is None:
            raise Failure("configure", Misuse("it does not listen to /joy, of the type Joy", LISTEN), None)
        return found

    @property
    def fire(self) -> bool:
        """What the answer's `fire` holds."""
        now = getattr(self.inner, "fire", None)
        if now is not self.latest or not isinstance(now, Latest):
            raise Failure("on_joy", Misuse("self.fire is not the Latest that it was", NO_LATEST), None)
        value = now.get()
        if not np.isscalar(value) or value not in (0, 1):
            raise Failure("on_joy", Misuse(f"what it puts is of the type {type(value).__name__}", NO_TRUTH), None)
        return bool(value)


@cache
def _body(name: str) -> Body:
    return Body.displayed(Placement(name, MODELS / "tank.xml"))


def _drop(*_: object) -> None:
    pass


def after(*states: tuple[int, ...]) -> Callable[[type[SimpleController]], bool]:
    """Observe what `fire` holds after messages with these buttons; one has a stick at its end, too."""

    def observe(answer: type[SimpleController]) -> bool:
        tank = Tank(answer, MemoryNode())
        for buttons in states:
            tank.subscription.call_back(Joy(axes=[float(buttons == (0, 1)), 0.0], buttons=buttons))
        return tank.fire

    return observe


def two(answer: type[SimpleController]) -> list[bool]:
    """Observe what two tanks hold, of which the first one has heard its button."""
    first, second = Tank(answer, MemoryNode()), Tank(answer, MemoryNode(), "Rover")
    first.subscription.call_back(Joy(axes=[0.0], buttons=[1]))
    return [first.fire, second.fire]


def leaves(answer: type[SimpleController]) -> str:
    """Observe what is left after `unconfigure`."""
    tank = Tank(answer, MemoryNode())
    tank.unconfigure()
    return "it still listens" if tank.node.watched(WatchedSubscription) else "it does not listen any more"


def over_ros(answer: type[SimpleController]) -> bool:
    """Observe what `fire` holds after a message from another node."""
    with closing(CheckThread()) as ros:
        tank = Tank(answer, ros.node)
        ros.publisher_to(tank.subscription)(Joy(axes=[0.0], buttons=[1]))
        return tank.fire


TRIED = {
    "button 0 is pressed": after((1, 0)),
    "it is held": after((1, 0), (1, 0)),
    "it is released": after((1, 0), (0, 0)),
    "another button is pressed": after((0, 1)),
    "both are pressed": after((1, 1)),
    "a message without buttons": after((1, 1), ()),
    "a message with one button, pressed": after((1,)),
    "two tanks at the same time, and the button of the first one is pressed": two,
    "after unconfigure": leaves,
    "a message from another node, the button pressed": over_ros,
}

CASES = Cases(FireButton, TRIED, MISTAKES, str, OTHERWISE, CRASHES)

fire = Exercise(
    name="fire",
    statement="""
    Write the callback `on_joy` of `FireButton`: it puts `True` into `self.fire` if button 0 of the message is pressed,
    else `False`. In `message.buttons` a button that is pressed is 1, else 0; one that the message lacks is not pressed.
    """,
    judge=CASES.judge,
    solution=(FireButton,),
    base=SimpleController,
    parts=("on_joy",),
    hints=(
        "Look at what is put, and when: something at every message, also when the button is released, and when there "
        "are no buttons.",
        "message.buttons is a list, which may be empty: ask for its len before its first entry.",
        "pressed = len(message.buttons) > 0 and ..., and then self.fire.put(pressed).",
    ),
    notice="Notice that the callback only leaves a value behind, and returns.",
)
