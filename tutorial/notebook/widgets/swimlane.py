"""A picture of the hand-off: the threads as lanes, and each message's way from one to the other."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from xml.etree.ElementTree import Element

from tutorial.errors import TutorialError
from tutorial.notebook.widgets import svg
from tutorial.notebook.widgets.chart import draw_x_axis
from tutorial.notebook.widgets.picture import Picture
from tutorial.trace import Handoff, HandoffTrace, Moment

__all__ = ["swimlane"]

WIDTH = 760  # [px]
LEFT, RIGHT = 118, WIDTH - 24  # [px] where the time axis begins and ends
FIRST_LANE, LANE = 62, 92  # [px] the first lane's line, and from one to the next
LABEL = 54  # [px] that the label of a waiting time takes
RADIUS = 4  # [px] of a dot


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
    handoffs = trace.handoffs()[-count:]
    if not handoffs:
        text = "nothing was received or posted yet"
        return Picture(svg.notice(WIDTH, 80, text), text, "handoffs")
    drawing = _Drawing(handoffs)
    return Picture(drawing.svg(), drawing.alt(), "handoffs")


class _Drawing:
    """Lays handoffs out over time and lanes."""

    def __init__(self, handoffs: Sequence[Handoff]) -> None:
        self._handoffs = handoffs
        moments = [(h.received, h.handled, h.posted, h.applied, h.superseded) for h in handoffs]
        times = [moment.time for each in moments for moment in each if moment is not None]
        self._start, self._end = min(times), max(times)
        self._span = max(self._end - self._start, 1e-4) * 1.04
        threads = dict.fromkeys(m.thread for h in handoffs for m in (h.received, h.posted) if m is not None)
        applying = dict.fromkeys(h.applied.thread for h in handoffs if h.applied is not None)
        self._lanes = [*(name for name in threads if name not in applying), *applying]
        self._foot = FIRST_LANE + LANE * (len(self._lanes) - 1) + 26
        self._counts = Counter(handoff.outcome for handoff in handoffs)
        self._waits = [(h.applied, h.applied.time - h.posted.time) for h in handoffs if h.posted and h.applied]
        waits = [wait for _, wait in self._waits]
        self._waited = " to ".join(dict.fromkeys(_ms(wait) for wait in (min(waits), max(waits)))) if waits else ""

    def svg(self) -> str:
        root = svg.new_picture(WIDTH, self._foot + 40)
        span = 0.0, self._span * 1e3
        draw_x_axis(root, span, 9, (LEFT, RIGHT), (FIRST_LANE - 20, self._foot), "ms since the first message")
        self._draw_lanes(root)
        for handoff in self._handoffs:
            self._draw_callback(root, handoff)
            self._draw_call(root, handoff)
        self._draw_waits(root)
        self._draw_legend(root)
        return svg.to_text(root)

    def alt(self) -> str:
        """The picture in words."""
        counts = ", ".join(f"{number} {outcome}" for outcome, number in sorted(self._counts.items()))
        waited = f" They waited {self._waited}." if self._waited else ""
        span = _ms(self._end - self._start)
        return f"{len(self._handoffs)} messages over {span}, on {' and '.join(self._lanes)}: {counts}.{waited}"

    def _x(self, time: float) -> float:
        return LEFT + (RIGHT - LEFT) * (time - self._start) / self._span

    def _place(self, moment: Moment) -> tuple[float, float]:
        return self._x(moment.time), FIRST_LANE + LANE * self._lanes.index(moment.thread)

    def _draw_lanes(self, root: Element) -> None:
        for i, name in enumerate(self._lanes):
            y = FIRST_LANE + LANE * i
            svg.draw(root, "line", f"stroke:{svg.MUTED};stroke-width:1.5", x1=LEFT - 6, y1=y, x2=RIGHT, y2=y)
            style = f"fill:{svg.INK};font-family:{svg.CODE_FONT}"
            svg.write(root, LEFT - 14, y + 4, svg.shorten(name, 14), style, "end")

    def _draw_callback(self, root: Element, handoff: Handoff) -> None:
        """A hollow dot where a message was received, and a bar as long as its callback took."""
        if handoff.received is None:
            return
        x, y = self._place(handoff.received)
        end = self._x((handoff.handled or handoff.received).time)
        svg.draw(root, "rect", f"fill:{svg.INK}", x=x, y=y - 3, width=end - x, height=6)
        svg.draw(root, "circle", f"fill:{svg.PAPER};stroke:{svg.INK};stroke-width:1.4", cx=x, cy=y, r=RADIUS)

    def _draw_call(self, root: Element, handoff: Handoff) -> None:
        """The way of a posted call to where it ran; or half of it, to a cross where a newer one took its place."""
        if handoff.posted is None:
            return
        start = self._place(handoff.posted)
        x, y = self._x(self._end), start[1] + LANE * 0.42
        style = f"stroke:{svg.WARN};stroke-width:1.2;stroke-dasharray:1 3"
        if handoff.applied is not None:
            x, y = self._place(handoff.applied)
            style = f"stroke:{svg.ACCENT};stroke-width:1.6"
            svg.draw(root, "circle", f"fill:{svg.ACCENT}", cx=x, cy=y, r=RADIUS)
        elif handoff.superseded is not None:
            x = self._x(handoff.superseded.time)
            style = f"stroke:{svg.WARN};stroke-width:1.2;stroke-dasharray:3 2"
            svg.write(root, x, y + 4, "✕", f"fill:{svg.WARN};font-weight:bold", "middle")
        svg.draw(root, "polyline", f"fill:none;{style}", points=svg.points_text([start, (x, y)]))

    def _draw_waits(self, root: Element) -> None:
        """Below the lane, how long each call has waited, where there is room."""
        free_from = 0.0
        for applied, wait in self._waits:
            x, y = self._place(applied)
            if x >= free_from:
                svg.write(root, x, y + 18, _ms(wait), f"fill:{svg.ACCENT};font-size:11px", "middle")
                free_from = x + LABEL

    def _draw_legend(self, root: Element) -> None:
        """What the signs mean, and how many there are of each."""
        received = sum(handoff.received is not None for handoff in self._handoffs)
        after = f" after {self._waited}" if self._waited else ""
        entries = [("○", svg.INK, f"received ({received})")]
        entries += [("●", svg.ACCENT, f"applied ({self._counts['applied']}){after}")]
        if count := self._counts["superseded"]:
            entries += [("✕", svg.WARN, f"superseded by a newer one ({count})")]
        if count := self._counts["waiting"]:
            entries += [("┈", svg.WARN, f"not applied yet ({count})")]
        legend = svg.write(root, 14, 22, "")
        for sign, colour, text in entries:
            svg.draw(legend, "tspan", f"fill:{colour};font-weight:bold").text = sign
            svg.draw(legend, "tspan", dx=6.0).text = text
            svg.draw(legend, "tspan", dx=20.0).text = " "


def _ms(seconds: float) -> str:
    """A time with three digits or so."""
    ms = seconds * 1e3
    if ms >= 1e3:
        return f"{seconds:.2f} s"
    return f"{ms:.0f} ms" if ms >= 99.5 else f"{ms:.1f} ms" if ms >= 9.95 else f"{ms:.2f} ms"
