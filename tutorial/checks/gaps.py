"""The exercise `gaps`: find in a bag where a stream was interrupted.

Write the function `find_gaps(messages)`. It takes a bag's messages of one topic, a list of pairs `(time_ns, message)`
in the order of receipt, each `message` a `JointState`. It returns a list of what happened, in the same order:

- `("gap", before, after)` if a stamp is more than 0.1 s after the newest one so far;
- `("restart", before, after)` if a stamp is more than 1 s before the newest one so far: the publisher has started
  again, and the newest stamp begins anew.

`before` is the newest stamp so far and `after` that of the message, both in whole nanoseconds. If a message is a
little late, or as old as the newest one, nothing has happened. The function never raises, and leaves the list as it
is.

Hint 1: Look at what you compare each message with: not with the one before it, which may have been late, but with the
newest stamp so far. And the bag's own times say nothing about when a message was made.

Hint 2: Keep the newest stamp in a variable, None before the first message. A stamp is whole nanoseconds:
Time.from_msg of rclpy.time makes them. Then there are three cases: far ahead, far back, and all others.

Hint 3: In the loop: with no newest one yet, newest = stamp. If stamp - newest > 100_000_000, append a gap; if newest
- stamp > 1_000_000_000, a restart; after either, newest = stamp. Else newest = max(newest, stamp).

Notice that you did not need the bag's own times: a slow computer is no gap.
"""

from collections.abc import Callable, Iterator, Sequence
from typing import Any

from rclpy.time import Time
from sensor_msgs.msg import JointState

from tutorial.checks.exercise import Cases, Exercise, Misuse, ask


def find_gaps(messages: Sequence[tuple[int, JointState]]) -> list[tuple[str, int, int]]:
    """Find where a stream was interrupted, and where its publisher was started again."""
    found = []
    newest = None
    for _, message in messages:
        stamp = Time.from_msg(message.header.stamp).nanoseconds
        if newest is None:
            newest = stamp
        elif stamp - newest > 100_000_000:
            found.append(("gap", newest, stamp))
            newest = stamp
        elif newest - stamp > 1_000_000_000:
            found.append(("restart", newest, stamp))
            newest = stamp
        else:
            newest = max(newest, stamp)
    return found


MISTAKES = """
the messages are sorted first: then no restart is seen. Take them as they come.
    in messages: => in sorted(messages, key=lambda pair: stamps_of([pair])):

after a restart newest becomes 0, or stays as it is: it is the stamp of the new message.
    "restart", newest, stamp)) => "restart", newest, stamp)) // stamp = 0 => "restart", newest, stamp)) // continue

nothing is told: compare the stamps with the newest so far, in nanoseconds, and let no `try` hide what goes wrong.
    return found => return []

#
Compare with: newest is the newest stamp since the last restart, in nanoseconds. Each stamp is compared with it; what
has happened is appended, in the bag's order, as ("gap", newest, stamp) or ("restart", newest, stamp); then it moves on.

# 20 ms apart
Nothing has happened: before the first message there is no newest stamp, and 20 ms are no gap; np.uint64 has no sign.

# a gap after 0 s
0 is a stamp like any other: ask whether newest `is None`.

# the bag
the bag's times are compared: they say when a message was received, not made.
    Time.from_msg(message.header.stamp).nanoseconds => _

# s without a message
If it is more than 100_000_000 ns, append ("gap", newest, stamp), in this order, in nanoseconds, before newest = stamp.

# full second
nanosec or sec is left out: a stamp is both together, and nanosec begins anew with every second.

# milliseconds
# robot's
Most likely seconds are computed as floating point numbers, which are rounded: count in whole nanoseconds.

# exactly
Exactly 0.1 s ahead, or exactly 1 s back, is nothing yet: ask with >, in whole nanoseconds, for floats are rounded.

# , from 0
# s back
# half a second late
The limit of a restart is another, or seconds are compared with seconds: it is more than 1_000_000_000 ns back.

# late
Most likely each stamp is compared with the last one, or any step back is a restart: compare it with the newest so far.

# no message
Most likely a bag without a message is not expected: return an empty list.

# two bags
Most likely the list is kept from call to call: make a new one in every call.
"""
A_LIST = 'Return a list of tuples such as ("gap", 1_200_000_000, 1_500_000_000), an empty one for nothing.'
WORDS = 'The words are "gap" and "restart". A late message says nothing.'

SINCE_1970 = 1_750_000_000  # [s]

Found = list[tuple[str | float, ...]]  # what happened, and the stamps [ns]: a text if whole, as no digit may be lost


