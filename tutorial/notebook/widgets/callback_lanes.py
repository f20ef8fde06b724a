"""A picture of when a node's callbacks run and when they wait, with a lane for each thread."""

import time
from xml.etree.ElementTree import Element

from tutorial.notebook.widgets import svg
from tutorial.notebook.widgets.chart import draw_x_axis
from tutorial.notebook.widgets.picture import Picture
from tutorial.ros.watched_node import Span, WatchedNode

WIDTH = 760  # [px]
LEFT, RIGHT = 96, WIDTH - 24  # [px] ends of the time axis
FIRST_LANE, LANE = 64, 62  # [px] y of the first lane, and the distance between lanes
MARGIN = 0.06  # [s] to show before and after the callback
LETTER = 7.5  # [px] maximum width of a letter
STYLES = {
    "runs": f"stroke:{svg.INK};stroke-width:8",
    "await": f"stroke:{svg.ACCENT};stroke-width:2;stroke-dasharray:5 3",
    "call()": f"stroke:{svg.WARN};stroke-width:14",
}
"""The style of each kind of span. Later kinds are drawn on top."""
FONT = f"fill:{svg.INK};font-family:{svg.CODE_FONT}"


def callback_lanes(node: WatchedNode, *callbacks: str) -> Picture:
    """Show when a node's callbacks ran and waited, from the first to the last run of the given callbacks.

    Args:
        node: the node.
        callbacks: the names of the callbacks' functions.
    """
    kept = [*node.spans]
    runs = [span for span in kept if span.label in callbacks]
    if not runs:
        text = f"{' and '.join(callbacks)} has not run yet"
        return Picture(svg.notice(WIDTH, 80, text), text, "callbacks")
    start, end = runs[0].began - MARGIN, max(span.ended or time.perf_counter() for span in runs) + MARGIN
    shown = [span for span in kept if (span.ended or end) >= start and span.began <= end]
    names = sorted({span.thread for span in shown})
    foot = FIRST_LANE + LANE * (len(names) - 1) + 30
    root = svg.new_picture(WIDTH, foot + 40)
    draw_x_axis(root, (0.0, (end - start) * 1e3), 9, (LEFT, RIGHT), (FIRST_LANE - 24, foot), "ms")
    for i, name in enumerate(names):
        y = FIRST_LANE + LANE * i
        svg.draw(root, "line", f"stroke:{svg.MUTED};stroke-width:1", x1=LEFT, y1=y, x2=RIGHT, y2=y)
        svg.write(root, LEFT - 10, y + 4, name, FONT, "end")
        lane = [span for span in shown if span.thread == name]
        _draw_spans(root, lane, y, (start, end))
        _write_labels(root, [span for span in lane if span.label in callbacks], y - 11, (start, end))
        _write_labels(root, [span for span in lane if span.label not in callbacks], y + 20, (start, end))
    _draw_legend(root)
    waits = [f"{span.label} waits in {span.kind}" for span in shown if span.kind != "runs"]
    alt = f"Callbacks on {' and '.join(names)}: {', '.join(dict.fromkeys(span.label for span in shown))}"
    return Picture(svg.to_text(root), ". ".join([alt, *waits[:1]]) + ".", "callbacks")


def _x(moment: float, times: tuple[float, float]) -> float:
    """Return a moment's horizontal position [px], clamped to the ends of the time axis."""
    return LEFT + (RIGHT - LEFT) * min(max((moment - times[0]) / (times[1] - times[0]), 0.0), 1.0)


def _draw_spans(root: Element, spans: list[Span], y: float, times: tuple[float, float]) -> None:
    for kind, style in STYLES.items():
        for span in spans:
            if span.kind == kind:
                begin, end = _x(span.began, times), _x(span.ended or times[1], times)
                svg.draw(root, "line", style, x1=begin, y1=y, x2=max(end, begin + 2), y2=y)


def _write_labels(root: Element, spans: list[Span], y: float, times: tuple[float, float]) -> None:
    """Write a callback's name at the beginning of each of its runs, if there is room."""
    free = 0.0  # there is room for labels to the right of this x
    for span in spans:
        x, width = _x(span.began, times), LETTER * (len(span.label) + 2)
        if span.kind == "runs" and x >= free and x + width < WIDTH:
            svg.write(root, x, y, span.label, FONT)
            free = x + width


def _draw_legend(root: Element) -> None:
    x = 14.0
    for kind, text in {"runs": "runs", "call()": "waits in call()", "await": "awaits"}.items():
        svg.draw(root, "line", STYLES[kind], x1=x, y1=18, x2=x + 18, y2=18)
        svg.write(root, x + 26, 22, text)
        x += 60 + LETTER * len(text)
