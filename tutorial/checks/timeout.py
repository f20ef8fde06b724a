"""The exercise `timeout`: recognize a command that is too old.

Write the class `CommandTimeout`. Its method `fresh(message, seconds)` is called once per step, with the newest message
and the simulated time [s]. It returns `True` if this message arrived at most 0.5 s ago, otherwise `False`.

- A new message arrives in each call that passes a different object from the previous call (`is not`), even if its axes
  have the same values: a joystick repeats the axes while its sticks are held still. In the first call, the message is
  new.
- Measure time only with `seconds`. A step can have any length, the message's stamp can be empty, and the computer's
  clock does not show simulated time.
- A new message is fresh, even after a stale message.

Hint 1: Each call gives you a message and the time. What do you have to store in earlier calls to know whether the
message is new, and how old it is?

Hint 2: Keep the newest message, and the time of its arrival. Compare the messages with `is not`, because `!=` compares
their contents.

Hint 3: if message is not self.message, set self.message, self.since = message, seconds. Then return whether seconds -
self.since is at most 0.5.

Notice that a robot whose joystick breaks, or whose network fails, now stops automatically.
"""

from itertools import cycle
from typing import Any

import numpy as np
from sensor_msgs.msg import Joy

from tutorial.checks.engine.cases import Case, Cases, Mistake, Run, both, replace
from tutorial.checks.engine.failure import Misuse
from tutorial.checks.engine.trial import Trial
from tutorial.checks.exercise import Exercise


class CommandTimeout:
    """Decide whether the newest command is fresh."""

    def __init__(self) -> None:
        self.message: Joy | None = None

    def fresh(self, message: Joy, seconds: float) -> bool:
        """Return whether the newest message arrived at most 0.5 s ago."""
        if message is not self.message:
            self.message = message
            self.since = seconds
        return seconds - self.since <= 0.5


MISTAKES = [
    Mistake("your code sets self.since too often, or its limit isn't 0.5 s. Set self.since only if message is not "
            "self.message; don't store a copy.",
            replace("return seconds - self.since <= 0.5", "return True")),
    Mistake("your code counts calls. A step can have any length: compute seconds - self.since.",
            both(replace("self.since = seconds", "self.since, self.calls = seconds, 0"),
                 replace("return seconds - self.since <= 0.5", "self.calls += 1\nreturn self.calls <= 500"))),
    Mistake("your code subtracts the message's stamp, which can be empty. "
            "Store the value of seconds in the first call with each new message.",
            replace("return seconds - self.since",
                    "return seconds - message.header.stamp.sec - message.header.stamp.nanosec / 1e9")),
    Mistake("your code compares the messages' contents. While a stick is held still, the "
            "messages are identical: compare the objects, with `is not`.",
            replace("message is not self.message", "message != self.message",
                    'message.axes != getattr(self.message, "axes", None)')),
    Mistake("your code stores only the time of the first message. Set self.since for every new message.",
            replace("if message is not self.message:", "if self.message is None:")),
    Mistake("once a message is too old, your code also rejects all later ones. "
            "A new message is fresh, even after a stale one.",
            both(replace("self.message: Joy | None = None", "self.message, self.old = None, False"),
                 replace("return seconds - self.since <= 0.5",
                         "self.old = self.old or seconds - self.since > 0.5\nreturn not self.old"))),
    Mistake("your code computes the age in whole seconds. Don't round seconds - self.since.",
            replace("return seconds - self.since", "return int(seconds - self.since)",
                    "return int(seconds) - int(self.since)")),
]  # fmt: skip
MEANING = ("Your code probably computes the age incorrectly. "
           "In each call, test whether seconds - self.since <= 0.5, without rounding.")  # fmt: skip
TRUTH = "Return True or False: return seconds - self.since <= 0.5."


def tried(calls: str, objects: int = 1) -> Run:
    """Observe the results of calls: ``"A 0, A 0.5"`` passes the message A at 0 s and again at 0.5 s.

    Args:
        calls: each letter stands for a message. ``a`` equals ``A``, but is a different object. ``C`` has no axes, and
            a stamp of 6 s. ``N`` is a new message in each call, and nothing else refers to it.
        objects: the number of objects that are called in turn.
    """

    def case(trial: Trial) -> list[bool]:
        messages = {letter: Joy(axes=[ord(letter.lower()) / 128]) for letter in "AaBC"}
        messages["C"].header.stamp.sec, messages["C"].axes = 6, []
        turns = cycle([trial.call(trial.answer) for _ in range(objects)])
        each_call = [*map(str.split, calls.split(","))]  # split first: a new string could reuse the last N's memory
        return [fresh(trial, next(turns), messages.get(each) or Joy(), float(at)) for each, at in each_call]

    return case


def fresh(trial: Trial, timeout: Any, message: Joy, seconds: float) -> bool:
    """Call the answer's `fresh`."""
    with trial.calling("fresh"):
        returned = timeout.fresh(message, seconds)
        if not isinstance(returned, (bool, np.bool_)):
            raise Misuse(f"it returns a {type(returned).__name__}", TRUTH)
        return bool(returned)


NEW = ", ".join(f"N {i / 4}" for i in range(40))
OFTEN = ", ".join(f"A {i / 4096}" for i in range(1000))
A_AT_3 = ("Your code probably misses a new message. Set self.since whenever "
          "the message is not the same object as in the previous call.")  # fmt: skip
CASES = [
    Case("one message, at 0, 0.25, 0.5 and 0.75 s", tried("A 0, A 0.25, A 0.5, A 0.75"),
         "Set self.since when the message is new, and only then. The first message is new, even at 0 s."),
    Case("one message, at 12, 12.44, 12.53, 14 and 14.25 s", tried("A 12, A 12.4375, A 12.53125, A 14, A 14.25"),
         "Your code probably doesn't set self.since in the first call. "
         "Store the value of seconds in the first call with each new message."),
    Case("message A at 3 and 4 s, B at 4.25, 4.5 and 5 s, C at 6 and 6.25 s",
         tried("A 3, A 4, B 4.25, B 4.5, B 5, C 6, C 6.25"), A_AT_3),
    Case("a stick held still, with an identical message every 0.25 s", tried("A 1, a 1.25, A 1.5, a 1.75, A 2"),
         "Your code probably compares the messages' contents, or looks for the "
         "message among all earlier ones. Compare each message with the previous one, using `is not`."),
    Case("message A at 1 s, B at 1.25, 1.625 and 2 s", tried("A 1, B 1.25, B 1.625, B 2"), A_AT_3),
    Case("40 new messages, each created after the previous one is deleted", lambda trial: [all(tried(NEW)(trial))],
         "Your code probably stores id(message), and a later message can get "
         "the same id. Store the message itself, and use `is not`."),
    Case("one message, 1000 calls in a quarter of a second", lambda trial: [all(tried(OFTEN)(trial))],
         "Your code probably counts calls. A step can have any length: compute seconds - self.since."),
    Case("two robots in turn, message A at 0 s, B at 0.25 s, A and B at 0.75 s",
         tried("A 0, B 0.25, A 0.75, B 0.75", objects=2)),
]  # fmt: skip


def describe(seen: list[bool]) -> str:
    """List the results."""
    return ", ".join(map(str, seen))


timeout = Exercise("timeout", __doc__, Cases(CommandTimeout, CASES, MISTAKES, MEANING, describe))