def recorded(*stamps: float, since: int = 0, every: float = 0.02) -> Iterator[tuple[int, JointState]]:
    """Make what a bag holds.

    Args:
        stamps: of its messages [s].
        since: what is added to all stamps [s].
        every: how long after the one before a message was received [s].
    """
    for i, stamp in enumerate(stamps):
        message = JointState(name=["TURRET_Y"], position=[0.1])
        message.header.stamp = Time(nanoseconds=since * 1_000_000_000 + round(stamp * 1e9)).to_msg()
        yield round((SINCE_1970 + i * every) * 1e9), message


def stamps_of(messages: Sequence[tuple[int, JointState]]) -> list[int]:
    """Return when they were made [ns]."""
    return [Time.from_msg(message.header.stamp).nanoseconds for _, message in messages]


def bag(*stamps: float, **how: Any) -> Callable[[Any], Found]:
    """Observe what is found in a bag with these stamps [s], recorded in some way."""
    return lambda answer: ask(answer, list(recorded(*stamps, **how)), read=read, wanted=A_LIST)


def two(answer: Any) -> Found:
    """Observe what is found in two bags; what was found in the first is looked at after the second."""
    bags = (list(recorded(*stamps)) for stamps in ((1.0, 1.5), (2.0, 2.5)))
    both = [ask(answer, bag, read=lambda found: found, wanted=A_LIST) for bag in bags]
    return [each for found in both for each in read(found)]


def read(returned: Sequence[tuple[Any, ...]]) -> Found:
    """Return what was found in a form that can be compared."""
    if not {what for what, *_ in returned} <= {"gap", "restart"}:
        raise Misuse("it tells something else", WORDS)
    return [(what, *map(whole, stamps)) for what, *stamps in returned]


def whole(number: Any) -> str | float:
    """Return a whole number as a text, with all its digits; any other, or a float too large for them, as it is."""
    is_exact = number % 1 == 0 and (not isinstance(number, float) or abs(number) < 2**53)
    return f"{int(number):_}" if is_exact else float(number)


TRIED = {
    "20 ms apart": bag(1.0, 1.02, 1.04, 1.06, 1.08, 1.1, 1.12, 1.14),
    "the bag waits 3 s, the stamps do not": bag(1.0, 1.02, 1.04, every=3.0),
    "0.09 s without a message": bag(1.0, 1.02, 1.11, 1.13),
    "0.3 s without a message": bag(1.0, 1.02, 1.32, 1.34),
    "the bag receives all at once": bag(1.0, 1.02, 1.32, 1.34, every=0.0),
    "a gap across a full second": bag(2.9, 2.95, 3.08, 3.1),
    "a full second, and no gap": bag(2.96, 2.98, 3.0, 3.02),
    "stamps of no whole milliseconds": bag(1.000000137, 1.019999861, 1.290000449, 1.310000071),
    "started again, from 0": bag(3.96, 3.98, 0.0, 0.02),
    "late, and no gap": bag(1.0, 1.08, 1.02, 1.14, 1.16),
    "late after a gap": bag(1.0, 1.6, 1.1, 1.62),
    "late before a gap": bag(1.0, 1.02, 1.01, 1.14),
    "half a second late": bag(1.0, 1.02, 0.52, 1.04),
    "late, and later": bag(5.0, 4.2, 3.9, 3.92),
    "equal stamps": bag(1.0, 1.0, 1.02, 1.02),
    "exactly 0.1 s apart": bag(0.8, 0.9, 1.0, 1.1),
    "exactly 1 s back": bag(2.0, 1.0, 2.02),
    "1 s and 1 ns back": bag(2.0, 0.999999999),
    "1.8 s back": bag(3.9, 2.1, 2.12),
    "a gap after 0 s": bag(0.0, 0.5, 0.52),
    "started again, then a gap": bag(3.98, 0.0, 0.02, 0.42, 0.44),
    "started again twice": bag(3.98, 0.0, 2.0, 2.02, 0.5, 0.52),
    "started again, not from 0": bag(100.0, 100.02, 50.0, 50.02),
    "two gaps alike": bag(1.0, 1.2, 1.4),
    "half a minute without a message": bag(1.0, 1.02, 31.02, 31.04),
    "a robot's stamps, exactly 0.1 s apart": bag(0.826, 0.926, 0.946, since=SINCE_1970),
    "a robot's stamps, 0.1 s and 1 ns apart": bag(0.028000037, 0.128000038, since=SINCE_1970),
    "two bags, one after the other": two,
    "no message": bag(),
    "a single message": bag(1.0),
}


def say(found: Found) -> str:
    """Put what was found into words."""
    said = [" ".join(map(str, each)) for each in found]
    return ", ".join(said[:4]) + f" and {len(said) - 4} more" * (len(said) > 4) or "nothing"


CASES = Cases(find_gaps, TRIED, MISTAKES, say, ["no message"])
gaps = Exercise("gaps", __doc__, CASES, imports=("from rclpy.time import Time",))
