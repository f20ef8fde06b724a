"""The exercise `gaps`: find out where a stream in a bag was interrupted.

Write the function `find_gaps(messages)`. It takes a bag's messages on one topic as a list of pairs `(time_ns, message)`
in the order of receipt; each `message` is a `JointState`. It returns a list of events, in the same order:

- `("gap", before, after)` if a stamp is more than 0.1 s after the newest one so far;
- `("restart", before, after)` if a stamp is more than 1 s before the newest one so far. The publisher has restarted,
  and this stamp becomes the newest one.

`before` is the newest stamp so far and `after` is the message's stamp, both in whole nanoseconds. A message that is
only a little late, or repeats the newest stamp, is not an event. Report every event, even if it repeats an earlier
gap or restart. The list can be empty: never raise an exception, and don't change the list.

Hint 1: What do you compare each stamp with? Not with the previous stamp, which may have been late, but with the newest
stamp so far. And the bag's own times don't show when a message was created.

Hint 2: Keep the newest stamp in a variable that is None before the first message. With Time from
rclpy.time, Time.from_msg(stamp).nanoseconds is the stamp in whole nanoseconds. Then distinguish three cases: far ahead,
far behind, and everything else.

Hint 3: In the loop: if newest is None, newest = stamp. If stamp - newest > 100_000_000, append a gap; if
newest - stamp > 1_000_000_000, append a restart; in both cases, then set newest = stamp. In all other cases,
newest = max(newest, stamp).

Notice that you did not need the bag's own times, so a slow computer causes no false gaps.
"""

from collections.abc import Callable, Iterator, Sequence
from typing import Any

from rclpy.time import Time
from sensor_msgs.msg import JointState

from tutorial.checks.engine.cases import Case, Cases, Mistake, both, replace
from tutorial.checks.engine.failure import Misuse
from tutorial.checks.engine.trial import Trial
from tutorial.checks.exercise import Exercise


def find_gaps(messages: Sequence[tuple[int, JointState]]) -> list[tuple[str, int, int]]:
    """Return where a stream was interrupted, and where its publisher restarted."""
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


MISTAKES = [
    Mistake("your code sorts the messages. Sorting hides restarts: keep the bag's order.",
            replace("in messages:", "in sorted(messages, key=lambda pair: stamps_of([pair])):")),
    Mistake("your code compares each stamp with the previous one, which may be from "
            "a late message: compare each stamp with the newest one so far.",
            replace("newest = max(newest, stamp)", "newest = stamp")),
    Mistake("your code reports every jump backwards as a restart: "
            "a message whose stamp is at most 1 s older than the newest one is merely late.",
            replace("newest - stamp > 1_000_000_000", "newest - stamp > 0")),
    Mistake("your code computes seconds as floats, which are rounded: use whole nanoseconds everywhere.",
            both(replace("Time.from_msg(message.header.stamp).nanoseconds",
                         "Time.from_msg(message.header.stamp).nanoseconds / 1e9"),
                 replace("stamp - newest > 100_000_000", "stamp - newest > 0.1"),
                 replace("newest - stamp > 1_000_000_000", "newest - stamp > 1.0"))
            + both(replace("stamp - newest > 100_000_000", "stamp / 1e9 - newest / 1e9 > 0.1"),
                   replace("newest - stamp > 1_000_000_000", "newest / 1e9 - stamp / 1e9 > 1.0"))),
    Mistake("your code subtracts unsigned integers, which wrap around below 0: convert them with int(...) first.",
            both(replace("stamp - newest >", "(stamp - newest) % 2**64 >"),
                 replace("newest - stamp >", "(newest - stamp) % 2**64 >"))),
    Mistake("your code lists gaps and restarts separately: list them in the bag's order.",
            replace("return found", "return sorted(found, key=lambda each: each[0])",
                    "return sorted(found, key=lambda each: each[0], reverse=True)")),
    Mistake("your code skips a gap or restart that is identical to an earlier one: report it again.",
            replace("return found", "return [*dict.fromkeys(found)]")
            + replace('found.append(("restart"', '("restart", newest, stamp) in found or found.append(("restart"')),
    Mistake("after a restart, your code sets newest to 0 or leaves it unchanged: set it to the new message's stamp.",
            replace('"restart", newest, stamp))', '"restart", newest, stamp))\nstamp = 0',
                    '"restart", newest, stamp))\ncontinue')),
    Mistake("your code always returns an empty list: compare each stamp "
            "with the newest one so far, and don't hide errors with `try`.",
            replace("return found", "return []")),
    Mistake("your code uses only sec or only nanosec, which restarts at 0 every second: "
            "a stamp consists of sec and nanosec.",
            replace("Time.from_msg(message.header.stamp).nanoseconds", "message.header.stamp.nanosec",
                    "message.header.stamp.sec * 1_000_000_000")),
    Mistake("your code compares the bag's own times: compare the messages' stamps.",
            replace("Time.from_msg(message.header.stamp).nanoseconds", "_")),
]  # fmt: skip
MEANING = ("Compare your steps with these: newest is the newest stamp since the last restart, "
           'in nanoseconds. Compare each stamp with it, append ("gap", newest, stamp) or '
           '("restart", newest, stamp) where needed, and then update newest.')  # fmt: skip
