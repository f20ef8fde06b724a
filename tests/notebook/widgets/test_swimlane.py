"""The picture of the hand-off."""

from __future__ import annotations

from xml.etree import ElementTree

import pytest

from tutorial.errors import TutorialError
from tutorial.notebook.widgets.swimlane import LEFT, RIGHT, swimlane, waiting_calls
from tutorial.trace import Handoff, HandoffTrace, Moment

SVG = "{http://www.w3.org/2000/svg}"


def message(received: float, applied: float | None = None, superseded: float | None = None) -> Handoff:
    """A message that was received, handled and posted on the executor; times [ms]."""

    def moment(ms: float | None, thread: str) -> Moment | None:
        return None if ms is None else Moment(100.0 + ms / 1e3, thread)

    return Handoff(
        "/joy",
        received=moment(received, "executor"),
        posted=moment(received + 0.1, "executor"),
        handled=moment(received + 0.2, "executor"),
        applied=moment(applied, "MainThread"),
        superseded=moment(superseded, "executor"),
    )


def trace_of(*handoffs: Handoff) -> HandoffTrace:
    trace = HandoffTrace()
    for handoff in handoffs:
        trace._keep(handoff)
    return trace


def drawn(trace: HandoffTrace, count: int = 8):
    """The picture's elements, its texts, and its description."""
    picture = swimlane(trace, count)
    root = ElementTree.fromstring(picture.svg)
    texts = [element.text for element in root.iter(f"{SVG}text")]
    picture.close()
    return root, texts, picture.alt


def number_of(root, tag: str, part_of_style: str) -> int:
    return sum(part_of_style in element.get("style", "") for element in root.iter(f"{SVG}{tag}"))


def test_each_thread_has_a_lane_and_each_message_a_way():
    root, texts, alt = drawn(trace_of(message(0, 5.1), message(20, 31.1)))
    assert texts.index("executor") < texts.index("MainThread")
    assert [text for text in texts if text.endswith(" ms")][:2] == ["5.00 ms", "11.0 ms"]
    assert "received (2)" in texts
    assert "applied (2) after 5.00 ms to 11.0 ms" in texts
    assert alt == "2 messages over 31.1 ms, on executor and MainThread: 2 applied. They waited 5.00 ms to 11.0 ms."
    titles = [element.text for element in root.iter(f"{SVG}title")]
    assert (
        "/joy: received at 0.00 ms on executor, posted at 0.10 ms on executor, applied at 5.10 ms on MainThread"
        in titles
    )


def test_only_the_newest_messages_are_drawn():
    trace = trace_of(*(message(20 * i, 20 * i + 1) for i in range(50)))
    assert drawn(trace)[2].startswith("8 messages over 141 ms")
    assert drawn(trace, 1)[2].startswith("1 messages over 1.00 ms")


def test_the_queue_of_a_busy_main_thread_grows():
    trace = trace_of(*(message(20 * i, 2010 + 0.1 * i) for i in range(100)))
    root, texts, alt = drawn(trace, 100)
    for polyline in root.iter(f"{SVG}polyline"):
        assert all(LEFT <= float(point.split(",")[0]) <= RIGHT for point in polyline.get("points").split())
    assert "at most 100" in texts
    assert number_of(root, "polyline", "stroke:#1e88e5") == 100
    assert alt.startswith("100 messages over 2.02 s")
    assert "at most 100" in drawn(trace, 8)[1], "the earlier ones are in the queue too"


def test_a_queue_that_is_long_gone_is_not_shown():
    trace = trace_of(
        *(message(20 * i, 2010) for i in range(100)), *(message(3000 + 20 * i, 3001 + 20 * i) for i in range(8))
    )
    assert "at most 1" in drawn(trace, 8)[1]


def test_superseded_calls_are_crossed_out_and_do_not_queue():
    superseded = [message(20 * i, superseded=20 * (i + 1) + 0.1) for i in range(99)]
    root, texts, alt = drawn(trace_of(*superseded, message(1980, 2010)), 100)
    assert "superseded by a newer one (99)" in texts
    assert "at most 1" in texts
    assert number_of(root, "path", "stroke:#e8710a") == 99 + 1, "with the one that the legend shows"
    assert number_of(root, "polyline", "stroke:#1e88e5") == 1
    assert ": 1 applied, 99 superseded." in alt


def test_what_is_neither_applied_nor_posted_is_shown_too():
    handled = Handoff("/joy", received=Moment(100.05, "executor"), handled=Moment(100.051, "executor"))
    foreign = Handoff(posted=Moment(100.06, "timer"))
    _, texts, alt = drawn(trace_of(message(0, 1), message(20), handled, foreign))
    lanes = ["executor", "timer", "MainThread"]
    assert [name for name in texts if name in lanes] == lanes
    assert "not applied yet (2)" in texts
    assert alt.endswith("1 applied, 2 waiting, 1 handled. They waited 0.90 ms.")


def test_what_happened_at_once_not_at_all_or_on_a_thread_of_any_name():
    assert drawn(HandoffTrace())[2] == "nothing was received or posted yet"
    assert repr(swimlane(HandoffTrace())) == "Picture('handoffs')"
    moment = Moment(100.0, "MainThread")
    assert drawn(trace_of(Handoff(posted=moment, applied=moment)))[2].endswith("1 applied. They waited 0.00 ms.")
    root, *_ = drawn(trace_of(Handoff(posted=Moment(1.0, "<script>" * 9))))
    assert not list(root.iter(f"{SVG}script"))


@pytest.mark.parametrize("count", [0, -1])
def test_no_messages_make_no_picture(count):
    with pytest.raises(TutorialError, match=f"there is no picture of {count} messages. Give a count from 1 on"):
        swimlane(HandoffTrace(), count)


def test_waiting_calls_are_counted():
    def call(posted, applied=None, superseded=None):
        applied, superseded = (None if time is None else Moment(time, "x") for time in (applied, superseded))
        return Handoff(posted=Moment(posted, "x"), applied=applied, superseded=superseded)

    handled = Handoff(received=Moment(2.5, "x"))
    calls = [call(0.0, 2.0), call(1.0, 3.0), call(3.0, superseded=4.0), call(4.0), handled]
    assert waiting_calls(calls, 1.5, 5.0) == [(1.5, 2), (2.0, 1), (3.0, 0), (3.0, 1), (4.0, 0), (4.0, 1), (5.0, 0)]
    assert waiting_calls([], 1.0, 2.0) == [(1.0, 0)]
