"""The exercise `pair`: two messages of one moment.

Write the class `Pairs`, which brings together two topics' messages of one moment. The viewer calls its method
`add(stream, message)` for each message as it comes; `stream` is `"joints"` or `"pose"`. It returns the two messages
that have the same stamp, `joints, pose`, as soon as both are there, and otherwise `None`.

- Either of them may come first, and one topic may be ahead of the other. Each topic comes in the order of its stamps.
- When a pair is complete, everything that came before its first message is past: drop it, its partner would come too
  late. Everything that came after that message may still find its partner.
- Up to 50 messages wait, of each topic or of both together, as you like. If there are more, drop the one that *came*
  first.
- A publisher that starts again begins at 0. Pair its messages at once.

Hint 1: Look at what you have to find when a message comes: the one of the other stream that has the same stamp. What
would you have to keep, and by which key, to find it at once?

Hint 2: Keep a dict from stamps to the messages of that stamp, by stream. A dict remembers in which order its keys
came, so its first key is the one that has waited longest: drop from there, up to the stamp of a pair, or when there
are more than 50.

Hint 3: The stamp is message.header.stamp.sec, message.header.stamp.nanosec. together: self.waiting.setdefault(stamp,
{}), with together[stream] set to the message. If it has two, delete next(iter(self.waiting)) as long as the stamp is
in there, and return both.

Notice that the order of arrival is enough to know what is past, also after a new start.
"""

from collections.abc import Callable, Iterable, Sequence
from itertools import cycle
from typing import Any

from geometry_msgs.msg import TransformStamped
from sensor_msgs.msg import JointState

from tutorial.checks.exercise import Cases, Exercise, Misuse, call, watch


class Pairs:
    """Finds the joint states and the pose of one stamp."""

    def __init__(self) -> None:
        self.waiting: dict[tuple[int, int], dict[str, Any]] = {}

    def add(self, stream: str, message: Any) -> tuple[Any, Any] | None:
        """Take a message; return the pair that it completes."""
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


MISTAKES = """
the objects are compared, by `is` or id, and each message has a stamp of its own: compare its sec and nanosec.
    message.header.stamp.sec, message.header.stamp.nanosec => id(message.header.stamp)

only the seconds are compared, or only nanosec: a stamp has both.
    together = => stamp = stamp[0] // together = => stamp = stamp[1] // together =

a pair drops all that waits: only what came before it is past.
    while stamp in self.waiting: => self.waiting.clear() // while False:

what came before a pair is not dropped: it is past, also where its partner still comes.
    while stamp in self.waiting: => self.waiting.pop(stamp) // while False:

#
Compare with: a message waits by its stamp, until the other stream's message of the same stamp is there, whichever comes
first; then both are taken out, and returned as joints, pose.

# two objects
Most likely what waits belongs to the class, or to an argument's default: make it in __init__.

# nanosecond
The stamps are rounded, as floats are, or almost the same ones are taken for the same: each nanosecond counts.

# three
Most likely only one message of a stream is kept, or an older stamp is refused: what came after a pair still waits.

# digits
Most likely the stamps are not compared as they are: both numbers count, sec and nanosec.

# late
Most likely older ones go on waiting, or later ones are dropped: a pair drops what came before its first message.

# start
Most likely it is asked which stamp is larger: after a new start they begin at 0; count on the arrival.

# 50
# 51
# 60
# 200
Most likely fewer than 50 may wait, or more, or another gives way, or all: of more than 50, drop what came first.
"""
NO_PAIR = "Return the two messages themselves, joints, pose, or None as long as one of them is missing."

JOINTS, POSE = "joints", "pose"
Arrival = tuple[str, int]  # the stream, and the stamp [ns]
MS, S = 10**6, 10**9  # [ns]
TODAY = 1_750_000_000 * S


def joints(*stamps: int) -> list[Arrival]:
    """Joint states of these stamps [ms]."""
    return [(JOINTS, stamp * MS) for stamp in stamps]


def poses(*stamps: int) -> list[Arrival]:
    """Poses of these stamps [ms]."""
    return [(POSE, stamp * MS) for stamp in stamps]


def in_turn(*stamps: int) -> list[Arrival]:
    """Joint states and pose of each of these stamps [ms]."""
    return [arrival for stamp in stamps for arrival in (*joints(stamp), *poses(stamp))]


def message_of(stream: str, stamp: int) -> Any:
    """Make a message with a stamp [ns]."""
    message = JointState() if stream == JOINTS else TransformStamped()
    message.header.stamp.sec, message.header.stamp.nanosec = divmod(stamp, S)
    return message


