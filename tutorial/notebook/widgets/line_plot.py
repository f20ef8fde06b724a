"""A plot of values against time."""

import math
from collections.abc import Iterable, Mapping

from tutorial.errors import TutorialError
from tutorial.notebook.widgets.chart import MOST_CURVES, Curve, draw_plot
from tutorial.notebook.widgets.picture import Picture

NOTHING = "cannot plot this: {}. Give each curve as many values as there are times: {{name: (times, values)}}."


def line_plot(curves: Mapping[str, tuple[Iterable[float], Iterable[float]]], unit: str) -> Picture:
    """Plot values against time.

    Args:
        curves: for each curve's name, times in ascending order [s] and the same number of values, for instance as
            NumPy arrays.
        unit: the unit of the values, such as ``"m/s²"``.

    Raises:
        TutorialError: there are no curves or more than eight; or a curve has no points, contains a number that is not
            finite, or has different numbers of times and values.
    """
    if not 0 < len(curves) <= MOST_CURVES:
        raise TutorialError(NOTHING.format(f"{len(curves)} curves, but 1 to {MOST_CURVES} are supported"))
    drawn = {name: _curve(name, [*map(float, xs)], [*map(float, ys)], unit) for name, (xs, ys) in curves.items()}
    times = [time for curve in drawn.values() for time, _ in curve.points]
    begin, end = min(times), max(times)
    x_range = (begin, end) if end > begin else (begin - 0.5, end + 0.5)
    said = "; ".join(f"{name}: {curve.value}" for name, curve in drawn.items())
    svg = draw_plot(drawn, x_range, ("time [s]", f"[{unit}]"))
    return Picture(svg, f"Curves over time. {said}.", ", ".join(drawn))


def _curve(name: str, times: list[float], values: list[float], unit: str) -> Curve:
    if not times or len(times) != len(values):
        raise TutorialError(NOTHING.format(f"{name!r} has {len(times)} times and {len(values)} values"))
    if not all(map(math.isfinite, (*times, *values))):
        raise TutorialError(NOTHING.format(f"{name!r} has numbers that are not finite"))
    return Curve(list(zip(times, values)), f"{min(values):.3g} to {max(values):.3g} {unit}")
