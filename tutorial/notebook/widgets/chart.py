"""Plots: two axes labelled with round numbers, the curves, and a legend below the plot."""

import math
from collections.abc import Mapping, Sequence
from itertools import groupby
from operator import itemgetter
from typing import NamedTuple
from xml.etree.ElementTree import Element

from tutorial.notebook.widgets import svg

Point = tuple[float, float]

WIDTH, HEIGHT = 560, 240  # [px]
LEFT, TOP, RIGHT, BOTTOM = 54, 34, WIDTH - 12, HEIGHT - 38  # [px] edges of the plot area
WIDEST = 800  # [px]; a plot grows with its cell up to this width
MARGIN = 0.08  # margin above and below the curves, relative to their height
MOST_CURVES = len(svg.SERIES)
MOST_PIECES = 100  # per curve
POINTS_DRAWN = 1200  # per curve
LONGEST_NAME = 16  # maximum number of characters in a curve's name in the legend
ROW, PER_ROW = 18, 4  # the legend's row height [px], and the number of names per row
SMALL = f"fill:{svg.MUTED};font-size:11px"


class Curve(NamedTuple):
    """A curve and its description.

    Attributes:
        points: pairs of x and y, sorted by x. The curve has a gap where y is not finite.
        value: a summary of the curve's values, as text.
    """

    points: Sequence[Point]
    value: str


def draw_plot(
    curves: Mapping[str, Curve], x_range: Point, labels: tuple[str, str], least: float = 0.0, more: int = 0
) -> str:
    """Draw at most `MOST_CURVES` curves, each with at least one finite y.

    Args:
        curves: the curves by name.
        x_range: the smallest and the largest x to show.
        labels: the labels of the x and y axes.
        least: the minimum size of the visible range of y.
        more: the number of curves that are not drawn.
    """
    heights = [y for curve in curves.values() for _, y in curve.points if math.isfinite(y)]
    low, high = min(heights), max(heights)
    air = max(MARGIN * (high - low), (least - (high - low)) / 2) or 0.5
    axes = _Axes(x_range, (low - air, high + air))
    root = svg.new_picture(WIDTH, HEIGHT + ROW * math.ceil((len(curves) + bool(more)) / PER_ROW), WIDEST)
    axes.draw(root, labels)
    for curve, colour in zip(curves.values(), svg.SERIES):
        axes.draw_curve(root, curve.points, colour)
    _draw_legend(root, curves, more)
    return svg.to_text(root)