A_LIST = 'Return a list of tuples such as ("gap", 1_200_000_000, 1_500_000_000), or [] if there are no events.'
WORDS = 'The only kinds of events are "gap" and "restart". Do not report late messages.'

HALF_A_LINE = 80  # characters
SINCE_1970 = 1_750_000_000  # [s]

Found = list[tuple[str | float, ...]]  # an event and its stamps [ns]; integers as strings, to preserve every digit


def recorded(*stamps: float, since: int = 0, every: float = 0.02) -> Iterator[tuple[int, JointState]]:
    """Make the messages of a bag.

    Args:
        stamps: the stamps of the messages [s].
        since: the time to add to all stamps [s].
        every: the time between receiving one message and receiving the next [s].
    """
    for i, stamp in enumerate(stamps):
        message = JointState(name=["TURRET_Y"], position=[0.1])
        message.header.stamp = Time(nanoseconds=since * 1_000_000_000 + round(stamp * 1e9)).to_msg()
        yield round((SINCE_1970 + i * every) * 1e9), message


def stamps_of(messages: Sequence[tuple[int, JointState]]) -> list[int]:
    """Return the stamps of messages [ns]."""
    return [Time.from_msg(message.header.stamp).nanoseconds for _, message in messages]


def bag(*stamps: float, **how: Any) -> Callable[[Trial], Found]:
    """Observe the result for a bag with these stamps [s].

    Args:
        stamps, how: as for `recorded`.
    """
    return lambda trial: trial.ask(list(recorded(*stamps, **how)), read=read, wanted=A_LIST)


def two(trial: Trial) -> Found:
    """Observe the results for two bags. The first result is read after the second call."""
    bags = (list(recorded(*stamps)) for stamps in ((1.0, 1.5), (2.0, 2.5)))
    both = [trial.ask(bag, read=lambda found: found, wanted=A_LIST) for bag in bags]
    return [each for found in both for each in read(found)]


def read(returned: Sequence[tuple[Any, ...]]) -> Found:
    """Convert a result to a comparable form.

    Raises:
        Misuse: the result contains something other than gaps and restarts.
    """
    if not {what for what, *_ in returned} <= {"gap", "restart"}:
        raise Misuse("it reports something other than a gap or a restart", WORDS)
    return [(what, *map(whole, stamps)) for what, *stamps in returned]


def whole(number: Any) -> str | float:
    """Return an exact whole number as text with all its digits, and any other number as a float."""
    is_exact = number % 1 == 0 and (not isinstance(number, float) or abs(number) < 2**53)
    return f"{int(number):_}" if is_exact else float(number)


A_GAP = ("Your code probably uses the wrong limit, or appends the wrong values. "
         "If a stamp is more than 100_000_000 ns ahead of newest, "
         'append ("gap", newest, stamp), in nanoseconds, and only then set newest = stamp.')  # fmt: skip
RECEIPT = f"Most likely {MISTAKES[-1].cause}"
BOTH_PARTS = ("Your code probably uses only sec or only nanosec, which restarts "
              "at 0 every second: a stamp consists of sec and nanosec.")  # fmt: skip
FRACTION = "Your code probably computes seconds as floats, which are rounded: use whole nanoseconds."
RESTART_FROM_0 = ("Your code probably uses the wrong limit for restarts: the first stamp after a restart is more "
                  "than 1_000_000_000 ns older than the newest one.")  # fmt: skip
NEWEST = ("Your code probably compares each stamp with the previous one, or reports every "
          "jump backwards as a restart: compare each stamp with the newest one so far.")  # fmt: skip
EXACTLY = ("Your code probably compares with >=, or compares floats, which are rounded. A stamp exactly 0.1 s "
           "ahead or exactly 1 s back is not an event: compare whole nanoseconds with >.")  # fmt: skip
