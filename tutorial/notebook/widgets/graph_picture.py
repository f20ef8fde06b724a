"""Draws a node graph: nodes as ellipses, topics as boxes, arrows from who publishes to who subscribes."""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import islice, pairwise
from xml.etree.ElementTree import Element

from tutorial.notebook.widgets import svg
from tutorial.notebook.widgets.graph_watch import TopicNews, Topology
from tutorial.notebook.widgets.layers import Edge, Layout, Place, Vertex, lay_out

__all__ = ["picture"]

MARGIN = 14.0  # [px]
HEIGHT = 42.0  # [px] of a node and of a topic
LONGEST_NAME = 30  # characters
CHARACTER = 7.3  # [px] about, of the code font
MOST = 80  # nodes and topics that are drawn
TWIN = 8.0  # [px] between an arrow's line and the middle, where another one runs the other way
HEAD = 8.0  # [px] of an arrow
SMALL = "font-size:11px"


def picture(topology: Topology) -> tuple[str, str]:
    """Draw a node graph; the picture and its description."""
    shapes = _shapes(topology)
    if not shapes:
        text = "there are no nodes yet"
        return svg.notice(480, 80, text), text
    edges = _edges(topology)
    joined = dict.fromkeys(key for edge in edges for key in edge if key in shapes)  # before what stands alone
    shown = {key: shapes[key] for key in list({**joined, **shapes})[:MOST]}
    edges = [(a, b) for a, b in edges if a in shown and b in shown]
    layout = lay_out({key: shape.size for key, shape in shown.items()}, edges)
    width, height = layout.size
    more = len(shapes) - len(shown) + topology.more
    root = svg.new_picture(width + 2 * MARGIN, height + 2 * MARGIN + (20 if more else 0))
    canvas = svg.draw(root, "g", transform=f"translate({MARGIN} {MARGIN})")
    for edge in edges:
        _draw_arrow(canvas, edge, shown, layout, (edge[1], edge[0]) in edges)
    for key, shape in shown.items():
        shape.draw(canvas, layout.places[key])
    if more:
        svg.write(canvas, 0, height + 20, f"and {more:,} more, not shown", f"fill:{svg.MUTED}")
    return svg.to_text(root), _words(topology)


class _Node:
    """An ellipse with a node's name; several nodes of one name share it, and it says so."""

    def __init__(self, name: str, count: int) -> None:
        self._name = name
        self._count = count
        self._label = svg.shorten(name, LONGEST_NAME)
        self._hint = f"{count} nodes of one name" if count > 1 else ""
        self.size = (max(CHARACTER * len(self._label) + 36, 6.2 * len(self._hint) + 44), HEIGHT)

    def draw(self, canvas: Element, place: Place) -> None:
        x, y = place
        colour = svg.WARN if self._hint else svg.ACCENT
        group = svg.draw(canvas, "g")
        svg.draw(group, "title").text = f"node {self._name}"
        style = f"fill:{svg.PAPER};stroke:{colour};stroke-width:1.8"
        svg.draw(group, "ellipse", style, cx=x, cy=y, rx=self.size[0] / 2, ry=HEIGHT / 2)
        _two_lines(group, place, self._label, self._hint, svg.WARN)

    def edge(self, dy: float) -> float:
        """How far the border is from the middle, at a height [px]."""
        return self.size[0] / 2 * math.sqrt(1 - (2 * dy / HEIGHT) ** 2)


class _Topic:
    """A box with a topic's name and its rate."""

    def __init__(self, name: str, news: TopicNews) -> None:
        self._name = name
        self._news = news
        self._label = svg.shorten(name, LONGEST_NAME)
        self.size = (max(CHARACTER * len(self._label) + 22, 64.0), HEIGHT - 4)

    def draw(self, canvas: Element, place: Place) -> None:
        (x, y), (width, height) = place, self.size
        group = svg.draw(canvas, "g")
        svg.draw(group, "title").text = f"topic {self._name} of type {self._news.type_name}"
        style = f"fill:{svg.PAPER};stroke:{svg.LINE};stroke-width:1.4"
        svg.draw(group, "rect", style, x=x - width / 2, y=y - height / 2, width=width, height=height, rx=3)
        _two_lines(group, place, self._label, _rate_text(self._news.rate), svg.MUTED)

    def edge(self, _dy: float) -> float:
        """How far the border is from the middle [px]."""
        return self.size[0] / 2


