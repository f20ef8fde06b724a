"""The plot of joint positions."""

from __future__ import annotations

import asyncio
import math
import threading
from collections.abc import Callable
from itertools import pairwise
from xml.etree import ElementTree

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from rclpy.qos import QoSProfile, ReliabilityPolicy
from sensor_msgs.msg import JointState

from tutorial.errors import TutorialError
from tutorial.notebook.widgets import joint_plot
from tutorial.notebook.widgets.chart import Axes, nice_ticks, thin, tick_text
from tutorial.notebook.widgets.joint_plot import HEIGHT, WIDTH, JointPlot, _History, _picture
from tutorial.ros.node_thread import NodeThread

SVG = "{http://www.w3.org/2000/svg}"
TOPIC = "/Tank/joint_state"


def joint_state(stamp: float, **positions: float) -> JointState:
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


async def until(condition: Callable[[], object]) -> None:
    async with asyncio.timeout(30):
        while not condition():
            await asyncio.sleep(0.01)


class TestPicture:
    def test_each_joint_has_a_curve_and_a_name(self):
        root, alt = plot(*(joint_state(i * 0.02, TURRET_Y=0.1 * i, TURRET_P=-0.00979) for i in range(100)))
        first, second = curves(root)
        assert len(first) == len(second) == 100
        assert first[0][1] > first[-1][1], "up is positive"
        assert {"TURRET_Y", "TURRET_P", "stamp [s]", "[rad]"} <= set(texts(root))
        assert alt == f"Joint positions on {TOPIC} over the last 10 s. Now: TURRET_Y +9.9000 rad, TURRET_P -0.0098 rad."

    def test_only_the_last_seconds_are_shown(self):
        root, _ = plot(*(joint_state(i * 0.1, A=float(i)) for i in range(500)), seconds=5.0)
        assert len(curves(root)[0]) in (50, 51)

    def test_curves_are_not_joined_where_time_steps_back(self):
        root, _ = plot(*(joint_state(t, A=1.0) for t in (1.0, 1.1, 1.2, 1.05, 1.15)))
        assert [len(curve) for curve in curves(root)] == [3, 2]

    def test_a_publisher_that_was_started_again_begins_anew(self):
        root, _ = plot(*(joint_state(t, A=1.0) for t in (50.0, 50.1, 0.0, 0.1, 0.2)))
        assert [len(curve) for curve in curves(root)] == [3]

    def test_what_is_no_number_is_left_out(self):
        values = (0.0, 0.1, math.nan, 0.2, 0.3, math.inf, 0.4, 0.5, 1e300)
        root, _ = plot(*(joint_state(0.1 * i, A=value) for i, value in enumerate(values)))
        assert [len(curve) for curve in curves(root)] == [2, 2, 2]

    def test_without_stamps_the_time_of_arrival_counts(self, monkeypatch):
        times = iter([1000.0, 1000.5, 1001.0])
        monkeypatch.setattr(joint_plot.time, "monotonic", lambda: next(times))
        history = _History(10.0)
        for _ in range(3):
            history.add(joint_state(0.0, A=0.0))
        assert [sample.time for sample in history.recent()] == [0.0, 0.5, 1.0]

    def test_a_simulation_that_begins_at_zero_has_stamps(self):
        history = _History(10.0)
        for stamp in (0.0, 0.02, 0.04):
            history.add(joint_state(stamp, A=0.0))
        assert [sample.time for sample in history.recent()] == pytest.approx([0.0, 0.02, 0.04])

    def test_many_joints_with_long_names(self):
        names = [f"<b>{i}</b>{'x' * 200}" for i in range(50)]
        root, alt = plot(*(joint_state(t, **dict.fromkeys(names, 0.5)) for t in (0.0, 1.0)))
        assert len(curves(root)) == 8
        assert "and 42 more" in texts(root)
        assert max(map(len, texts(root))) <= 20
        assert len(alt) < 700
        assert not list(root.iter(f"{SVG}b"))

    def test_joints_may_come_and_go(self):
        root, _ = plot(joint_state(0.0, A=1.0), joint_state(0.1, B=1.0), joint_state(0.2, A=1.0, B=2.0))
        assert [len(curve) for curve in curves(root)] == [2, 2]

    @pytest.mark.parametrize(
        ("messages", "text"),
        [([], f"nothing has come on {TOPIC} yet"), ([joint_state(1.0)], f"no positions on {TOPIC}")],
    )
    def test_nothing_to_draw(self, messages, text):
        root, alt = plot(*messages)
        assert (texts(root), alt) == ([text], text)

    @settings(deadline=None)
    @given(
        st.lists(
            st.tuples(
                st.floats(0, 1e9),
                st.dictionaries(st.text(max_size=30), st.floats(allow_nan=True, allow_infinity=True), max_size=12),
            ),
            max_size=40,
        )
    )
    def test_whatever_comes_is_drawn_within_the_picture(self, messages):
        root, _ = plot(*(joint_state(stamp, **positions) for stamp, positions in messages))
        for curve in curves(root):
            assert all(0 <= x <= WIDTH and 0 <= y <= HEIGHT for x, y in curve)

    def test_a_flood_is_thinned(self):
        root, _ = plot(*(joint_state(i * 0.001, A=math.sin(i)) for i in range(9999)))
        assert len(curves(root)[0]) <= 600


