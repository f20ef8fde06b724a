"""A live plot of joint positions, as in ``rqt_plot``."""

import asyncio
import math
from collections import deque
from collections.abc import Iterable, Sequence
from itertools import islice
from operator import itemgetter
from typing import NamedTuple

from rclpy.qos import QoSProfile, ReliabilityPolicy
from sensor_msgs.msg import JointState

from tutorial.notebook.widgets import svg
from tutorial.notebook.widgets.chart import HEIGHT, MOST_CURVES, WIDEST, WIDTH, Curve, draw_plot
from tutorial.notebook.widgets.picture import LivePicture
from tutorial.ros.topics.names import escape_name

SECONDS = 10.0  # [s] length of the time axis
DRAW_EVERY = 0.1  # [s] minimum time between redraws
SHARE = 0.1  # the maximum share of the main thread's time that drawing may take
SAMPLES_KEPT = 10_000
NAMES_KEPT = 200  # per message
TOO_LARGE = 1e6  # [rad]; larger positions, such as infinity, are not drawn
LEAST_SPAN = 0.02  # [rad] smallest range of the y axis
RESTART = 1.0  # [s]; a stamp that jumps back by more than this means that the publisher restarted


class _Sample(NamedTuple):
    """The positions in one message, and the message's stamp [s]. Joint names are escaped by `escape_name`."""

    time: float
    positions: dict[str, float]


class JointPlot(LivePicture):
    """Plots joint positions against the messages' stamps.

    Create the plot on the main thread while the kernel's event loop is running. Its node, ``joint_plot``, receives the
    messages. The plot is redrawn at most ten times a second.

    Args:
        topic: a topic of type ``sensor_msgs/msg/JointState``.

    Raises:
        TutorialError: no event loop is running.
    """

    def __init__(self, topic: str = "/Tank/joint_state") -> None:
        super().__init__(topic)
        self._topic = topic
        self._samples: deque[_Sample] = deque(maxlen=SAMPLES_KEPT)
        self._is_due = False
        self._draw_from = 0.0
        self._draw()
        qos = QoSProfile(depth=10, reliability=ReliabilityPolicy.BEST_EFFORT)  # compatible with every publisher
        self.open_node("joint_plot", lambda node: node.create_subscription(JointState, topic, self._on_message, qos))

    def _on_message(self, message: JointState) -> None:
        """Store the positions and post a redraw, without waiting for it. Runs on the executor's thread."""
        _add(self._samples, message)
        self.calls.call_latest("news", self._draw_soon)

    def _draw_soon(self) -> None:
        """Schedule a redraw, unless one is already scheduled. Main thread only."""
        if not self._is_due:
            self._is_due = True
            asyncio.get_running_loop().call_at(self._draw_from, self._draw)

    def _draw(self) -> None:
        """Draw the newest samples. Main thread only."""
        loop = asyncio.get_running_loop()
        began = loop.time()
        self._is_due = False
        if not self.ended:
            self.show(*_picture(self._topic, self._samples.copy()))  # a copy, because the executor adds samples
        self._draw_from = began + max(DRAW_EVERY, (loop.time() - began) / SHARE)


def _add(samples: deque[_Sample], message: JointState) -> None:
    """Store a message's positions. If the message's stamp shows that the publisher restarted, drop earlier samples."""
    stamp = message.header.stamp.sec + message.header.stamp.nanosec * 1e-9
    if samples and stamp < samples[-1].time - RESTART:
        samples.clear()
    named = islice(zip(message.name, message.position), NAMES_KEPT)
    positions = {escape_name(name): at if abs(at) < TOO_LARGE else math.nan for name, at in named}
    samples.append(_Sample(stamp, positions))


def _picture(topic: str, samples: Iterable[_Sample]) -> tuple[str, str]:
    """Draw the samples from the last `SECONDS`; return the SVG and its description."""
    ordered = sorted(samples, key=itemgetter(0))
    end = ordered[-1].time if ordered else 0.0
    shown = [sample for sample in ordered if sample.time >= end - SECONDS]
    names = list(dict.fromkeys(name for sample in shown for name in sample.positions))
    curves = {name: curve for name in names[:MOST_CURVES] if (curve := _curve(shown, name))}
    if not curves:
        text = f"no message on {svg.shorten(topic, 60)} yet" if not shown else f"no positions on {topic}"
        return svg.notice(WIDTH, HEIGHT, text, WIDEST), text
    begin = max(end - SECONDS, min(end, 0.0))
    x_range = begin, begin + SECONDS
    drawn = draw_plot(curves, x_range, ("stamp [s]", "[rad]"), LEAST_SPAN, len(names) - len(curves))
    said = ", ".join(f"{svg.shorten(name, 40)} {curve.value}" for name, curve in curves.items())
    return drawn, f"Joint positions on {topic} over the last {SECONDS:g} s. Now: {said}."


def _curve(samples: Sequence[_Sample], name: str) -> Curve | None:
    """Return one joint's curve; None if no position is finite."""
    points = [(sample.time, sample.positions[name]) for sample in samples if name in sample.positions]
    finite = [position for _, position in points if math.isfinite(position)]
    return Curve(points, f"{finite[-1]:+.4f} rad") if finite else None
