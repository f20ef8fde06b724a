"""Judge a race along a line: how far the tank followed it, how long that took, and what the tank touched."""

import math
from collections.abc import Collection, Iterable
from dataclasses import asdict, dataclass, replace
from itertools import pairwise
from typing import Any

LIMIT = 40.0  # [s] maximum duration of a race
REACH = 0.3  # [m] how close the tank's centre has to come to a point on the line; the tracks are 0.54 m apart
SPACING = 0.01  # [m] between the points on the line
SAMPLE = 10  # one point in this many is checked for a cut corner
PATIENCE = 10.0  # [s] maximum time without progress, unless the tank has reached the end of the line
PAUSE = 0.5  # [s] how long a contact must be interrupted before it counts again
SKIPPED = 0.7  # [m] a tank has cut a corner if it has followed the line for more than this beyond a missed point
FASTEST = 5.0  # [m/s]; the tracks reach 3 m/s

POINTS_LINE, POINTS_RAIL, POINTS_TIME, POINTS_CONTACT = 60.0, 20.0, 20.0, 5.0

FINISHED, TIME_UP, STUCK, CUT, FOUL = "rail touched", "time up", "stuck", "corner cut", "foul"

Point = tuple[float, float]


@dataclass(frozen=True)
class Result:
    """The result of a race, or its state so far.

    Attributes:
        progress: the fraction of the line that the tank has followed, 0 to 1.
        seconds: the race's duration in simulated time [s].
        touched: what the tank has touched, and when; excludes the floor, and contact between its barrel and the rail.
        end: why the race has ended; empty during the race. It is `FINISHED` if the barrel has touched the rail after
            the tank reached the end of the line.
        foul: what the foul was; empty if there was none.
        limit: the maximum duration [s].
    """

    progress: float = 0.0
    seconds: float = 0.0
    touched: tuple[str, ...] = ()
    end: str = ""
    foul: str = ""
    limit: float = LIMIT

    @property
    def contacts(self) -> int:
        """The number of times the tank has touched something."""
        return len(self.touched)

    @property
    def score(self) -> float:
        """The score, 0 to 100 points.

        Following the line earns up to 60 points, in proportion to the progress. Touching the rail earns 20 points, plus
        up to 20 for the time: 20 * (1 - seconds / LIMIT). Each contact costs 5 points, but the score is never negative.
        After a foul, the score is 0.
        """
        if self.foul:
            return 0.0
        points = POINTS_LINE * self.progress - POINTS_CONTACT * self.contacts
        if self.end == FINISHED:
            points += POINTS_RAIL + POINTS_TIME * (1 - self.seconds / LIMIT)
        return max(points, 0.0)

    def as_dict(self) -> dict[str, Any]:
        """Return the score, the number of contacts and the attributes as a dictionary for JSON."""
        return {"score": round(self.score, 1), "contacts": self.contacts, **asdict(self), "touched": [*self.touched]}

    @property
    def course(self) -> str:
        """A summary of the race, such as ``stuck: 72% of the line, 19.2 s, 0 contacts``."""
        contacts = f"{self.contacts} contact{'s' * (self.contacts != 1)}"
        state = f"{self.progress:.0%} of the line, {self.seconds:.1f} s, {contacts}"
        return f"{self.foul or self.end}: {state}" if self.end else state

    def __str__(self) -> str:
        """Return the text to show in the line below the view."""
        return f"{self.course}, {self.score:.1f} points"


