"""Looking at an answer to `fire`: what its callback puts for each state of the buttons."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any

from sensor_msgs.msg import Joy

from tutorial.checks._explain import Mistake, Probe, judge_probes
from tutorial.checks._node import WatchedSubscription
from tutorial.checks._shared import SharedState
from tutorial.checks._topics import endpoint_on, judge_leaving
from tutorial.checks._verdict import Finding, judged, right, wrong
from tutorial.checks._watch import Failure
from tutorial.checks._world import World
from tutorial.controller import SimpleController
from tutorial.handoff import Latest

__all__ = ["judge_fire"]

STATES: dict[str, tuple[int, ...]] = {
    "button 0 is pressed": (1, 0),
    "it is released": (0, 0),
    "another button is pressed": (0, 1),
    "both are pressed": (1, 1),
    "a message without buttons": (),
    "a message with one button, pressed": (1,),
}
STICK_AT = "another button is pressed"
"""Where the message's first axis is 1, and not 0."""

MISTAKES = (
    Mistake("put", False, "nothing is put: self.fire.put(...), with True or False."),
    Mistake("source", "axes", "it looks at message.axes: the buttons are in message.buttons."),
    Mistake("source", "length", "it looks whether there are buttons, not whether buttons[0] is 1."),
    Mistake("button", 1, "it looks at the second button: the first one is buttons[0]."),
    Mistake("button", "any", "it looks at all buttons: only buttons[0] counts."),
    Mistake("button", "all", "all buttons have to be pressed: only buttons[0] counts."),
    Mistake("inverted", True, "True and False are exchanged."),
    Mistake("kept", "released", "nothing is put while the button is not pressed, so that it stays: put False then."),
    Mistake("kept", "lacking", "nothing is put if there are no buttons, so that the last one stays: put False then."),
)
OTHERWISE = "Compare with: whether there is a buttons[0], and it is 1."
NO_LATEST = "Most likely self.fire is assigned anew: what it holds is replaced by self.fire.put(...)."
SHARED = "Most likely fire belongs to the class, and so to all: self.fire is made in __init__, one for each."
NO_TRUTH = "Put whether the button is pressed: True or False."
NO_BUTTONS = "Most likely the code takes for granted that there are buttons: ask for len(message.buttons) first."


def judge_fire(answer: type[SimpleController]) -> Iterator[Finding]:
    """Look at an answer to `fire`."""
    shared = SharedState(answer)
    with World(answer) as world:
        call = "super().configure(config)"
        subscription = yield from endpoint_on(world.ros.node, WatchedSubscription, "/joy", Joy, call)
        if subscription is None:
            return
        publish = world.ros.publisher_to(subscription)
        seen: list[tuple[float, ...]] = []
        for label, buttons in STATES.items():
            try:
                publish(Joy(axes=[float(label == STICK_AT), 0.0, 0.0, 0.0], buttons=buttons))
            except Failure as failure:
                yield failure.finding(NO_BUTTONS if isinstance(failure.error, IndexError) else None, label)
                return
            held = _held(world.learner.inner)
            if isinstance(held, Finding):
                yield held
                return
            seen.append((float(held),))
        probes = [Probe(*each, _say) for each in zip(STATES, seen)]
        all_right = yield from judged(judge_probes(probes, predict, MISTAKES, OTHERWISE))
        if all_right:
            yield _judge_two(answer, world, subscription, shared)
        yield judge_leaving(answer, world.leave, subscription)


def _judge_two(
    answer: type[SimpleController], world: World, subscription: WatchedSubscription, shared: SharedState
) -> Finding:
    """Look whether what one controller hears stays its own."""
    with World(answer, name="Rover") as other:
        subscription.call_back(Joy(buttons=[1]))
        if (_held(world.learner.inner), _held(other.learner.inner)) == (True, False):
            return right("two tanks at the same time: each hears its own button")
    return wrong("two tanks at the same time: the button of one is heard by the other, too", shared.cause(SHARED))


def _held(learner: Any) -> bool | Finding:
    """Return what `fire` holds, or what is wrong with it."""
    fire = getattr(learner, "fire", None)
    if not isinstance(fire, Latest):
        return wrong(f"fire is a {type(fire).__name__}, no Latest", NO_LATEST)
    value = fire.get()
    if not isinstance(value, (bool, int)) or value not in (0, 1):
        return wrong(f"fire holds a {type(value).__name__}", NO_TRUTH)
    return bool(value)


def predict(
    put: bool = True, source: str = "buttons", button: int | str = 0, inverted: bool = False, kept: str = "nothing"
) -> Sequence[tuple[float, ...]]:
    """Compute what `fire` holds for `STATES`, right or with some mistakes."""
    fire, held = False, []
    for label, buttons in STATES.items():
        pressed = {
            "axes": label == STICK_AT,
            "length": bool(buttons),
            "buttons": {
                "any": any(buttons),
                "all": bool(buttons) and all(buttons),
                0: buttons[:1] == (1,),
                1: buttons[1:2] == (1,),
            }[button],
        }[source] != inverted
        keeps = {"nothing": False, "released": not pressed, "lacking": not buttons}[kept]
        fire = fire if keeps or not put else pressed
        held.append((float(fire),))
    return held


def _say(held: tuple[float, ...]) -> str:
    return str(bool(held[0]))
