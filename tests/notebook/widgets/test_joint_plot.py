"""The plot of joint positions."""

from __future__ import annotations

import asyncio
import math
import threading
from itertools import pairwise
from types import SimpleNamespace
from xml.etree import ElementTree

import pytest
from hypothesis import given
from hypothesis import strategies as st
from rclpy.qos import QoSProfile, ReliabilityPolicy
from sensor_msgs.msg import JointState

from tutorial.errors import TutorialError
from tutorial.notebook import close_all, open_node, until
from tutorial.notebook.widgets import joint_plot
from tutorial.notebook.widgets.chart import Axes, nice_ticks, thin, tick_text
from tutorial.notebook.widgets.joint_plot import HEIGHT, WIDTH, JointPlot, _History, _picture

SVG = "{http://www.w3.org/2000/svg}"
TOPIC = "/Tank/joint_state"


def joint_state(stamp: float, /, **positions: float) -> JointState:
    message = JointState(name=list(positions), position=list(positions.values()))
    message.header.stamp.sec = math.floor(stamp)
    message.header.stamp.nanosec = round((stamp - math.floor(stamp)) * 1e9)
    return message


def plot(*messages: JointState, seconds: float = 10.0):
    """The picture's root element, and its description."""
    history = _History(seconds)
    for message in messages:
        history.add(message)
    svg, alt = _picture(TOPIC, history.recent(), seconds)
    return ElementTree.fromstring(svg), alt


def curves(root) -> list[list[tuple[float, float]]]:
    texts = [polyline.get("points") for polyline in root.iter(f"{SVG}polyline")]
    return [[tuple(map(float, point.split(","))) for point in text.split()] for text in texts]


def texts(root) -> list[str]:
    return [element.text for element in root.iter(f"{SVG}text")]


def test_each_joint_has_a_curve_and_a_name():
    root, alt = plot(*(joint_state(i * 0.02, TURRET_Y=0.1 * i, TURRET_P=-0.00979) for i in range(100)))
    first, second = curves(root)
    assert len(first) == len(second) == 100
    assert first[0][1] > first[-1][1], "up is positive"
    assert {"TURRET_Y", "TURRET_P", "stamp [s]", "[rad]"} <= set(texts(root))
    assert alt == f"Joint positions on {TOPIC} over the last 10 s. Now: TURRET_Y +9.9000 rad, TURRET_P -0.0098 rad."


def test_only_the_last_seconds_are_shown():
    root, _ = plot(*(joint_state(i * 0.1, A=float(i)) for i in range(500)), seconds=5.0)
    assert len(curves(root)[0]) in (50, 51)


@pytest.mark.parametrize(
    ("samples", "lengths"),
    [
        pytest.param([(t, {"A": 1.0}) for t in (1.0, 1.1, 1.2, 1.05, 1.15)], [3, 2], id="time steps back"),
        pytest.param([(t, {"A": 1.0}) for t in (50.0, 50.1, 0.0, 0.1, 0.2)], [3], id="it is started again"),
        pytest.param(
            [(i / 10, {"A": a}) for i, a in enumerate((0.0, 0.1, math.nan, 0.2, 0.3, math.inf, 0.4, 0.5, 1e300))],
            [2, 2, 2],
            id="no numbers",
        ),
        pytest.param([(0.0, {"A": 1.0}), (0.1, {"B": 1.0}), (0.2, {"A": 1.0, "B": 2.0})], [2, 2], id="come and go"),
    ],
)
def test_a_curve_is_in_pieces_where(samples, lengths):
    root, _ = plot(*(joint_state(stamp, **positions) for stamp, positions in samples))
    assert [len(curve) for curve in curves(root)] == lengths


@pytest.mark.parametrize(
    ("stamps", "times"), [((0.0, 0.0, 0.0), [0.0, 0.5, 1.0]), ((0.0, 0.02, 0.04), [0.0, 0.02, 0.04])]
)
def test_without_stamps_the_time_of_arrival_counts(monkeypatch, stamps, times):
    arrivals = iter([1000.0, 1000.5, 1001.0])
    monkeypatch.setattr(joint_plot, "time", SimpleNamespace(monotonic=lambda: next(arrivals)))
    history = _History(10.0)
    for stamp in stamps:
        history.add(joint_state(stamp, A=0.0))
    assert [sample.time for sample in history.recent()] == pytest.approx(times)


