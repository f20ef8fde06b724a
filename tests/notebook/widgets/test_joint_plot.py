"""The plot of joint positions."""

import asyncio
import math
import threading
from collections import deque

import pytest
from hypothesis import given
from hypothesis import strategies as st
from sensor_msgs.msg import JointState

from tutorial.notebook import close_all, joint_plot, open_node, until
from tutorial.notebook.widgets.chart import HEIGHT, WIDTH
from tutorial.notebook.widgets.joint_plot import JointPlot, _add, _picture

from .pages import parsed

TOPIC = "/Tank/joint_state"


def joint_state(stamp: float, /, **positions: float) -> JointState:
    message = JointState(name=list(positions), position=list(positions.values()))
    message.header.stamp.sec = math.floor(stamp)
    message.header.stamp.nanosec = round((stamp - math.floor(stamp)) * 1e9)
    return message


def plot(*messages: JointState):
    """Return the picture's root element, and its description."""
    samples = deque()
    for message in messages:
        _add(samples, message)
    svg, alt = _picture(TOPIC, samples)
    return parsed(svg), alt


def curves(root) -> list[list[tuple[float, float]]]:
    texts = [polyline.get("points") for polyline in root.iter("polyline")]
    return [[tuple(map(float, point.split(","))) for point in text.split()] for text in texts]


def texts(root) -> list[str]:
    return [element.text for element in root.iter("text")]


def test_each_joint_has_a_curve_and_a_name():
    root, alt = plot(*(joint_state(i * 0.02, TURRET_Y=0.1 * i, TURRET_P=-0.00979) for i in range(100)))
    first, second = curves(root)
    assert len(first) == len(second) == 100
    assert first[0][1] > first[-1][1], "up is positive"
    assert {"TURRET_Y", "TURRET_P", "stamp [s]", "[rad]"} <= set(texts(root))
    assert alt == f"Joint positions on {TOPIC} over the last 10 s. Now: TURRET_Y +9.9000 rad, TURRET_P -0.0098 rad."


def test_only_the_last_seconds_are_shown():
    root, _ = plot(*(joint_state(i * 0.1, A=float(i)) for i in range(500)))
    assert len(curves(root)[0]) in (100, 101)


@pytest.mark.parametrize(
    ("samples", "lengths"),
    [
        pytest.param([(t, {"A": 1.0}) for t in (1.0, 1.1, 1.2, 1.05, 1.15)], [5], id="late messages"),
        pytest.param([(t, {"A": 1.0}) for t in (50.0, 50.1, 0.0, 0.1, 0.2)], [3], id="restart"),
        pytest.param(
            [(i / 10, {"A": a}) for i, a in enumerate((0.0, 0.1, math.nan, 0.2, 0.3, math.inf, 0.4, 0.5, 1e300))],
            [2, 2, 2],
            id="not finite",
        ),
        pytest.param([(0.0, {"A": 1.0}), (0.1, {"B": 1.0}), (0.2, {"A": 1.0, "B": 2.0})], [2, 2], id="gaps"),
    ],
)
def test_curves_stop_at_gaps(samples, lengths):
    root, _ = plot(*(joint_state(stamp, **positions) for stamp, positions in samples))
    assert [len(curve) for curve in curves(root)] == lengths


def test_many_joints_with_long_names():
    names = [f"{i}{'x' * 200}" for i in range(50)]
    root, alt = plot(*(joint_state(t, **dict.fromkeys(names, 0.5)) for t in (0.0, 1.0)))
    assert len(curves(root)) == 8
    assert "and 42 more" in texts(root)
    assert max(map(len, texts(root))) <= 20
    assert len(alt) < 700


def test_nothing_to_draw():
    for messages, text in ([], f"no message on {TOPIC} yet"), ([joint_state(1.0)], f"no positions on {TOPIC}"):
        root, alt = plot(*messages)
        assert (texts(root), alt) == ([text], text)


@given(
    st.lists(st.tuples(st.floats(0, 1e9), st.dictionaries(st.text(max_size=9), st.floats(), max_size=5)), max_size=9)
)
def test_everything_is_drawn_within_the_picture(messages):
    root, _ = plot(*(joint_state(stamp, **positions) for stamp, positions in messages))
    for curve in curves(root):
        assert all(0 <= x <= WIDTH and 0 <= y <= HEIGHT for x, y in curve)


async def test_messages_are_drawn_until_it_is_closed(domain):
    threads = set(threading.enumerate())
    plot = joint_plot(TOPIC)
    assert plot.alt == f"no message on {TOPIC} yet"
    assert repr(plot) == "JointPlot('/Tank/joint_state')"
    ros = open_node("simulation")
    publisher = ros.create_publisher(JointState, TOPIC, 1)
    ros.create_timer(0.02, lambda: publisher.publish(joint_state(1.0, TURRET_Y=0.25)))
    await until(lambda: "TURRET_Y +0.2500 rad" in plot.alt)
    plot.close()
    plot.close()
    close_all()
    assert set(threading.enumerate()) <= threads


async def test_a_flood_is_drawn_now_and_then_and_not_after_the_end(domain):
    plot = JointPlot(TOPIC)
    shown = []
    plot.observe(shown.append, "svg")
    for i in range(200):
        plot._on_message(joint_state(i * 0.02, A=float(i)))
        await asyncio.sleep(0)
    await until(lambda: "A +199.0000 rad" in plot.alt)
    assert len(shown) < 5
    plot.end()
    plot._on_message(joint_state(5.0, A=0.0))
    plot._draw()
    assert "A +199.0000 rad" in plot.alt
    plot.close()
