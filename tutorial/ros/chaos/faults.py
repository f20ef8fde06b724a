"""Inject faults into a stream of joint states, without threads, clocks or ROS 2.

Each fault uses a separate sequence of random numbers. Therefore, the same seed gives the same stream, and the messages
that a fault affects do not depend on the other active faults.
"""

from collections.abc import Callable, Mapping
from copy import deepcopy
from math import inf, nan
from random import Random
from typing import Any, Literal, NamedTuple

from tutorial.errors import TutorialError, did_you_mean, printable

Change = Callable[[Random, Any], None]
"""A function that applies a fault to a message, using the fault's own random numbers."""

BURST = 20  # messages in a burst
SECOND_NS = 1_000_000_000
LATE_NS = (SECOND_NS // 1000, 3 * SECOND_NS // 10)  # delay of a late message
AHEAD_NS = (2 * SECOND_NS, 3600 * SECOND_NS)  # how far ahead a wrong clock can be

MARKUP = (
    "<b>TURRET_Y</b>",
    "<script>alert(1)</script>",
    '"><img src=x onerror=alert(1)>',
    "&lt;TURRET_Y&gt;",
    "`$(reboot)`{{7*7}}",
)
CONTROL = (
    "\x1b[2J\x1b[HTURRET_Y",  # clears a terminal
    "TURRET_Y\n[ERROR] all is lost",  # forges a log line
    "\u202eY_TERRUT",  # is displayed from right to left
    "TURRET\u200b_Y",  # looks like the joint's own name
    "\r\x07\x9b31m",
)

FAULTS = {
    "shuffle": "the joints are in a different order",
    "subset": "some joints are missing",
    "rename": "a joint's name is misspelled",
    "duplicate": "a joint appears twice, first with an earlier position",
    "nan": "a position is not a number",
    "infinite": "a position is infinite",
    "huge": "a position is far outside any range",
    "markup": "an extra name contains HTML",
    "control": "an extra name contains control characters or reverses the text direction",
    "short": "fewer positions than names",
    "long": "more positions than names",
    "late": "a message is held back for up to 0.3 s, and arrives after newer ones",
    "ahead": "the stamp is up to an hour ahead",
    "restart": "the publisher restarts, and its stamps start at 0 again",
    "drop": "the message is lost",
    "burst": f"the message is sent {BURST} times in a row",
    "second": "a second publisher reports all joints at 0",
}
"""Descriptions of the faults by name, in the order they are applied."""


class Action(NamedTuple):
    """An action for the publishers of a stream.

    Attributes:
        kind: ``"publish"``: publish the message; ``"second"``: publish it from a second publisher; ``"restart"``:
            restart the publisher.
        message: the `sensor_msgs/JointState` to publish, if any.
    """

    kind: Literal["publish", "second", "restart"]
    message: Any = None


class Chaos:
    """Injects faults into a stream of joint states.

    Args:
        faults: the share of messages that each fault affects, 0 to 1, by name. Several faults can affect the same
            message.
        seed: the same seed gives the same faults.

    Attributes:
        faults: the given faults; they can be replaced while the stream runs.
        made: number of messages that each fault has affected so far, by name.
    """

    def __init__(self, faults: Mapping[str, float] | None = None, seed: int = 0) -> None:
        self.faults = dict(faults or {})
        self.made = dict.fromkeys(FAULTS, 0)  # complete from the start, because another thread may read it
        self._random = {name: Random(f"{seed} {name}") for name in FAULTS}
        self._newest_ns = 0  # the stamp of the last message that was on time
        self._held: tuple[Any, int] | None = None  # the message that is held back, and its delay [ns]
        self._began_ns = 0  # the good stream's stamp at the last restart, published as 0

    def apply(self, message: Any) -> list[Action]:
        """Inject faults into the next message.

        Args:
            message: a `sensor_msgs/JointState` without faults; it is not changed.

        Returns:
            The actions to take, in order; empty for a message that is lost or held back.
        """
        hits = [name for name, share in self.faults.items() if self._random[name].random() < share]
        faulty = deepcopy(message)
        for name, change in CHANGES.items():
            if name in hits and 0 < len(message.name) == len(message.position):
                change(self._random[name], faulty)
                self.made[name] += 1
        for name in ("restart", "ahead", "drop", "second"):
            self.made[name] += name in hits
        actions = []
        if "restart" in hits:
            self._began_ns = stamp_ns(message)
            self._held = None  # a restarted publisher loses its held message
            actions.append(Action("restart"))
        ahead_ns = self._random["ahead"].randint(*AHEAD_NS) if "ahead" in hits else 0
        set_stamp_ns(faulty, stamp_ns(message) - self._began_ns + ahead_ns)
        actions += self._in_time(faulty, hits)
        if "second" in hits:
            actions.append(Action("second", _at_zero(message)))
        return actions

    def _in_time(self, message: Any, hits: list[str]) -> list[Action]:
        """Return actions that publish a message now, later, never, or many times, and the held message if it is due."""
        actions = []
        if "late" in hits and self._held is None:
            self._held = message, self._random["late"].randint(*LATE_NS)
        elif "drop" not in hits:
            self._newest_ns = stamp_ns(message)
            self.made["burst"] += "burst" in hits
            actions += [Action("publish", message)] * (BURST if "burst" in hits else 1)
        if self._held is not None:
            held, delay_ns = self._held
            age_ns = self._newest_ns - stamp_ns(held)
            if age_ns >= delay_ns:
                self._held = None
            if delay_ns <= age_ns <= SECOND_NS:  # otherwise the stamps have jumped, and the held message is lost
                self.made["late"] += 1
                actions.append(Action("publish", held))
        return actions


def parse_fault(text: str) -> tuple[str, float]:
    """Parse a fault: ``"nan:0.1"`` affects one message in ten, and ``"nan"`` affects every message.

    Raises:
        TutorialError: there is no such fault (the error suggests the nearest name), or the share is invalid.
    """
    name, colon, given = text.partition(":")
    try:
        share = float(given) if colon else 1.0
    except ValueError:
        share = nan
    if name not in FAULTS:
        raise TutorialError(f"there is no fault {printable(name)!r}.{did_you_mean(name, FAULTS)}")
    if not 0 <= share <= 1:
        raise TutorialError(
            f"the share of messages that {name!r} affects cannot be {share:g}: give a number from 0 to 1."
        )
    return name, share


def stamp_ns(message: Any) -> int:
    """Return a message's stamp [ns]."""
    stamp = message.header.stamp
    return int(stamp.sec * SECOND_NS + stamp.nanosec)


def set_stamp_ns(message: Any, ns: int) -> None:
    """Set a message's stamp [ns]."""
    message.header.stamp.sec, message.header.stamp.nanosec = divmod(ns, SECOND_NS)


def _at_zero(message: Any) -> Any:
    """Return the message that a publisher would send if its robot had never moved."""
    still = deepcopy(message)
    still.position = [0.0] * len(message.name)
    still.velocity, still.effort = [], []
    return still


# Functions that change the content of a message. The message has at least one name, and one position per name.


def _reorder(message: Any, order: list[int]) -> None:
    """Keep the given entries, in the given order, in every list that has one entry per name."""
    count = len(message.name)
    for field in ("position", "velocity", "effort", "name"):
        values = getattr(message, field)
        if len(values) == count:
            setattr(message, field, [values[i] for i in order])


def _some(random: Random, count: int) -> int:
    """Choose at random how many entries to keep: at least one, but not all if there are several."""
    return random.randrange(1, max(count, 2))


def _shuffle(random: Random, message: Any) -> None:
    count = len(message.name)
    order = random.sample(range(count), count)
    _reorder(message, order if order != sorted(order) else order[::-1])


def _subset(random: Random, message: Any) -> None:
    count = len(message.name)
    _reorder(message, sorted(random.sample(range(count), _some(random, count))))


def _rename(random: Random, message: Any) -> None:
    i = random.randrange(len(message.name))
    k = random.randrange(len(message.name[i]) + 1)
    mistyped = message.name[i][:k] + message.name[i][k + 1 :]  # a character is missing
    while mistyped in message.name:
        mistyped += "_"
    message.name = [*message.name[:i], mistyped, *message.name[i + 1 :]]


def _duplicate(random: Random, message: Any) -> None:
    i = random.randrange(len(message.name))
    _reorder(message, [i, *range(len(message.name))])
    message.position[0] += random.uniform(0.1, 0.5)


def _put(value: Callable[[Random], float]) -> Change:
    """Return a change that replaces one position."""

    def change(random: Random, message: Any) -> None:
        message.position[random.randrange(len(message.position))] = value(random)

    return change


def _add(names: tuple[str, ...]) -> Change:
    """Return a change that adds an entry with one of these names."""

    def change(random: Random, message: Any) -> None:
        count = len(message.name)
        for field in ("position", "velocity", "effort"):
            values = list(getattr(message, field))
            if len(values) == count:
                setattr(message, field, [*values, 0.1])
        message.name = [*message.name, random.choice(names)]

    return change


def _short(random: Random, message: Any) -> None:
    kept = _some(random, len(message.position))
    for field in ("position", "velocity", "effort"):
        setattr(message, field, getattr(message, field)[:kept])


def _long(random: Random, message: Any) -> None:
    message.position = [*message.position, *(random.uniform(-1, 1) for _ in range(random.randint(1, 3)))]


CHANGES: dict[str, Change] = {
    "shuffle": _shuffle,
    "subset": _subset,
    "rename": _rename,
    "duplicate": _duplicate,
    "nan": _put(lambda _: nan),
    "infinite": _put(lambda random: random.choice((-inf, inf))),
    "huge": _put(lambda random: random.choice((-1, 1)) * 10.0 ** random.randint(12, 300)),
    "markup": _add(MARKUP),
    "control": _add(CONTROL),
    "short": _short,
    "long": _long,
}