def test_many_joints_with_long_names():
    names = [f"<b>{i}</b>{'x' * 200}" for i in range(50)]
    root, alt = plot(*(joint_state(t, **dict.fromkeys(names, 0.5)) for t in (0.0, 1.0)))
    assert len(curves(root)) == 8
    assert "and 42 more" in texts(root)
    assert max(map(len, texts(root))) <= 20
    assert len(alt) < 700
    assert not list(root.iter(f"{SVG}b"))


def test_nothing_to_draw():
    for messages, text in ([], f"nothing has come on {TOPIC} yet"), ([joint_state(1.0)], f"no positions on {TOPIC}"):
        root, alt = plot(*messages)
        assert (texts(root), alt) == ([text], text)


@given(
    st.lists(st.tuples(st.floats(0, 1e9), st.dictionaries(st.text(max_size=9), st.floats(), max_size=5)), max_size=9)
)
def test_whatever_comes_is_drawn_within_the_picture(messages):
    root, _ = plot(*(joint_state(stamp, **positions) for stamp, positions in messages))
    for curve in curves(root):
        assert all(0 <= x <= WIDTH and 0 <= y <= HEIGHT for x, y in curve)


def test_a_flood_is_thinned():
    root, _ = plot(*(joint_state(i * 0.001, A=math.sin(i)) for i in range(9999)))
    assert len(curves(root)[0]) <= 600


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


def test_places():
    axes = Axes(10, 20, 110, 220, (0.0, 1.0), (-1.0, 1.0))
    assert (axes.x(0.5), axes.y(1.0), axes.y(-1.0)) == (60, 20, 220)


async def test_messages_are_drawn_until_it_is_closed(domain):
    threads = set(threading.enumerate())
    plot = JointPlot(TOPIC)
    assert plot.alt == f"nothing has come on {TOPIC} yet"
    qos = QoSProfile(depth=1, reliability=ReliabilityPolicy.BEST_EFFORT)
    ros = open_node("simulation")
    publisher = ros.create_publisher(JointState, TOPIC, qos)
    ros.create_timer(0.02, lambda: publisher.publish(joint_state(1.0, TURRET_Y=0.25)))
    await until(lambda: "TURRET_Y +0.2500 rad" in plot.alt)
    assert repr(plot) == "JointPlot('/Tank/joint_state')"
    assert plot.node.get_name() == "joint_plot"
    plot.close()
    plot.close()
    close_all()
    assert set(threading.enumerate()) <= threads


async def test_it_is_drawn_now_and_then_only(domain):
    plot = JointPlot(TOPIC)
    shown = []
    plot.observe(lambda change: shown.append(asyncio.get_running_loop().time()), "svg")
    for i in range(200):
        plot._on_joint_state(joint_state(i * 0.02, A=float(i)))
        await asyncio.sleep(0.002)
    await until(lambda: "A +199.0000 rad" in plot.alt)
    plot.close()
    assert all(later - earlier > 0.09 for earlier, later in pairwise(shown))


async def test_nothing_is_drawn_after_closing(domain):
    plot = JointPlot(TOPIC)
    plot._on_joint_state(joint_state(1.0, A=1.0))
    plot.close()
    plot._on_joint_state(joint_state(1.1, A=1.0))
    await asyncio.sleep(0)  # whatever was posted runs now
    assert plot._drawing is None
    assert plot.alt.startswith("nothing has come")


def test_how_much_is_shown_has_to_be_a_time_and_it_needs_a_loop():
    for seconds in (0.0, -1.0, math.nan, math.inf):
        with pytest.raises(TutorialError, match=r"a plot cannot show .* s\. Give a number of seconds above 0"):
            JointPlot(seconds=seconds)
    with pytest.raises(TutorialError, match=r"none runs here\. Make it in a cell\."):
        JointPlot()