_Shapes = dict[Vertex, _Node | _Topic]


def _shapes(topology: Topology) -> _Shapes:
    """What is to be drawn; a node that publishes or subscribes counts, also if it has not told its name yet."""
    seen = {name for news in topology.topics.values() for name in (*news.publishers, *news.subscribers)}
    names = sorted({*topology.nodes, *seen})
    shapes: _Shapes = {("node", name): _Node(name, topology.nodes.get(name, 1)) for name in names}
    return shapes | {("topic", name): _Topic(name, news) for name, news in topology.topics.items()}


def _edges(topology: Topology) -> list[Edge]:
    edges: list[Edge] = []
    for topic, news in topology.topics.items():
        edges += [(("node", name), ("topic", topic)) for name in news.publishers]
        edges += [(("topic", topic), ("node", name)) for name in news.subscribers]
    return edges


def _two_lines(group: Element, place: Place, label: str, hint: str, colour: str) -> None:
    x, y = place
    svg.write(group, x, y + (-2 if hint else 4), label, f"fill:{svg.INK};font-family:{svg.CODE_FONT}", "middle")
    if hint:
        svg.write(group, x, y + 12, hint, f"fill:{colour};{SMALL}", "middle")


def _draw_arrow(canvas: Element, edge: Edge, shapes: _Shapes, layout: Layout, has_twin: bool) -> None:
    """Draw a line from shape to shape, through the edge's lanes, that leaves and arrives horizontally."""
    (x1, y1), (x2, y2) = (layout.places[end] for end in edge)
    sign = -1 if edge in layout.backward else 1
    dy = sign * -TWIN if has_twin or sign < 0 else 0.0
    start = (x1 + sign * shapes[edge[0]].edge(dy), y1 + dy)
    tip = (x2 - sign * shapes[edge[1]].edge(dy), y2 + dy)
    back = tip[0] - sign * HEAD
    line = _curve([start, *layout.lanes.get(edge, []), (back, tip[1])])
    svg.draw(canvas, "path", f"fill:none;stroke:{svg.LINE};stroke-width:1.4", d=line)
    corners = svg.points_text([tip, (back, tip[1] - HEAD / 2), (back, tip[1] + HEAD / 2)])
    svg.draw(canvas, "polygon", f"fill:{svg.LINE}", points=corners)


def _curve(points: Sequence[Place]) -> str:
    """A path through points, horizontal at each of them."""
    parts = [f"M{points[0][0]:.1f},{points[0][1]:.1f}"]
    for (x1, y1), (x2, y2) in pairwise(points):
        middle = (x1 + x2) / 2
        parts.append(f"C{middle:.1f},{y1:.1f} {middle:.1f},{y2:.1f} {x2:.1f},{y2:.1f}")
    return " ".join(parts)


def _rate_text(rate: float | None) -> str:
    if rate is None:
        return ""
    return f"{rate:.0f} Hz" if rate >= 9.5 or rate == 0 else f"{rate:.1f} Hz"


def _words(topology: Topology) -> str:
    """The graph in words: its nodes, then each topic with those who publish and subscribe."""
    nodes = [name if count == 1 else f"{name} ({count} nodes of one name)" for name, count in topology.nodes.items()]
    said = [f"Nodes: {_listed(nodes)}."]
    for topic, news in islice(topology.topics.items(), MOST):
        rate = _rate_text(news.rate)
        label = f"{topic} ({rate})" if rate else topic
        said.append(f"{label}: from {_listed(news.publishers)} to {_listed(news.subscribers)}.")
    more = max(0, len(topology.topics) - MOST) + topology.more
    if more:
        said.append(f"And {more:,} more topics.")
    return " ".join(said)


def _listed(names: Sequence[str]) -> str:
    shown = [*names[:MOST], *([f"{len(names) - MOST:,} more"] if len(names) > MOST else [])]
    return ", ".join(shown) or "nobody"
