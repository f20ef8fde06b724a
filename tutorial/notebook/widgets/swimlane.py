"""A picture of the hand-off: each message's path between threads, which are drawn as lanes."""

from collections import Counter
from collections.abc import Sequence
from xml.etree.ElementTree import Element

from tutorial.notebook.program import Program
from tutorial.notebook.widgets import svg
from tutorial.notebook.widgets.chart import draw_x_axis
from tutorial.notebook.widgets.picture import Picture
from tutorial.trace import Handoff, Moment

WIDTH = 760  # [px]
LEFT, RIGHT = 118, WIDTH - 24  # [px] ends of the time axis
FIRST_LANE, LANE = 62, 92  # [px] y of the first lane, and the distance between lanes
RADIUS = 4  # [px] radius of a dot


def swimlane(program: Program, count: int = 8) -> Picture:
    """Show when a program's last messages were received, posted and applied, with a lane for each thread.

    Args:
        program: the program.
        count: the number of messages to draw, at least 1.
    """
    handoffs = program.trace.handoffs()[-count:]
    if not handoffs:
        text = "no messages have been received or posted yet"
        return Picture(svg.notice(WIDTH, 80, text), text, "handoffs")
    lanes = _Lanes(handoffs)
    root = svg.new_picture(WIDTH, lanes.foot + 40)
    lanes.draw(root)
    for handoff in handoffs:
        _draw_callback(root, lanes, handoff)
        _draw_call(root, lanes, handoff)
    counts = Counter(handoff.outcome for handoff in handoffs)
    waits = sorted(h.applied.time - h.posted.time for h in handoffs if h.posted and h.applied)
    waited = " to ".join(dict.fromkeys(map(_ms, (waits[0], waits[-1])))) if waits else ""
    received = sum(handoff.received is not None for handoff in handoffs)
    _draw_legend(root, received, counts, waited)
    said = ", ".join(f"{number} {outcome}" for outcome, number in sorted(counts.items()))
    alt = f"{len(handoffs)} messages over {_ms(lanes.duration)}, on {' and '.join(lanes.names)}: {said}."
    return Picture(svg.to_text(root), f"{alt} They waited {waited}." if waited else alt, "handoffs")


class _Lanes:
    """The coordinates: time runs to the right, and each thread has a lane. Threads that apply calls are at the bottom.

    Attributes:
        names: the threads' names.
        duration: the time from the first to the last moment [s].
        end: the x of the last moment [px].
        foot: the y of the time axis [px].
    """

    def __init__(self, handoffs: Sequence[Handoff]) -> None:
        moments = [(h.received, h.handled, h.posted, h.applied, h.superseded) for h in handoffs]
        times = [moment.time for each in moments for moment in each if moment is not None]
        self._start, self.duration = min(times), max(times) - min(times)
        self._span = max(self.duration, 1e-4) * 1.04
        threads = dict.fromkeys(m.thread for h in handoffs for m in (h.received, h.posted, h.applied) if m is not None)
        applying = {h.applied.thread for h in handoffs if h.applied is not None}
        self.names = sorted(threads, key=applying.__contains__)
        self.end = self.x(max(times))
        self.foot = FIRST_LANE + LANE * (len(self.names) - 1) + 26

    def x(self, time: float) -> float:
        """Return the x coordinate for a time [px]."""
        return LEFT + (RIGHT - LEFT) * (time - self._start) / self._span

    def place(self, moment: Moment) -> tuple[float, float]:
        """Return the x and y of a moment [px]."""
        return self.x(moment.time), FIRST_LANE + LANE * self.names.index(moment.thread)

    def draw(self, root: Element) -> None:
        span, down = (0.0, self._span * 1e3), (FIRST_LANE - 20, self.foot)
        draw_x_axis(root, span, 9, (LEFT, RIGHT), down, "ms since the first message")
        for i, name in enumerate(self.names):
            y = FIRST_LANE + LANE * i
            svg.draw(root, "line", f"stroke:{svg.MUTED};stroke-width:1.5", x1=LEFT - 6, y1=y, x2=RIGHT, y2=y)
            style = f"fill:{svg.INK};font-family:{svg.CODE_FONT}"
            svg.write(root, LEFT - 14, y + 4, svg.shorten(name, 14), style, "end")


def _draw_callback(root: Element, lanes: _Lanes, handoff: Handoff) -> None:
    """Draw a hollow dot where a message was received, and a bar for the time during which its callback ran."""
    if handoff.received is None:
        return
    x, y = lanes.place(handoff.received)
    end = lanes.x((handoff.handled or handoff.received).time)
    svg.draw(root, "rect", f"fill:{svg.INK}", x=x, y=y - 3, width=end - x, height=6)
    svg.draw(root, "circle", f"fill:{svg.PAPER};stroke:{svg.INK};stroke-width:1.4", cx=x, cy=y, r=RADIUS)


def _draw_call(root: Element, lanes: _Lanes, handoff: Handoff) -> None:
    """Draw a line from where a call was posted to where it was applied, or to a cross if a newer call superseded it."""
    if handoff.posted is None:
        return
    start = lanes.place(handoff.posted)
    x, y = lanes.end, start[1] + LANE * 0.42
    style = f"stroke:{svg.WARN};stroke-width:1.2;stroke-dasharray:1 3"
    if handoff.applied is not None:
        x, y = lanes.place(handoff.applied)
        style = f"stroke:{svg.ACCENT};stroke-width:1.6"
        svg.draw(root, "circle", f"fill:{svg.ACCENT}", cx=x, cy=y, r=RADIUS)
    elif handoff.superseded is not None:
        x = lanes.x(handoff.superseded.time)
        style = f"stroke:{svg.WARN};stroke-width:1.2;stroke-dasharray:3 2"
        svg.write(root, x, y + 4, "✕", f"fill:{svg.WARN};font-weight:bold", "middle")
    svg.draw(root, "polyline", f"fill:none;{style}", points=svg.points_text([start, (x, y)]))


def _draw_legend(root: Element, received: int, counts: Counter[str], waited: str) -> None:
    """Draw the symbols with their explanations and counts."""
    entries = [
        ("○", svg.INK, "received", received),
        ("●", svg.ACCENT, f"applied after {waited}", counts["applied"]),
        ("✕", svg.WARN, "superseded by a newer call", counts["superseded"]),
        ("┈", svg.WARN, "not applied yet", counts["waiting"]),
    ]
    legend = svg.write(root, 14, 22, "")
    for sign, colour, what, count in entries:
        if count:
            svg.draw(legend, "tspan", f"fill:{colour};font-weight:bold").text = sign
            svg.draw(legend, "tspan", dx=6.0).text = f"{what} ({count})"
            svg.draw(legend, "tspan", dx=20.0).text = " "


def _ms(seconds: float) -> str:
    """Format a duration with at most three significant digits."""
    return f"{seconds:.3g} s" if seconds >= 0.9995 else f"{seconds * 1e3:.3g} ms"