class TestChart:
    @settings(deadline=None)
    @given(st.floats(-1e6, 1e6), st.floats(1e-3, 1e6))
    def test_ticks_are_round_and_few(self, low, span):
        step, ticks = nice_ticks(low, low + span, most=6)
        assert 1 <= len(ticks) <= 7
        assert all(low - 1e-6 * span <= tick <= low + span * (1 + 1e-6) for tick in ticks)
        assert f"{step:.0e}"[0] in "125"
        labels = [tick_text(tick, step) for tick in ticks]
        assert len(set(labels)) == len(labels)

    def test_ticks_have_the_digits_they_need(self):
        assert [tick_text(value, 0.5) for value in (-0.5, -0.0, 1.0)] == ["-0.5", "0.0", "1.0"]
        assert tick_text(15.0, 5.0) == "15"

    def test_thinning_keeps_the_extremes(self):
        points = [(float(i), 0.0) for i in range(1000)]
        points[333], points[777] = (333.0, 5.0), (777.0, -5.0)
        few = thin(points, 50)
        assert len(few) <= 50
        assert {points[333], points[777]} <= set(few)
        assert list(few) == sorted(few)
        assert thin(points[:50], 50) == points[:50]

    def test_places(self):
        axes = Axes(10, 20, 110, 220, (0.0, 1.0), (-1.0, 1.0))
        assert (axes.x(0.5), axes.y(1.0), axes.y(-1.0)) == (60, 20, 220)


class TestWidget:
    def test_messages_are_drawn(self, domain):
        async def main():
            plot = JointPlot(TOPIC)
            assert plot.alt == f"nothing has come on {TOPIC} yet"
            qos = QoSProfile(depth=1, reliability=ReliabilityPolicy.BEST_EFFORT)
            with NodeThread("simulation") as ros:
                publisher = ros.node.create_publisher(JointState, TOPIC, qos)
                ros.node.create_timer(0.02, lambda: publisher.publish(joint_state(1.0, TURRET_Y=0.25)))
                await until(lambda: "TURRET_Y +0.2500 rad" in plot.alt)
            assert repr(plot) == "JointPlot('/Tank/joint_state')"
            plot.close()
            plot.close()

        threads = set(threading.enumerate())
        asyncio.run(main())
        assert set(threading.enumerate()) <= threads

    def test_it_is_drawn_now_and_then_only(self, domain):
        async def main():
            plot = JointPlot(TOPIC)
            shown = []
            plot.observe(lambda change: shown.append(asyncio.get_running_loop().time()), "svg")
            for i in range(200):
                plot._on_joint_state(joint_state(i * 0.02, A=float(i)))
                await asyncio.sleep(0.002)
            await until(lambda: "A +199.0000 rad" in plot.alt)
            plot.close()
            return shown

        shown = asyncio.run(main())
        assert all(later - earlier > 0.09 for earlier, later in pairwise(shown))

    def test_nothing_is_drawn_after_closing(self, domain):
        async def main():
            plot = JointPlot(TOPIC)
            plot._on_joint_state(joint_state(1.0, A=1.0))
            plot.close()
            plot._on_joint_state(joint_state(1.1, A=1.0))
            await asyncio.sleep(0)  # whatever was posted runs now
            assert plot._drawing is None
            assert plot.alt.startswith("nothing has come")

        asyncio.run(main())

    @pytest.mark.parametrize("seconds", [0.0, -1.0, math.nan, math.inf])
    def test_how_much_is_shown_has_to_be_a_time(self, seconds):
        with pytest.raises(TutorialError, match=r"a plot cannot show .* s\. Give a number of seconds above 0"):
            JointPlot(seconds=seconds)

    def test_it_needs_a_loop(self):
        with pytest.raises(TutorialError, match=r"none runs here\. Make it in a cell\."):
            JointPlot()
