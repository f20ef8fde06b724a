"""The exercise `pair`: match two messages from the same moment.

Write the class `Pairs`. It pairs messages with the same stamp from two topics. The viewer passes each message to the
method `add(stream, message)` on arrival; `stream` is `"joints"` or `"pose"`. As soon as both messages with the same
stamp have arrived, `add` returns them as `joints, pose`. All other calls return `None`.

- Either message can arrive first, and one topic can be ahead of the other. Each topic's messages arrive in the order of
  their stamps.
- When a pair is complete, drop all messages that arrived before the pair's first message: their partners would be too
  late. Messages that arrived later can still form pairs.
- At most 50 messages may wait. You may count them per topic or in total. If more are waiting, drop the one that
  *arrived* first.
- After the publisher restarts, its stamps start at 0 again. Pair the publisher's new messages immediately.

Hint 1: When a message arrives, you have to find the other topic's message with the same stamp. What do you have to
store, and under which key, to find that message directly?

Hint 2: Use a dict that maps each stamp to an inner dict, which maps each stream to its message. A dict keeps its keys
in insertion order, so the first key has waited longest. Delete keys from the beginning: all keys up to the stamp of a
complete pair, or one key if more than 50 are waiting.

Hint 3: stamp = message.header.stamp.sec, message.header.stamp.nanosec; together = self.waiting.setdefault(stamp, {});
together[stream] = message. If together now holds two messages, keep deleting the key next(iter(self.waiting)) while
stamp is in self.waiting, then return the two messages.

Notice that the order of arrival is enough to decide which messages to drop, even after a restart.
"""

from collections.abc import Callable, Iterable, Sequence
from itertools import cycle
from typing import Any

from geometry_msgs.msg import TransformStamped
from sensor_msgs.msg import JointState

from tutorial.checks.engine.cases import Case, Cases, Mistake, both, replace
from tutorial.checks.engine.failure import Misuse
from tutorial.checks.engine.trial import Trial
from tutorial.checks.exercise import Exercise


class Pairs:
    """Pair joint states and poses that have the same stamp."""

    def __init__(self) -> None:
        self.waiting: dict[tuple[int, int], dict[str, Any]] = {}

    def add(self, stream: str, message: Any) -> tuple[Any, Any] | None:
        """Add a message, and return the pair that it completes, if any."""
        stamp = message.header.stamp.sec, message.header.stamp.nanosec
        together = self.waiting.setdefault(stamp, {})
        together[stream] = message
        if len(together) == 2:
            while stamp in self.waiting:
                del self.waiting[next(iter(self.waiting))]
            return together["joints"], together["pose"]
        if len(self.waiting) > 50:
            del self.waiting[next(iter(self.waiting))]
        return None


MISTAKES = [
    Mistake("your code compares the stamps as objects, with `is` or id. "
            "Each message has its own stamp object: compare sec and nanosec.",
            replace("message.header.stamp.sec, message.header.stamp.nanosec", "id(message.header.stamp)")),
    Mistake("your code compares only sec, or only nanosec: a stamp consists of both.",
            replace("together =", "stamp = stamp[0]\ntogether =", "stamp = stamp[1]\ntogether =")),
    Mistake("your code drops all waiting messages when a pair is complete: "
            "drop only the messages that arrived before the pair's first message.",
            replace("while stamp in self.waiting:", "self.waiting.clear()\nwhile False:")),
    Mistake("your code doesn't drop the messages that arrived before the pair's first message. "
            "Drop them, even if their partners arrive later.",
            replace("while stamp in self.waiting:", "self.waiting.pop(stamp)\nwhile False:")),
    Mistake("your code returns two messages from the same topic as a pair: "
            "a pair consists of one message from each topic.",
            both(replace("together[stream] = message", "together[stream * (1 + (stream in together))] = message"),
                 replace('together["joints"], together["pose"]', "tuple(together[key] for key in sorted(together))"))),
    Mistake("your code drops a message too early. Look for the partner "
            "first, then drop a message if more than 50 are waiting.",
            replace("len(self.waiting) > 50", "len(self.waiting) >= 50")),
]  # fmt: skip
MEANING = ("Compare your steps with these: a message waits for the other topic's message with the same stamp. "
           "Either message can arrive first. "
           "When both have arrived, remove both, and return them as joints, pose.")  # fmt: skip
