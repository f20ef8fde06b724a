"""A plot of several curves."""

import numpy as np
import pytest

from tutorial.errors import TutorialError
from tutorial.notebook.widgets.chart import POINTS_DRAWN
from tutorial.notebook.widgets.line_plot import line_plot

from .pages import parsed


def test_each_curve_is_drawn_and_named():
    times = np.arange(5000) / 1000
    picture = line_plot({"sine": (times, np.sin(times)), "half": (times, np.sin(times) / 2)}, "m/s²")
    root = parsed(picture.svg)
    curves = [each.get("points").split() for each in root.iter("polyline")]
    assert len(curves) == 2
    assert all(2 < len(points) <= POINTS_DRAWN for points in curves)
    texts = [each.text for each in root.iter("text")]
    assert {"sine", "half", "time [s]", "[m/s²]"} <= set(texts)
    assert "sine: -1 to 1 m/s²" in picture.alt
    assert repr(picture) == "Picture('sine, half')"


def test_a_level_curve_and_a_single_point_are_shown():
    picture = line_plot({"level": ([0.0, 1.0], [2.0, 2.0]), "dot": ([0.5], [2.0])}, "V")
    root = parsed(picture.svg)
    assert len(list(root.iter("circle"))) == len(list(root.iter("polyline"))) == 1


@pytest.mark.parametrize(
    ("curves", "what"),
    [
        ({}, "0 curves"),
        ({str(i): ([0.0], [0.0]) for i in range(9)}, "9 curves"),
        ({"a": ([], [])}, "'a' has 0 times and 0 values"),
        ({"a": ([0.0, 1.0], [0.0])}, "'a' has 2 times and 1 values"),
        ({"a": ([0.0], [np.nan])}, "'a' has numbers that are not finite"),
    ],
)
def test_values_that_cannot_be_plotted_are_refused(curves, what):
    with pytest.raises(TutorialError, match=what):
        line_plot(curves, "m")
