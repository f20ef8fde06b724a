"""The picture of a node's callbacks."""

from types import SimpleNamespace

from tutorial.notebook.widgets.callback_lanes import LEFT, RIGHT, callback_lanes
from tutorial.ros.watched_node import Span

from .pages import parsed


def span(label, began, ended, thread="executor", kind="runs"):
    return Span(label, None, kind, thread=thread, began=began, ended=ended)


def drawn(*spans, callback="on_ask"):
    picture = callback_lanes(SimpleNamespace(spans=spans), callback)
    root = parsed(picture.svg)
    return root, [element.text for element in root.iter() if element.text], picture.alt


def test_each_thread_has_a_lane_and_each_wait_a_line():
    waits = [span("on_ask", 1.0, 1.2, "worker 0"), span("on_ask", 1.0, 1.2, "worker 0", "call()")]
    root, texts, alt = drawn(*waits, *(span("on_tick", 1.0 + i / 50, 1.0 + i / 50, "worker 1") for i in range(9)))
    assert alt == "Callbacks on worker 0 and worker 1: on_ask, on_tick. on_ask waits in call()."
    assert {"worker 0", "worker 1", "on_ask", "on_tick", "waits in call()"} <= set(texts)
    ends = [float(line.get(x)) for line in root.iter("line") for x in ("x1", "x2") if "14" in line.get("style", "")]
    assert all(LEFT <= x <= RIGHT for x in ends[2:])


def test_a_wait_that_lasts_is_drawn_to_the_end():
    _, _, alt = drawn(span("on_ask", 1.0, None), span("on_ask", 1.0, None, kind="await"))
    assert alt.endswith("on_ask waits in await.")


def test_only_what_happened_around_the_callback_is_drawn():
    assert "on_tick" not in drawn(span("on_tick", 0.0, 0.1), span("on_ask", 1.0, 1.1))[1]


def test_a_callback_that_has_not_run():
    assert drawn()[2] == "on_ask has not run yet"
