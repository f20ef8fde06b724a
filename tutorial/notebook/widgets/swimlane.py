"""A picture of the hand-off: the threads as lanes, and each message's way from one to the other."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from xml.etree.ElementTree import Element

from tutorial.errors import TutorialError
from tutorial.notebook.widgets import svg
from tutorial.notebook.widgets.chart import nice_ticks, tick_text
from tutorial.notebook.widgets.picture import Picture
from tutorial.trace import Handoff, HandoffTrace, Moment

__all__ = ["swimlane", "waiting_calls"]

WIDTH = 760  # [px]
LEFT, RIGHT = 118, WIDTH - 24  # [px] where the time axis begins and ends
FIRST_LANE, LANE = 62, 92  # [px] the first lane's line, and from one to the next
QUEUE_HEIGHT = 40  # [px] of the curve of waiting calls
CHARACTER = 6.4  # [px] about, of a text
LABEL = 54  # [px] that the label of a waiting time takes
SMALL = "font-size:11px"


def swimlane(trace: HandoffTrace, count: int = 8) -> Picture:
    """Draw the last messages of a program: when each was received, posted and applied, and on which thread.

    Args:
        trace: what the program has written down.
        count: how many messages, the newest.

    Raises:
        TutorialError: the count is not positive.
    """
    if count < 1:
        raise TutorialError(f"there is no picture of {count} messages. Give a count from 1 on, such as 8.")
    kept = trace.handoffs()
    if not kept:
        text = "nothing was received or posted yet"
        return Picture(svg.notice(WIDTH, 80, text), text, "handoffs")
    drawing = _Drawing(kept[-count:], kept)
    return Picture(drawing.svg(), drawing.alt(), "handoffs")


class _Drawing:
    """Lays handoffs out over time and lanes.

    Args:
        handoffs: which to draw.
        kept: all that are known of: the earlier ones may be in the queue too.
    """

    def __init__(self, handoffs: Sequence[Handoff], kept: Sequence[Handoff]) -> None:
        self._handoffs = handoffs
        self._start = min(handoff.began for handoff in handoffs)
        self._end = max(moment.time for handoff in handoffs for moment in _moments(handoff))
        self._span = max(self._end - self._start, 1e-4) * 1.04
        posting = dict.fromkeys(m.thread for h in handoffs for m in (h.received, h.posted) if m is not None)
        applying = dict.fromkeys(h.applied.thread for h in handoffs if h.applied is not None)
        self._lanes = [*(name for name in posting if name not in applying), *applying]
        self._bottom = FIRST_LANE + LANE * (len(self._lanes) - 1)
        self._queue_line = self._bottom + 46 + QUEUE_HEIGHT
        self._queue = waiting_calls(kept, self._start, self._end)
        outcomes = [handoff.outcome for handoff in handoffs]
        self._counts = {each: outcomes.count(each) for each in ("applied", "superseded", "waiting", "handled")}
        self._waits = [(h.applied, h.waited) for h in handoffs if h.applied is not None and h.waited is not None]
        self._crowded = len(handoffs) > 24
        self._radius = 2.5 if self._crowded else 4

    def svg(self) -> str:
        root = svg.new_picture(WIDTH, self._queue_line + 66)
        self._draw_axis(root)
        self._draw_lanes(root)
        for handoff in self._handoffs:
            self._draw_way(root, handoff)
        self._draw_waits(root)
        self._draw_queue(root)
        self._draw_legend(root)
        return svg.to_text(root)

    def alt(self) -> str:
        """The picture in words."""
        counts = [f"{number} {outcome}" for outcome, number in self._counts.items() if number]
        waited = f" They waited {self._wait_range()}." if self._waits else ""
        lanes = " and ".join(self._lanes)
        span = _ms(self._end - self._start)
        return f"{len(self._handoffs)} messages over {span}, on {lanes}: {', '.join(counts)}.{waited}"

    def _wait_range(self) -> str:
        """The shortest and the longest time from posting to applying."""
        times = [waited for _, waited in self._waits]
        low, high = _ms(min(times)), _ms(max(times))
        return low if low == high else f"{low} to {high}"

    def _x(self, time: float) -> float:
        return LEFT + (RIGHT - LEFT) * (time - self._start) / self._span

    def _place(self, moment: Moment) -> tuple[float, float]:
        return self._x(moment.time), FIRST_LANE + LANE * self._lanes.index(moment.thread)

    def _draw_axis(self, root: Element) -> None:
        """Lines and numbers of the time since the first message [ms]."""
        step, ticks = nice_ticks(0.0, self._span * 1e3, most=9)
        for tick in ticks:
            x = self._x(self._start + tick / 1e3)
            svg.draw(root, "line", f"stroke:{svg.RULE}", x1=x, y1=FIRST_LANE - 20, x2=x, y2=self._queue_line)
            svg.write(root, x, self._queue_line + 15, tick_text(tick, step), f"fill:{svg.MUTED};{SMALL}", "middle")
        svg.write(root, RIGHT, self._queue_line + 31, "ms since the first message", f"fill:{svg.MUTED};{SMALL}", "end")

    def _draw_lanes(self, root: Element) -> None:
        for i, name in enumerate(self._lanes):
            y = FIRST_LANE + LANE * i
            svg.draw(root, "line", f"stroke:{svg.MUTED};stroke-width:1.5", x1=LEFT - 6, y1=y, x2=RIGHT, y2=y)
            style = f"fill:{svg.INK};font-family:{svg.CODE_FONT}"
            label = svg.write(root, LEFT - 14, y + 4, svg.shorten(name, 14), style, "end")
            svg.draw(label, "title").text = f"the thread {name}"

    def _draw_way(self, root: Element, handoff: Handoff) -> None:
        """One message, from where it was received to where it ended."""
        way = svg.draw(root, "g")
        svg.draw(way, "title").text = self._story(handoff)
        if handoff.received is not None:
            self._draw_callback(way, handoff.received, handoff.handled)
        if handoff.posted is None:
            return
        start = self._place(handoff.posted)
        if handoff.applied is not None:
            opacity = 0.45 if self._crowded else 0.9
            end = self._place(handoff.applied)
            style = f"fill:none;stroke:{svg.ACCENT};stroke-width:{1 if self._crowded else 1.6};opacity:{opacity}"
            svg.draw(way, "polyline", style, points=svg.points_text([start, end]))
            svg.draw(way, "circle", f"fill:{svg.ACCENT}", cx=end[0], cy=end[1], r=self._radius)
        else:
            self._draw_dead_end(way, start, handoff.superseded)

    def _draw_callback(self, way: Element, received: Moment, handled: Moment | None) -> None:
        """A hollow dot where the callback began, and a bar as long as it took."""
        x, y = self._place(received)
        end = self._x(handled.time) if handled is not None else x
        svg.draw(way, "rect", f"fill:{svg.INK}", x=x, y=y - 3, width=max(end - x, 0.0), height=6)
        svg.draw(way, "circle", f"fill:{svg.PAPER};stroke:{svg.INK};stroke-width:1.4", cx=x, cy=y, r=self._radius)

    def _draw_dead_end(self, way: Element, start: tuple[float, float], superseded: Moment | None) -> None:
        """A call that did not run: half of the way, to a cross where a newer one took its place."""
        x = self._x(superseded.time if superseded is not None else self._end)
        y = start[1] + LANE * 0.42
        dashes = "3 2" if superseded is not None else "1 3"
        style = f"fill:none;stroke:{svg.WARN};stroke-width:1.2;stroke-dasharray:{dashes}"
        svg.draw(way, "polyline", style, points=svg.points_text([start, (x, y)]))
        if superseded is not None:
            _draw_cross(way, x, y, self._radius)

    def _draw_waits(self, root: Element) -> None:
        """Below the last lane, how long each call has waited, where there is room."""
        free_from = 0.0
        for applied, waited in sorted(self._waits, key=lambda wait: wait[0].time):
            x, y = self._place(applied)
            if x >= free_from:
                svg.write(root, x, y + 18, _ms(waited), f"fill:{svg.ACCENT};{SMALL}", "middle")
                free_from = x + LABEL

    def _draw_queue(self, root: Element) -> None:
        """How many calls wait, over time."""
        most = max(number for _, number in self._queue)
        floor = float(self._queue_line)
        svg.write(root, LEFT - 14, floor - 20, "calls that wait", f"fill:{svg.INK};{SMALL}", "end")
        svg.write(root, LEFT - 14, floor - 5, f"at most {most}", f"fill:{svg.MUTED};{SMALL}", "end")
        svg.draw(root, "line", f"stroke:{svg.MUTED}", x1=LEFT - 6, y1=floor, x2=RIGHT, y2=floor)
        outline, height = [(self._x(self._start), floor)], floor
        for time, number in self._queue:
            outline.append((self._x(time), height))
            height = floor - QUEUE_HEIGHT * number / max(most, 1)
            outline.append((self._x(time), height))
        outline += [(self._x(self._end), height), (self._x(self._end), floor)]
        svg.draw(root, "polygon", f"fill:{svg.ACCENT};opacity:0.35", points=svg.points_text(outline))

    def _draw_legend(self, root: Element) -> None:
        """What the signs mean, and how many there are of each."""
        x = self._explain(root, 18.0, "received", len([h for h in self._handoffs if h.received is not None]))
        svg.draw(root, "circle", f"fill:none;stroke:{svg.INK};stroke-width:1.4", cx=18, cy=18, r=4)
        svg.draw(root, "line", f"stroke:{svg.ACCENT};stroke-width:1.6", x1=x - 12, y1=18, x2=x, y2=18)
        svg.draw(root, "circle", f"fill:{svg.ACCENT}", cx=x, cy=18, r=4)
        after = f" after {self._wait_range()}" if self._waits else ""
        x = self._explain(root, x, "applied", self._counts["applied"], after)
        if self._counts["superseded"]:
            _draw_cross(root, x, 18, 4)
            x = self._explain(root, x, "superseded by a newer one", self._counts["superseded"])
        if self._counts["waiting"]:
            style = f"stroke:{svg.WARN};stroke-width:1.5;stroke-dasharray:1 3"
            svg.draw(root, "line", style, x1=x - 12, y1=18, x2=x + 4, y2=18)
            self._explain(root, x, "not applied yet", self._counts["waiting"])

    def _explain(self, root: Element, x: float, what: str, count: int, more: str = "") -> float:
        """Write beside a sign what it means; where the next sign comes."""
        text = f"{what} ({count}){more}"
        svg.write(root, x + 10, 22, text)
        return x + 46 + CHARACTER * len(text)

    def _story(self, handoff: Handoff) -> str:
        """What happened to one message, for those who point at it."""
        names = ("received", "posted", "applied", "superseded")
        moments = [(name, getattr(handoff, name)) for name in names]
        said = [f"{name} at {_ms(m.time - self._start)} on {m.thread}" for name, m in moments if m is not None]
        return f"{handoff.topic or 'a call'}: {', '.join(said)}"


def _draw_cross(parent: Element, x: float, y: float, arm: float) -> None:
    path = f"M{x - arm:.1f},{y - arm:.1f} l{2 * arm},{2 * arm} m0,{-2 * arm} l{-2 * arm},{2 * arm}"
    svg.draw(parent, "path", f"fill:none;stroke:{svg.WARN};stroke-width:1.5", d=path)


def _moments(handoff: Handoff) -> Iterator[Moment]:
    every = (handoff.received, handoff.handled, handoff.posted, handoff.applied, handoff.superseded)
    return (moment for moment in every if moment is not None)


def _ms(seconds: float) -> str:
    """A time with three digits or so."""
    ms = seconds * 1e3
    if ms >= 1e3:
        return f"{seconds:.2f} s"
    return f"{ms:.0f} ms" if ms >= 99.5 else f"{ms:.1f} ms" if ms >= 9.95 else f"{ms:.2f} ms"


def waiting_calls(handoffs: Sequence[Handoff], start: float, end: float) -> list[tuple[float, int]]:
    """Count the calls that wait to be applied, between two times.

    Args:
        handoffs: all that are known of, the earlier ones too.
        start: the first time, of `time.perf_counter` [s].
        end: the last time [s].

    Returns:
        (time, how many from then on), in order; the first at the start.
    """
    changes: list[tuple[float, int]] = []
    for handoff in handoffs:
        if handoff.posted is not None:
            over = handoff.applied or handoff.superseded
            changes.append((handoff.posted.time, 1))
            changes.append((over.time if over is not None else end, -1))
    waiting = sum(by for at, by in changes if at < start)
    steps = [(start, waiting)]
    for at, by in sorted(change for change in changes if change[0] >= start):
        waiting += by
        steps.append((min(at, end), waiting))
    return steps