class _Axes(NamedTuple):
    """The visible x and y ranges."""

    x_range: Point
    y_range: Point

    def draw(self, root: Element, labels: tuple[str, str]) -> None:
        """Draw grid lines at round numbers, with labels."""
        step, ticks = nice_ticks(*self.y_range, most=6)
        for tick in ticks:
            _, y = self._place((0.0, tick))
            svg.draw(root, "line", f"stroke:{svg.RULE}", x1=LEFT, y1=y, x2=RIGHT, y2=y)
            svg.write(root, LEFT - 6, y + 4, tick_text(tick, step), SMALL, "end")
        most = 8 if self.x_range[1] < 1e5 else 4
        draw_x_axis(root, self.x_range, most, (LEFT, RIGHT), (TOP, BOTTOM), labels[0])
        svg.write(root, LEFT - 6, TOP - 14, labels[1], SMALL, "end")

    def draw_curve(self, root: Element, points: Sequence[Point], colour: str) -> None:
        """Draw the pieces of a curve between its gaps; draw a piece that is a single point as a dot."""
        pieces = [[*piece] for is_finite, piece in groupby(points, lambda point: math.isfinite(point[1])) if is_finite]
        for piece in pieces[-MOST_PIECES:]:
            places = [self._place(point) for point in thin(piece, max(2, POINTS_DRAWN // len(pieces)))]
            if len(places) == 1:
                svg.draw(root, "circle", f"fill:{colour}", cx=places[0][0], cy=places[0][1], r=2)
            else:
                style = f"fill:none;stroke:{colour};stroke-width:1.6;stroke-linejoin:round"
                svg.draw(root, "polyline", style, points=svg.points_text(places))

    def _place(self, point: Point) -> Point:
        """Return the position of a point [px]."""
        (left, right), (low, high) = self
        x, y = (point[0] - left) / (right - left), (point[1] - low) / (high - low)
        return LEFT + (RIGHT - LEFT) * x, BOTTOM - (BOTTOM - TOP) * y


def draw_x_axis(root: Element, x_range: Point, most: int, across: Point, down: Point, label: str) -> None:
    """Draw vertical grid lines at round numbers, with the numbers and the axis label below them.

    Args:
        root: the picture.
        x_range: the smallest and the largest x.
        most: the maximum number of lines.
        across: the horizontal positions of the smallest and the largest x [px].
        down: the vertical positions of the lines' ends [px].
        label: the axis label.
    """
    (left, right), (top, bottom) = across, down
    step, ticks = nice_ticks(*x_range, most=most)
    for tick in ticks:
        x = left + (right - left) * ((tick - x_range[0]) / (x_range[1] - x_range[0]))
        svg.draw(root, "line", f"stroke:{svg.RULE}", x1=x, y1=top, x2=x, y2=bottom)
        svg.write(root, x, bottom + 15, tick_text(tick, step), SMALL, "middle")
    svg.write(root, right, bottom + 30, label, SMALL, "end")


def _draw_legend(root: Element, curves: Mapping[str, Curve], more: int) -> None:
    """Write the curves' names below the plot, each with a tooltip that summarizes the curve's values."""
    places = (
        (LEFT + i % PER_ROW * (RIGHT - LEFT) / PER_ROW, HEIGHT + i // PER_ROW * ROW) for i in range(MOST_CURVES + 1)
    )
    for (name, curve), colour, (x, y) in zip(curves.items(), svg.SERIES, places):
        svg.draw(root, "line", f"stroke:{colour};stroke-width:3", x1=x, y1=y, x2=x + 14, y2=y)
        text = svg.write(root, x + 20, y + 4, svg.shorten(name, LONGEST_NAME))
        svg.draw(text, "title").text = f"{name}: {curve.value}"
    if more:
        x, y = next(places)
        svg.write(root, x + 20, y + 4, f"and {more} more", f"fill:{svg.MUTED}")


def nice_ticks(low: float, high: float, most: int) -> tuple[float, list[float]]:
    """Choose ticks at multiples of 1, 2 or 5 times a power of ten.

    Args:
        low: the lower bound.
        high: the upper bound.
        most: the maximum number of intervals.

    Returns:
        The distance between ticks, and the ticks.
    """
    rough = (high - low) / most
    power = 10.0 ** math.floor(math.log10(rough))
    step = next(power * factor for factor in (1, 2, 5, 10) if power * factor >= rough * (1 - 1e-9))
    first, last = math.ceil(low / step - 1e-9), math.floor(high / step + 1e-9)
    return step, [i * step for i in range(first, last + 1)]


def tick_text(value: float, step: float) -> str:
    """Format a tick's number with enough digits to distinguish it from its neighbours."""
    digits = max(0, -math.floor(math.log10(step) + 1e-9))
    if digits > 6 or abs(value) >= 1e12:
        return f"{value:.3g}"
    return f"{value + 0.0:.{digits}f}"


def thin(points: Sequence[Point], most: int) -> Sequence[Point]:
    """Remove points that would not be visible, but keep the lowest and the highest point of each section.

    Args:
        points: the points, sorted by x.
        most: the maximum number of points to keep.
    """
    if len(points) <= most:
        return points
    size = math.ceil(2 * len(points) / most)
    thinned: list[Point] = []
    for start in range(0, len(points), size):
        stretch = points[start : start + size]
        thinned += sorted({min(stretch, key=itemgetter(1)), max(stretch, key=itemgetter(1))})
    return thinned