def add(pairs: Any, stream: str, message: Any, known: Iterable[tuple[Any, Arrival]]) -> list[Arrival] | None:
    """Have a message arrive, and say what was returned, by the messages that are known."""
    with watch.call("add"):
        returned = pairs.add(stream, message)
        if returned is None:
            return None
        those = returned if isinstance(returned, (tuple, list)) else ()
        pair = [arrival for one in those for each, arrival in known if each is one]
        if len(pair) != 2:
            raise Misuse(f"it returns a {type(returned).__name__}", NO_PAIR)
        return pair


def tried(*arrivals: Arrival, objects: int = 1) -> Callable[[type], list[Any]]:
    """Observe what is returned for one message after the other.

    Args:
        arrivals: of the messages.
        objects: to how many objects the messages are given in turns.
    """

    def case(answer: type) -> list[Any]:
        messages = [message_of(*arrival) for arrival in arrivals]
        known, those = list(zip(messages, arrivals)), cycle([call(answer) for _ in range(objects)])
        return [add(pairs, stream, message, known) for pairs, (message, (stream, _)) in zip(those, known)]

    return case


TRIED = {
    "two objects, of which each is given one half": tried(*in_turn(20), objects=2),
    "in turn": tried(*in_turn(20, 40, 60)),
    "the pose first": tried(*poses(20), *joints(20), *poses(40), *joints(40)),
    "three joint states, then their poses": tried(*joints(20, 40, 60), *poses(20, 40, 60)),
    "three poses, then their joint states": tried(*poses(20, 40, 60), *joints(20, 40, 60)),
    "a pose is missing": tried(*in_turn(20), *joints(40), *in_turn(60)),
    "joints are missing": tried(*in_turn(20), *poses(40, 60), *joints(60)),
    "the same part of another second": tried(*joints(1020), *poses(2020), *joints(2020)),
    "a nanosecond apart": tried((JOINTS, 20 * MS), (POSE, 20 * MS + 1), (JOINTS, 20 * MS + 1)),
    "a nanosecond apart, on today's date": tried((JOINTS, TODAY), (POSE, TODAY + 1), (JOINTS, TODAY + 1)),
    "the same digits": tried((JOINTS, S + 23), (POSE, 12 * S + 3), (JOINTS, 3 * S + 12), (JOINTS, 12 * S + 3)),
    "a partner that comes too late": tried(*in_turn(20), *joints(40), *in_turn(60), *poses(40), *in_turn(80)),
    "poses that come too late": tried(*joints(20, 40, 60, 80), *poses(80, 20, 40, 60), *in_turn(100)),
    "joints that come too late": tried(*in_turn(20), *poses(40), *in_turn(60), *joints(40), *in_turn(80)),
    "a late pose, where poses are first": tried(*joints(40), *poses(60), *joints(60), *poses(40), *in_turn(80)),
    "late joints, where poses are first": tried(*poses(40, 60), *joints(60), *joints(40), *in_turn(80)),
    "a pose that comes twice": tried(*in_turn(20), *poses(20), *in_turn(40)),
    "the same joints twice, then their pose": tried(*joints(20, 20), *poses(20)),
    "started again, from 0": tried(*in_turn(5000, 5020, 0, 20)),
    "joints of before a new start": tried(*joints(5000), *in_turn(0, 20), *poses(5000)),
    "60 joint states, then the last 40 poses": tried(*joints(*range(0, 1200, 20)), *poses(*range(400, 1200, 20))),
    "50 joint states, then the pose of the first": tried(*joints(*range(0, 1000, 20)), *poses(0)),
    "50 joint states, 1 s apart, then the pose of the first": tried(*joints(*range(0, 50000, 1000)), *poses(0)),
    "51 joint states, then the pose of the first": tried(*joints(*range(0, 1020, 20)), *poses(0)),
    "51 poses, then the joints of the first": tried(*poses(*range(0, 1020, 20)), *joints(0)),
    "200 without a partner, then the pose of the first": tried(*joints(*range(0, 4000, 20)), *poses(0)),
    "200 without a partner, then started again": tried(*joints(*range(9000, 13000, 20)), *in_turn(0, 20)),
}  # fmt: skip


def say(returned: Sequence[Any]) -> str:
    """Name the pairs by their stamps."""
    pairs = [" with ".join(f"{stream} of {_time(stamp)}" for stream, stamp in pair) for pair in returned if pair]
    count, shown = len(pairs), ", ".join(pairs) if len(pairs) <= 2 else f"{pairs[0]} to {pairs[-1]}"
    return f"{count} pair{'s' * (count != 1)}, {shown}" if pairs else "no pair"


def _time(stamp: int) -> str:
    return f"{stamp // MS}" + f".{stamp % MS:06}" * (stamp % MS > 0) + " ms"


pair = Exercise("pair", __doc__, Cases(Pairs, TRIED, MISTAKES, say))
