"""The exercise `timeout`: a command that is too old.

Write the class `CommandTimeout`. Each step calls its method `fresh(message, seconds)` once, with the newest message and
the simulated time [s]. It returns `True` if this message came at most 0.5 s ago, else `False`.

- A message comes at the first call with another object than before, also if its axes are the same: a held stick sends
  them again and again.
- Only `seconds` counts. The message's stamp may be empty, and the computer's clock knows nothing of simulated time.
- When the next message comes, it is fresh again.

Hint 1: Look at what you know in a call: the message and the time. What of the call before do you have to keep, to see
that a message is new, and how old it is?

Hint 2: Keep the newest message, and the time at which it came. Compare with `is not`: `!=` looks at what the messages
hold.

Hint 3: if message is not self.message, set self.message, self.since = message, seconds. Then return whether seconds -
self.since is at most 0.5.

Notice that a robot whose joystick breaks, or whose network fails, now stops by itself.
"""

from itertools import cycle
from typing import Any

import numpy as np
from sensor_msgs.msg import Joy

from tutorial.checks.exercise import Case, Cases, Exercise, Misuse, call, watch


class CommandTimeout:
    """Tells whether the newest command is fresh."""

    def __init__(self) -> None:
        self.message: Joy | None = None

    def fresh(self, message: Joy, seconds: float) -> bool:
        """Return whether the newest message came at most 0.5 s ago."""
        if message is not self.message:
            self.message = message
            self.since = seconds
        return seconds - self.since <= 0.5


MISTAKES = """
no message gets too old: keep the message itself, set self.since when it is new, and compare seconds - self.since.
    return seconds - self.since <= 0.5 => return True

#
Most likely the age is wrong: in every call it is seconds - self.since, not rounded, and at most 0.5.

# one message at 0
Compare with: self.since is set when the message is new, as the first one is, and only then; in every call compare
seconds - self.since with 0.5. 0 is a time like any other, and the message and its stamp say nothing.

# first at 12 s
Most likely the first message does not set the time, or the stamp does: keep the seconds of the call in which it is new.

# another message
# within half a second
Most likely not every new message sets the time, or none is fresh after an old one: each is, whatever it holds.

# is held
Most likely the contents are compared, or all earlier messages: compare with the last message, by `is not`.

# 40 new
Most likely id(message) is kept, and a later message may get the same one: keep the message itself, for `is not`.
"""
TRUTH = "Return True or False: return seconds - self.since <= 0.5."


def tried(calls: str, objects: int = 1) -> Case:
    """Observe what is returned in calls such as ``"A 0, A 0.5"``, with the message A at 0 s and at 0.5 s.

    Args:
        calls: one letter is one message; ``a`` is another than ``A``, but holds the same. ``C`` has a stamp, of 6 s,
            and no axes. ``N`` is a new message each time, which then nobody else holds.
        objects: how many objects are called in turns.
    """

    def case(answer: type) -> list[bool]:
        messages = {letter: Joy(axes=[ord(letter.lower()) / 128]) for letter in "AaBC"}
        messages["C"].header.stamp.sec, messages["C"].axes = 6, []
        turns = cycle([call(answer) for _ in range(objects)])
        each_call = [*map(str.split, calls.split(","))]  # at once, so that nothing gets N's place in memory
        return [fresh(next(turns), messages.get(each) or Joy(), float(at)) for each, at in each_call]

    return case


def fresh(timeout: Any, message: Joy, seconds: float) -> bool:
    """Ask the answer whether a message is fresh."""
    with watch.call("fresh"):
        returned = timeout.fresh(message, seconds)
        if not isinstance(returned, (bool, np.bool_)):
            raise Misuse(f"it returns a {type(returned).__name__}", TRUTH)
        return bool(returned)


NEW = ", ".join(f"N {i / 4}" for i in range(40))
TRIED = {
    "one message at 0, 0.25, 0.5 and 0.75 s": tried("A 0, A 0.25, A 0.5, A 0.75"),
    "one message, first at 12 s": tried("A 12, A 12.4375, A 12.53125, A 14, A 14.25"),
    "another message after a second, and again": tried("A 3, A 4, B 4.25, B 4.5, B 5, C 6, C 6.25"),
    "the stick is held, the same comes every 0.25 s": tried("A 1, a 1.25, A 1.5, a 1.75, A 2"),
    "two messages within half a second": tried("A 1, B 1.25, B 1.625, B 2"),
    "40 new messages, each when the one before is gone": lambda answer: [all(tried(NEW)(answer))],
    "two robots in turns": tried("A 0, B 0.25, A 0.75, B 0.75", objects=2),
}
timeout = Exercise("timeout", __doc__, Cases(CommandTimeout, TRIED, MISTAKES, str))