CASES = [
    Case("20 ms apart", bag(1.0, 1.02, 1.04, 1.06, 1.08, 1.1, 1.12, 1.14),
         "This bag contains no events. Your code probably doesn't set newest to None before the first message, "
         "or uses limits in the wrong unit: 0.1 s is 100_000_000 ns."),
    Case("the bag's times are 3 s apart, and the stamps are 20 ms apart", bag(1.0, 1.02, 1.04, every=3.0), RECEIPT),
    Case("0.09 s without a message", bag(1.0, 1.02, 1.11, 1.13), A_GAP),
    Case("0.3 s without a message", bag(1.0, 1.02, 1.32, 1.34), A_GAP),
    Case("the bag's times are equal, and the stamps are 0.3 s apart", bag(1.0, 1.02, 1.32, 1.34, every=0.0), RECEIPT),
    Case("a gap across the start of a second", bag(2.9, 2.95, 3.08, 3.1), BOTH_PARTS),
    Case("the start of a second, without a gap", bag(2.96, 2.98, 3.0, 3.02), BOTH_PARTS),
    Case("stamps with a fraction of a millisecond", bag(1.000000137, 1.019999861, 1.290000449, 1.310000071), FRACTION),
    Case("a restart at 0 s", bag(3.96, 3.98, 0.0, 0.02), RESTART_FROM_0),
    Case("a late message without a gap", bag(1.0, 1.08, 1.02, 1.14, 1.16), NEWEST),
    Case("a late message after a gap", bag(1.0, 1.6, 1.1, 1.62), NEWEST),
    Case("a late message before a gap", bag(1.0, 1.02, 1.01, 1.14), NEWEST),
    Case("half a second late", bag(1.0, 1.02, 0.52, 1.04), RESTART_FROM_0),
    Case("a late message, then a restart", bag(5.0, 4.2, 3.9, 3.92), NEWEST),
    Case("equal stamps", bag(1.0, 1.0, 1.02, 1.02)),
    Case("exactly 0.1 s apart", bag(0.8, 0.9, 1.0, 1.1), EXACTLY),
    Case("a stamp exactly 1 s back", bag(2.0, 1.0, 2.02), EXACTLY),
    Case("a stamp 1 s and 1 ns back", bag(2.0, 0.999999999), RESTART_FROM_0),
    Case("a stamp 1.8 s back", bag(3.9, 2.1, 2.12), RESTART_FROM_0),
    Case("a gap after the stamp 0 s", bag(0.0, 0.5, 0.52),
         "Your code probably treats the stamp 0 as missing: test whether newest `is None`."),
    Case("a restart, then a gap", bag(3.98, 0.0, 0.02, 0.42, 0.44)),
    Case("two restarts", bag(3.98, 0.0, 2.0, 2.02, 0.5, 0.52)),
    Case("a restart at 50 s", bag(100.0, 100.02, 50.0, 50.02)),
    Case("the same restart and the same gap, each twice", bag(5.0, 0.0, 5.0, 0.0, 5.0)),
    Case("two gaps of equal length", bag(1.0, 1.2, 1.4)),
    Case("half a minute without a message", bag(1.0, 1.02, 31.02, 31.04)),
    Case("a robot's stamps, exactly 0.1 s apart", bag(0.826, 0.926, 0.946, since=SINCE_1970), FRACTION),
    Case("a robot's stamps, 0.1 s and 1 ns apart", bag(0.028000037, 0.128000038, since=SINCE_1970), FRACTION),
    Case("two bags, one after the other", two,
         "Your code probably reuses the same list in every call: make a new one in each call."),
    Case("no message", bag(), "Your code probably expects at least one message: return an empty list for an empty bag.",
         crashes=True),
    Case("a single message", bag(1.0)),
]  # fmt: skip


def describe(found: Found) -> str:
    """List as many events as fit into half a line, to leave room for the expected events."""
    said = [f"{what} {' to '.join(map(str, stamps))}" for what, *stamps in found]
    count = len(said)
    while count > 1 and len(", ".join(said[:count])) > HALF_A_LINE:
        count -= 1
    return ", ".join(said[:count]) + f" and {len(said) - count} more" * (count < len(said)) or "nothing"


gaps = Exercise(
    "gaps", __doc__, Cases(find_gaps, CASES, MISTAKES, MEANING, describe), imports=("from rclpy.time import Time",)
)
