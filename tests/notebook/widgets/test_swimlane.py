"""The picture of the hand-offs."""

from types import SimpleNamespace

from tutorial.notebook.widgets.swimlane import LEFT, RIGHT, swimlane
from tutorial.trace import Handoff, HandoffTrace, Moment

from .pages import parsed


def message(received: float, applied: float | None = None, superseded: float | None = None) -> Handoff:
    """Return a message that was received, handled and posted on the executor's thread; times [ms]."""

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


def drawn(*handoffs: Handoff, count: int = 8):
    """Return the picture's elements, its texts, and its description."""
    trace = HandoffTrace()
    for handoff in handoffs:
        trace._keep(handoff)
    picture = swimlane(SimpleNamespace(trace=trace), count)
    root = parsed(picture.svg)
    return root, [element.text for element in root.iter() if element.text], picture.alt


def number_of(root, tag: str, part_of_style: str) -> int:
    return sum(part_of_style in element.get("style", "") for element in root.iter(tag))


def test_each_thread_has_a_lane_and_each_message_a_line():
    root, texts, alt = drawn(message(0, 5.1), message(20, 31.1))
    assert texts.index("executor") < texts.index("MainThread")
    assert {"received (2)", "applied after 5 ms to 11 ms (2)"} <= set(texts)
    assert alt == "2 messages over 31.1 ms, on executor and MainThread: 2 applied. They waited 5 ms to 11 ms."
    for polyline in root.iter("polyline"):
        assert all(LEFT <= float(point.split(",")[0]) <= RIGHT for point in polyline.get("points").split())


def test_only_the_newest_messages_are_drawn():
    messages = [message(20 * i, 20 * i + 1) for i in range(50)]
    assert drawn(*messages)[2].startswith("8 messages over 141 ms")
    assert drawn(*messages, count=1)[2].startswith("1 messages over 1 ms")
    assert drawn(message(0, 2010), message(2000, 2010))[2].startswith("2 messages over 2.01 s")


def test_superseded_calls_are_crossed_out():
    superseded = [message(20 * i, superseded=20 * (i + 1) + 0.1) for i in range(99)]
    root, texts, alt = drawn(*superseded, message(1980, 2010), count=100)
    assert "superseded by a newer call (99)" in texts
    assert texts.count("✕") == 99 + 1, "one of them in the legend"
    assert number_of(root, "polyline", "stroke:#1e88e5") == 1
    assert ": 1 applied, 99 superseded." in alt


def test_unapplied_and_unposted_messages_are_shown():
    handled = Handoff("/joy", received=Moment(100.05, "executor"), handled=Moment(100.051, "executor"))
    foreign = Handoff(posted=Moment(100.06, "<b>&"))
    _, texts, alt = drawn(message(0, 1), message(20), handled, foreign)
    lanes = ["executor", "<b>&", "MainThread"]
    assert [name for name in texts if name in lanes] == lanes
    assert "not applied yet (2)" in texts
    assert alt.endswith("1 applied, 1 handled, 2 waiting. They waited 0.9 ms.")


def test_zero_and_missing_durations():
    assert drawn()[2] == "no messages have been received or posted yet"
    assert repr(swimlane(SimpleNamespace(trace=HandoffTrace()))) == "Picture('handoffs')"
    moment = Moment(100.0, "MainThread")
    assert drawn(Handoff(posted=moment, applied=moment))[2].endswith("1 applied. They waited 0 ms.")