class Race:
    """One race, in simulated time. Use it only on the thread that steps the simulation.

    A point on the line counts as reached once the tank's centre has come near all earlier points, in order, and then
    near this point. Progress therefore never decreases, and shortcuts don't help, even where the line crosses itself.
    Progress is 0 until the tank moves.

    Args:
        line: points along the line [m], from its start to its end.
        limit: the maximum duration [s].

    Attributes:
        result: the state so far.
    """

    def __init__(self, line: Iterable[Point], limit: float = LIMIT) -> None:
        self._points = _subdivided(line)
        self._next = 0  # index of the first point that has not been counted yet
        self._first: int | None = None  # the value of _next at the start
        self._advanced_at = 0.0
        self._skipped: set[int] = set()  # indices of later points that the tank has come near since it last advanced
        self._touched_at: dict[str, float] = {}
        self._before: tuple[float, tuple[float, ...]] | None = None  # the last time and position
        self.result = Result(limit=limit)

    def update(self, seconds: float, position: tuple[float, ...], touched: Collection[str], on_rail: bool) -> None:
        """Update the result with the next state of the world.

        Args:
            seconds: the time since the start of the race [s].
            position: the position of the tank's centre [m], (x, y, z).
            touched: the names of the things that the tank touches.
            on_rail: whether the tank's barrel touches the rail.
        """
        if self.over:
            return
        foul = self._jump(seconds, position)
        progress = self._advance(seconds, position)
        all_touched = self.result.touched + self._new_contacts(seconds, touched)
        state = replace(self.result, progress=progress, seconds=seconds, touched=all_touched, foul=foul)
        self.result = replace(state, end=self._end(state, on_rail))

    @property
    def over(self) -> bool:
        """Whether the race has ended."""
        return bool(self.result.end)

    def disqualify(self, foul: str) -> None:
        """End the race without points; if it is already over, set its score to 0. Only the first foul is reported."""
        self.result = replace(self.result, end=FOUL, foul=self.result.foul or foul)

    def _jump(self, seconds: float, position: tuple[float, ...]) -> str:
        """Return a foul if the tank has moved faster than it can drive."""
        before, self._before = self._before, (seconds, position)
        if before is None:
            return ""
        distance = math.dist(before[1], position)
        return f"the tank has jumped {distance:.2f} m" if distance > FASTEST * (seconds - before[0]) else ""

    def _advance(self, seconds: float, position: tuple[float, ...]) -> float:
        """Count the points on the line that the tank has come near, and return the tank's progress."""
        while self._next < len(self._points) and math.dist(self._points[self._next], position[:2]) <= REACH:
            self._next += 1
            self._advanced_at = seconds
            self._skipped.clear()
        later = range(self._next + 1, len(self._points), SAMPLE)
        self._skipped.update(i for i in later if math.dist(self._points[i], position[:2]) <= REACH)
        if self._first is None:
            self._first = self._next
        ahead = len(self._points) - self._first
        return (self._next - self._first) / ahead if ahead else 1.0

    def _end(self, state: Result, on_rail: bool) -> str:
        """Return why the race ends in this state; empty if it continues. A foul always takes precedence."""
        if state.foul:
            return FOUL
        if on_rail and state.progress == 1.0:
            return FINISHED
        if state.seconds >= state.limit:
            return TIME_UP
        if state.progress < 1.0 and state.seconds - self._advanced_at >= PATIENCE:
            return CUT if len(self._skipped) * SAMPLE * SPACING > SKIPPED else STUCK
        return ""

    def _new_contacts(self, seconds: float, touched: Collection[str]) -> tuple[str, ...]:
        new = [each for each in touched if seconds - self._touched_at.get(each, -math.inf) > PAUSE]
        self._touched_at.update(dict.fromkeys(touched, seconds))
        return tuple(f"{each} after {seconds:.1f} s" for each in sorted(new))


def _subdivided(line: Iterable[Point]) -> list[Point]:
    """Return points on a polygonal line, about `SPACING` apart."""
    corners = list(line)
    points = corners[:1]
    for start, end in pairwise(corners):
        count = max(1, round(math.dist(start, end) / SPACING))
        steps = [i / count for i in range(1, count + 1)]
        points += [(start[0] + t * (end[0] - start[0]), start[1] + t * (end[1] - start[1])) for t in steps]
    return points