NO_PAIR = "Return the two messages themselves, as joints, pose, or None while one of them is missing."
AT_ONCE = "Return a pair when its second message arrives, and only once."

JOINTS, POSE = "joints", "pose"
Arrival = tuple[str, int]  # the stream and the stamp [ns]
MS, S = 10**6, 10**9  # [ns]
TODAY = 1_750_000_000 * S


def joints(*stamps: int) -> list[Arrival]:
    """Return the arrivals of joint states with these stamps [ms]."""
    return [(JOINTS, stamp * MS) for stamp in stamps]


def poses(*stamps: int) -> list[Arrival]:
    """Return the arrivals of poses with these stamps [ms]."""
    return [(POSE, stamp * MS) for stamp in stamps]


def in_turn(*stamps: int) -> list[Arrival]:
    """Return the arrivals of joint states and a pose, in this order, for each of these stamps [ms]."""
    return [arrival for stamp in stamps for arrival in (*joints(stamp), *poses(stamp))]


def message_of(stream: str, stamp: int) -> Any:
    """Make a message with a stamp [ns]."""
    message = JointState() if stream == JOINTS else TransformStamped()
    message.header.stamp.sec, message.header.stamp.nanosec = divmod(stamp, S)
    return message


def add(
    trial: Trial, pairs: Any, stream: str, message: Any, known: Iterable[tuple[Any, Arrival]]
) -> list[Arrival] | None:
    """Add a message, and return the arrivals of the pair that the answer returned, or None if it returned no pair.

    Raises:
        Failure: the answer raised an exception, or returned neither None nor a pair with this message.
    """
    with trial.calling("add"):
        returned = pairs.add(stream, message)
        if returned is None:
            return None
        those = returned if isinstance(returned, (tuple, list)) else ()
        pair = [arrival for one in those for each, arrival in known if each is one]
        if len(pair) != 2:
            raise Misuse(f"it returns a {type(returned).__name__}", NO_PAIR)
        if not any(one is message for one in those):
            raise Misuse("it returns a pair of earlier messages", AT_ONCE)
        return pair


def tried(*arrivals: Arrival, objects: int = 1) -> Callable[[Trial], list[Any]]:
    """Make a case that observes the result for each message, in order.

    Args:
        arrivals: the messages in the order of their arrival.
        objects: the number of objects that receive the messages in turn.
    """

    def case(trial: Trial) -> list[Any]:
        messages = [message_of(*arrival) for arrival in arrivals]
        known, those = list(zip(messages, arrivals)), cycle([trial.call(trial.answer) for _ in range(objects)])
        return [add(trial, pairs, stream, message, known) for pairs, (message, (stream, _)) in zip(those, known)]

    return case


STILL_WAITING = ("Your code probably keeps only one message per topic, or rejects messages with smaller stamps. "
                 "When a pair is complete, keep all messages that arrived after its first message.")  # fmt: skip
NANOSECONDS = ("Your code probably rounds the stamps, for example by converting them to floats, "
               "or treats nearly equal stamps as equal: compare them exactly.")  # fmt: skip
PAST = ("Your code probably drops too few or too many messages: when a pair is complete, "
        "drop all messages, on either topic, that arrived before its first message.")  # fmt: skip
NEW_START = ("Your code probably uses the stamps to find out which message is older. "
             "After a restart, stamps start at 0 again: use the order of arrival instead.")  # fmt: skip
FIFTY = ("Your code probably keeps fewer or more than 50 waiting messages, or drops the wrong message. "
         "If more than 50 are waiting, drop the message that arrived first.")  # fmt: skip
