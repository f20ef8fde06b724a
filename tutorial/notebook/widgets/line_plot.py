"""A plot of some curves: numbers over time."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from itertools import chain

from tutorial.errors import TutorialError
from tutorial.notebook.widgets import svg
from tutorial.notebook.widgets.chart import Axes, Point, thin
from tutorial.notebook.widgets.picture import Picture

__all__ = ["line_plot"]

WIDTH, HEIGHT = 640, 240  # [px]
POINTS_DRAWN = 1200  # of one curve
MOST_CURVES = 8
MARGIN = 0.08  # of the curves' height, above and below

NOTHING = "there is nothing to plot: {}. Give each curve its times and as many values, {{name: (times, values)}}."


def line_plot(curves: Mapping[str, tuple[Iterable[float], Iterable[float]]], unit: str) -> Picture:
    """Draw curves over time.

    Args:
        curves: by name, the times [s], rising, and as many values, such as NumPy's arrays.
        unit: of the values, such as ``"m/s²"``.

    Raises:
        TutorialError: there are no curves, or more than eight; or one has no points, something else than finite
            numbers, or not as many values as times.
    """
    drawn = {name: _points(name, *curve) for name, curve in curves.items()}
    if not 0 < len(drawn) <= MOST_CURVES:
        raise TutorialError(NOTHING.format(f"{len(drawn)} curves, and {MOST_CURVES} can be told apart"))
    root = svg.new_picture(WIDTH, HEIGHT)
    axes = Axes(62, 30, 462, HEIGHT - 38, *(_range(drawn, axis) for axis in (0, 1)))
    axes.grid(root, "time [s]", f"[{unit}]")
    for number, points in enumerate(drawn.values()):
        axes.curve(root, thin(points, POINTS_DRAWN), number)
    spans = [f"{min(y for _, y in points):.3g} to {max(y for _, y in points):.3g} {unit}" for points in drawn.values()]
    axes.legend(root, list(drawn), spans)
    said = "; ".join(f"{name}: {span}" for name, span in zip(drawn, spans))
    return Picture(svg.to_text(root), f"Curves over time. {said}.", ", ".join(drawn))


def _points(name: str, times: Iterable[float], values: Iterable[float]) -> list[Point]:
    xs, ys = [float(time) for time in times], [float(value) for value in values]
    if not xs or len(xs) != len(ys):
        raise TutorialError(NOTHING.format(f"{name!r} has {len(xs)} times and {len(ys)} values"))
    if not all(map(math.isfinite, (*xs, *ys))):
        raise TutorialError(NOTHING.format(f"{name!r} has numbers that are not finite"))
    return list(zip(xs, ys))


def _range(drawn: Mapping[str, list[Point]], axis: int) -> Point:
    """Return the least and the greatest number along an axis; values get some air."""
    numbers = [point[axis] for point in chain.from_iterable(drawn.values())]
    low, high = min(numbers), max(numbers)
    air = MARGIN * (high - low) if axis else 0.0
    return (low - air, high + air) if high > low else (low - 0.5, high + 0.5)
