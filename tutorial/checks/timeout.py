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
what the messages hold is compared: a stick that is held sends the same again. Compare with `is not`.
    message is not self.message => message != self.message

id(message) is kept, and a later message may get the same one: keep the message itself, and compare with `is not`.
    message is not self.message => id(message) != self.message
    self.message = message => self.message = id(message)

the stamp is compared: a message that somebody sends by hand has none. Compare the objects with `is not`.
    message is not self.message => self.message is None or message.header.stamp != self.message.header.stamp

the stamp is taken for the time at which it came: a message by hand has none. Keep the seconds of the first call.
    seconds - self.since => seconds - message.header.stamp.sec

no message gets too old: keep the message itself, set self.since when it is new, and compare seconds - self.since.
    return seconds - self.since <= 0.5 => return True
    => age, self.since = seconds - self.since, seconds // return age <= 0.5

a message is fresh only in the call in which it comes: keep the time, in seconds, and let it get half a second old.
    return => new = seconds == self.since // return new and

not every new message sets the time: the first one does, and each later one, however late it comes.
    self.since = seconds => self.since = self.__dict__.get("since", seconds)
    => self.since = seconds * ("since" in self.__dict__) => self.since = seconds if "since" in self.__dict__ else -1.0
    => self.since = seconds if seconds - self.__dict__.setdefault("since", 0.0) <= 0.5 else self.since

the answer is made only when a message comes: work out in every call how old it is.
    self.message = message => self.fits = self.message is None or seconds - self.since <= 0.5 // self.message = message
    return seconds - self.since <= 0.5 => return self.fits

a message without axes is left out: somebody has sent it, too.
    return => return bool(message.axes) and

once a message was too old, none is fresh any more: the next one is.
    return => self.dead = self.__dict__.get("dead", False) or seconds - self.since > 0.5 // return not self.dead and

a message that was too old is forgotten, and taken for a new one in the next call: keep it.
    return => self.message = message if seconds - self.since <= 0.5 else None // return

a time of 0 is taken for none, as in `if not self.since`: ask whether it `is None`.
    message is not self.message => message is not self.message or not self.since

#
Most likely the age is wrong: in every call it is seconds - self.since, not rounded, and at most 0.5.

# first at 12 s
Most likely the first message does not set the time, or the stamp does: keep the seconds of the call in which it is new.

# another message
# within half a second
Most likely not every new message sets the time: each does, however soon or late it comes.

# is held
Most likely the contents are compared, or all earlier messages: compare with the last message, by `is not`.
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
