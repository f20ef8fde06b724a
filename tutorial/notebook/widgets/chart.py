"""The frame of a plot: two axes with round numbers, curves within them, and the curves' names beside them."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from operator import itemgetter
from xml.etree.ElementTree import Element

from tutorial.notebook.widgets import svg

__all__ = ["Axes", "Point", "nice_ticks", "thin", "tick_text"]

Point = tuple[float, float]

LONGEST_NAME = 18  # characters in the legend
ROW = 18  # [px] of the legend


@dataclass(frozen=True)
class Axes:
    """A rectangle of the picture [px], and what part of the plane it shows.

    Attributes:
        left: edge of the rectangle [px].
        top: edge [px].
        right: edge [px].
        bottom: edge [px].
        x_range: least and greatest x.
        y_range: least and greatest y.
    """

    left: float
    top: float
    right: float
    bottom: float
    x_range: Point
    y_range: Point

    def x(self, value: float) -> float:
        """Where a value lies from left to right [px]."""
        low, high = self.x_range
        return self.left + (self.right - self.left) * (value - low) / (high - low)

    def y(self, value: float) -> float:
        """Where a value lies from top to bottom [px]."""
        low, high = self.y_range
        return self.bottom - (self.bottom - self.top) * (value - low) / (high - low)

    def grid(self, root: Element, x_unit: str, y_unit: str) -> None:
        """Draw lines at round numbers, with the numbers."""
        small = f"fill:{svg.MUTED};font-size:11px"
        step, ticks = nice_ticks(*self.y_range, most=6)
        for tick in ticks:
            y = self.y(tick)
            svg.draw(root, "line", f"stroke:{svg.RULE}", x1=self.left, y1=y, x2=self.right, y2=y)
            svg.write(root, self.left - 6, y + 4, tick_text(tick, step), small, "end")
        step, ticks = nice_ticks(*self.x_range, most=8 if self.x_range[1] < 1e5 else 4)
        for tick in ticks:
            x = self.x(tick)
            svg.draw(root, "line", f"stroke:{svg.RULE}", x1=x, y1=self.top, x2=x, y2=self.bottom)
            svg.write(root, x, self.bottom + 15, tick_text(tick, step), small, "middle")
        svg.write(root, self.left - 6, self.top - 14, y_unit, small, "end")
        svg.write(root, self.right, self.bottom + 30, x_unit, small, "end")

    def curve(self, root: Element, points: Sequence[Point], number: int) -> None:
        """Draw one curve; a lone point as a dot."""
        places = [(self.x(x), self.y(y)) for x, y in points]
        if len(places) == 1:
            svg.draw(root, "circle", f"fill:{_colour(number)}", cx=places[0][0], cy=places[0][1], r=2)
            return
        style = f"fill:none;stroke:{_colour(number)};stroke-width:1.6;stroke-linejoin:round"
        svg.draw(root, "polyline", style, points=svg.points_text(places))

    def legend(self, root: Element, names: Sequence[str], values: Sequence[str], more: int = 0) -> None:
        """Name the curves, each with a value, to the right of them.

        Args:
            root: where to draw.
            names: one for each curve.
            values: one for each curve, below its name.
            more: how many there are that are not drawn.
        """
        x = self.right + 16
        for i, (name, value) in enumerate(zip(names, values)):
            y = self.top + 6 + i * ROW
            svg.draw(root, "line", f"stroke:{_colour(i)};stroke-width:3", x1=x, y1=y, x2=x + 14, y2=y)
            text = svg.write(root, x + 20, y + 4, svg.shorten(name, LONGEST_NAME), f"fill:{svg.INK}")
            svg.draw(text, "title").text = f"{name}: {value}"
        if more:
            y = self.top + 6 + len(names) * ROW
            svg.write(root, x + 20, y + 4, f"and {more} more", f"fill:{svg.MUTED}")


def nice_ticks(low: float, high: float, most: int) -> tuple[float, list[float]]:
    """Choose round numbers between two others: 1, 2 or 5 times a power of ten apart.

    Args:
        low: the least.
        high: the greatest.
        most: how many at most.

    Returns:
        How far they are apart, and they themselves.
    """
    rough = (high - low) / most
    power = 10.0 ** math.floor(math.log10(rough))
    step = next(power * factor for factor in (1, 2, 5, 10) if power * factor >= rough * (1 - 1e-9))
    first, last = math.ceil(low / step - 1e-9), math.floor(high / step + 1e-9)
    return step, [i * step for i in range(first, last + 1)]


def tick_text(value: float, step: float) -> str:
    """Write a tick's number with the digits that tell it from its neighbours."""
    digits = max(0, -math.floor(math.log10(step) + 1e-9))
    if digits > 6 or abs(value) >= 1e12:
        return f"{value:.3g}"
    return f"{value + 0.0:.{digits}f}"


def thin(points: Sequence[Point], most: int) -> Sequence[Point]:
    """Leave out points that no eye would miss: of each stretch, the least and the greatest stay.

    Args:
        points: in the order of their x.
        most: how many may stay.
    """
    if len(points) <= most:
        return points
    size = math.ceil(2 * len(points) / most)
    thinned: list[Point] = []
    for start in range(0, len(points), size):
        stretch = points[start : start + size]
        thinned += sorted({min(stretch, key=itemgetter(1)), max(stretch, key=itemgetter(1))})
    return thinned


def _colour(number: int) -> str:
    return svg.SERIES[number % len(svg.SERIES)]