CASES = [
    Case("two objects, each with half of a pair", tried(*in_turn(20), objects=2),
         "Your code probably stores messages on the class, or in a parameter's default value: store them on self."),
    Case("in turn", tried(*in_turn(20, 40, 60))),
    Case("the pose first", tried(*poses(20), *joints(20), *poses(40), *joints(40)),
         "Your code probably expects the joint states first: either message "
         "can arrive first. Always return joints, pose, in this order."),
    Case("three joint states, then their poses", tried(*joints(20, 40, 60), *poses(20, 40, 60)), STILL_WAITING),
    Case("three poses, then their joint states", tried(*poses(20, 40, 60), *joints(20, 40, 60)), STILL_WAITING),
    Case("a pose is missing", tried(*in_turn(20), *joints(40), *in_turn(60))),
    Case("joint states are missing", tried(*in_turn(20), *poses(40, 60), *joints(60))),
    Case("equal nanosec, different sec", tried(*joints(1020), *poses(2020), *joints(2020)),
         "Your code probably compares only nanosec: a stamp consists of sec and nanosec."),
    Case("a nanosecond apart", tried((JOINTS, 20 * MS), (POSE, 20 * MS + 1), (JOINTS, 20 * MS + 1)), NANOSECONDS),
    Case("a nanosecond apart, with wall-clock stamps", tried((JOINTS, TODAY), (POSE, TODAY + 1), (JOINTS, TODAY + 1)),
         NANOSECONDS),
    Case("the same digits", tried((JOINTS, S + 23), (POSE, 12 * S + 3), (JOINTS, 3 * S + 12), (JOINTS, 12 * S + 3)),
         "Your code probably joins sec and nanosec as text, without leading zeros: compare both numbers."),
    Case("a partner that arrives too late", tried(*in_turn(20), *joints(40), *in_turn(60), *poses(40), *in_turn(80)),
         PAST),
    Case("poses that arrive too late", tried(*joints(20, 40, 60, 80), *poses(80, 20, 40, 60), *in_turn(100)), PAST),
    Case("joint states that arrive too late",
         tried(*in_turn(20), *poses(40), *in_turn(60), *joints(40), *in_turn(80)), PAST),
    Case("a late pose, after a pair whose pose came first",
         tried(*joints(40), *poses(60), *joints(60), *poses(40), *in_turn(80)), PAST),
    Case("late joint states, after a pair whose pose came first",
         tried(*poses(40, 60), *joints(60), *joints(40), *in_turn(80)), PAST),
    Case("a repeated pose", tried(*in_turn(20), *poses(20), *in_turn(40))),
    Case("the same joint states twice, then their pose", tried(*joints(20, 20), *poses(20))),
    Case("a restart from 0", tried(*in_turn(5000, 5020, 0, 20)), NEW_START),
    Case("joint states from before a restart", tried(*joints(5000), *in_turn(0, 20), *poses(5000)), NEW_START),
    Case("60 joint states, then the last 40 poses", tried(*joints(*range(0, 1200, 20)), *poses(*range(400, 1200, 20))),
         FIFTY),
    Case("50 joint states, then the pose for the first one", tried(*joints(*range(0, 1000, 20)), *poses(0)), FIFTY),
    Case("50 joint states, 1 s apart, then the pose for the first one",
         tried(*joints(*range(0, 50000, 1000)), *poses(0)), FIFTY),
    Case("51 joint states, then the pose for the first one", tried(*joints(*range(0, 1020, 20)), *poses(0)), FIFTY),
    Case("51 poses, then the joint states for the first one", tried(*poses(*range(0, 1020, 20)), *joints(0)), FIFTY),
    Case("200 joint states, then the pose for the first one", tried(*joints(*range(0, 4000, 20)), *poses(0)), FIFTY),
    Case("200 joint states, then a restart", tried(*joints(*range(9000, 13000, 20)), *in_turn(0, 20)), NEW_START),
]  # fmt: skip


def describe(returned: Sequence[Any]) -> str:
    """List the pairs' stamps, or only the first and the last if there are more than four pairs."""
    pairs = [_name(*pair) for pair in returned if pair]
    count, shown = len(pairs), ", ".join(pairs) if len(pairs) <= 4 else f"{pairs[0]} to {pairs[-1]}"
    return f"{count} pair{'s' * (count != 1)}: {shown}" if pairs else "no pair"


def _name(one: Arrival, other: Arrival) -> str:
    """Describe a pair by its stamp, and a wrong pair by the streams and stamps of both messages."""
    if (one[0], other[0]) == (JOINTS, POSE) and one[1] == other[1]:
        return _time(one[1])
    return " with ".join(f"{stream} of {_time(stamp)}" for stream, stamp in (one, other))


def _time(stamp: int) -> str:
    return f"{stamp // MS}" + f".{stamp % MS:06}" * (stamp % MS > 0) + " ms"


pair = Exercise("pair", __doc__, Cases(Pairs, CASES, MISTAKES, MEANING, describe))
