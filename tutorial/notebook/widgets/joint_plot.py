"""A live plot of joint positions, as ``rqt_plot`` shows them."""

from __future__ import annotations

import asyncio
import math
import time
from collections import deque
from collections.abc import Iterable, Sequence
from itertools import islice
from typing import NamedTuple

from rclpy.qos import QoSProfile, ReliabilityPolicy
from sensor_msgs.msg import JointState

from tutorial.errors import TutorialError
from tutorial.notebook.widgets import svg
from tutorial.notebook.widgets.chart import Axes, Point, thin
from tutorial.notebook.widgets.live_picture import LivePicture
from tutorial.ros.topics.names import escape_name

__all__ = ["JointPlot"]

WIDTH, HEIGHT = 640, 240  # [px]
REDRAW_EVERY = 0.1  # [s] at the most often
SHARE = 0.1  # of the main thread's time that drawing takes at most
SAMPLES_KEPT = 10_000
POINTS_DRAWN = 600  # of one curve
MOST_JOINTS = 8
NAMES_KEPT = 200  # of one message
MOST_SEGMENTS = 100  # of one curve
TOO_LARGE = 1e6  # [rad], infinity included
LEAST_SPAN = 0.02  # [rad] from the bottom to the top
RESTART = 1.0  # [s] by which the time steps back when its publisher has been started again


class _Sample(NamedTuple):
    """What one message said, at its time [s]; the joints' names are as `escape_name`."""

    time: float
    positions: dict[str, float]


class JointPlot(LivePicture):
    """Draws the position of each joint over the time of its messages. Make it on the main thread, while its loop runs.

    It has a node of its own, ``joint_plot``. What is drawn, ten times a second at most, is the newest messages.

    Args:
        topic: of type ``sensor_msgs/msg/JointState``.
        seconds: how much of the time is shown [s].
        ros_args: command line arguments, of which ROS 2 takes those after ``--ros-args``.

    Raises:
        TutorialError: the time is not positive, or no event loop runs.
    """

    _drawing: asyncio.TimerHandle | None = None

    def __init__(
        self, topic: str = "/Tank/joint_state", seconds: float = 10.0, ros_args: Sequence[str] | None = None
    ) -> None:
        if not (math.isfinite(seconds) and seconds > 0):
            raise TutorialError(f"a plot cannot show {seconds} s. Give a number of seconds above 0, such as 10.0.")
        super().__init__(topic, "joint_plot", ros_args)
        self._topic = topic
        self._history = _History(seconds)
        self._draw_from = 0.0
        self._draw()
        qos = QoSProfile(depth=10, reliability=ReliabilityPolicy.BEST_EFFORT)  # fits every publisher
        self.node.create_subscription(JointState, topic, self._on_joint_state, qos)

    def end(self) -> None:
        """Take the node away; the plot stays as it is. Idempotent, main thread."""
        if self._drawing is not None:
            self._drawing.cancel()
        super().end()

    def _on_joint_state(self, message: JointState) -> None:
        """Keep what is to be drawn, post, and return. The executor's thread."""
        self._history.add(message)
        self.calls.call_latest("news", self._draw_soon)

    def _draw_soon(self) -> None:
        """See to it that what has come is drawn, but not too often. Main thread."""
        if self._drawing is None:
            self._drawing = self.loop.call_at(self._draw_from, self._draw)

    def _draw(self) -> None:
        """Draw what is there. Main thread."""
        self._drawing = None
        began = self.loop.time()
        self.show(*_picture(self._topic, self._history.recent(), self._history.seconds))
        self._draw_from = began + max(REDRAW_EVERY, (self.loop.time() - began) / SHARE)


class _History:
    """The newest samples, at most some seconds of them, in the order in which they came.

    One thread adds, another one reads.
    """

    def __init__(self, seconds: float) -> None:
        self.seconds = seconds
        self._samples: deque[_Sample] = deque(maxlen=SAMPLES_KEPT)
        self._last_stamp: float | None = None
        self._offset = 0.0

    def add(self, message: JointState) -> None:
        """Take one message. Where the stamps stay at zero, the time of arrival counts, from the first message on."""
        stamp = message.header.stamp.sec + message.header.stamp.nanosec * 1e-9
        now = time.monotonic()
        if stamp == 0.0 and self._last_stamp == 0.0:
            moment = now - self._offset
        else:
            moment, self._offset = stamp, now - stamp
        self._last_stamp = stamp
        if self._samples and moment < self._samples[-1].time - RESTART:
            self._samples.clear()
        named = islice(zip(message.name, message.position), NAMES_KEPT)
        self._samples.append(_Sample(moment, {escape_name(name): position for name, position in named}))

    def recent(self) -> list[_Sample]:
        """The samples of the last seconds."""
        samples = self._samples.copy()  # in one go: the other thread may go on adding
        end = max((sample.time for sample in samples), default=0.0)
        return [sample for sample in samples if sample.time >= end - self.seconds]


def _picture(topic: str, samples: Sequence[_Sample], seconds: float) -> tuple[str, str]:
    """Draw samples; the picture and its description."""
    names = list(dict.fromkeys(name for sample in samples for name in sample.positions))
    curves = {name: _segments(samples, name) for name in names[:MOST_JOINTS]}
    curves = {name: segments for name, segments in curves.items() if segments}
    if not curves:
        text = f"nothing has come on {svg.shorten(topic, 60)} yet" if not samples else f"no positions on {topic}"
        return svg.notice(WIDTH, HEIGHT, text), text
    root = svg.new_picture(WIDTH, HEIGHT)
    axes = _axes(samples, curves.values(), seconds)
    axes.grid(root, "stamp [s]", "[rad]")
    for number, segments in enumerate(curves.values()):
        share = POINTS_DRAWN // len(segments) or 1
        for segment in segments:
            axes.curve(root, thin(segment, max(2, share)), number)
    values = [f"{segments[-1][-1][1]:+.4f} rad" for segments in curves.values()]
    axes.legend(root, list(curves), values, len(names) - len(curves))
    said = ", ".join(f"{svg.shorten(name, 40)} {value}" for name, value in zip(curves, values))
    return svg.to_text(root), f"Joint positions on {topic} over the last {seconds:g} s. Now: {said}."


def _segments(samples: Sequence[_Sample], name: str) -> list[list[Point]]:
    """One joint's curve, in pieces: it ends where the time steps back, and where there is no number."""
    segments: list[list[Point]] = [[]]
    before = -math.inf
    for moment, positions in samples:
        if name not in positions:
            continue
        position = positions[name]
        is_number = abs(position) < TOO_LARGE  # and no NaN
        if moment < before or not is_number:
            segments.append([])
        if is_number:
            segments[-1].append((moment, position))
        before = moment
    return [segment for segment in segments if segment][-MOST_SEGMENTS:]


def _axes(samples: Sequence[_Sample], curves: Iterable[list[list[Point]]], seconds: float) -> Axes:
    """Frame the curves: all of their height, and the last seconds; time begins at zero."""
    heights = [point[1] for segments in curves for segment in segments for point in segment]
    low, high = min(heights), max(heights)
    margin = max(0.08 * (high - low), (LEAST_SPAN - (high - low)) / 2)
    end = max(sample.time for sample in samples)
    begin = max(end - seconds, min(end, 0.0))
    return Axes(62, 30, 462, HEIGHT - 38, (begin, begin + seconds), (low - margin, high + margin))
