"""Common parts of plots: ticks, and thinned curves."""

from hypothesis import given
from hypothesis import strategies as st

from tutorial.notebook.widgets.chart import nice_ticks, thin, tick_text


@given(st.floats(-1e6, 1e6), st.floats(1e-3, 1e6))
def test_ticks_are_round_and_few(low, span):
    step, ticks = nice_ticks(low, low + span, most=6)
    assert 1 <= len(ticks) <= 7
    assert all(low - 1e-6 * span <= tick <= low + span * (1 + 1e-6) for tick in ticks)
    assert f"{step:.0e}"[0] in "125"
    labels = [tick_text(tick, step) for tick in ticks]
    assert len(set(labels)) == len(labels)


def test_ticks_have_the_digits_they_need():
    assert [tick_text(value, 0.5) for value in (-0.5, -0.0, 1.0)] == ["-0.5", "0.0", "1.0"]
    assert tick_text(15.0, 5.0) == "15"


def test_thinning_keeps_the_extremes():
    points = [(float(i), 0.0) for i in range(1000)]
    points[333], points[777] = (333.0, 5.0), (777.0, -5.0)
    few = thin(points, 50)
    assert len(few) <= 50
    assert {points[333], points[777]} <= set(few)
    assert list(few) == sorted(few)
    assert thin(points[:50], 50) == points[:50]
