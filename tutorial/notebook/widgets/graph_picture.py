"""Draws a node graph: nodes as ellipses, topics as boxes, with arrows from publishers via topics to subscribers."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from xml.etree.ElementTree import Element

from tutorial.notebook.widgets import svg
from tutorial.notebook.widgets.graph_watch import Topology
from tutorial.notebook.widgets.layers import Edge, Layout, Place, Vertex, lay_out

MARGIN = 8.0  # [px]
HEIGHT = 42.0  # [px] height of nodes and topics
LONGEST_NAME = 30  # characters
CHARACTER = 7.3  # [px] approximate width of a character in the code font
TWIN = 8.0  # [px]; arrows that point left begin and end this far below the middle
HEAD = 8.0  # [px] size of an arrowhead


def picture(topology: Topology) -> tuple[str, str]:
    """Draw a node graph; return the SVG and its description."""
    shapes = _shapes(topology)
    if not shapes:
        text = "there are no nodes yet"
        return svg.notice(480, 80, text), text
    edges = _edges(topology)
    layout = lay_out({vertex: shape.width for vertex, shape in shapes.items()}, edges)
    width, height = layout.size
    root = svg.new_picture(width + 2 * MARGIN, height + 2 * MARGIN + (20 if topology.more else 0))
    canvas = svg.draw(root, "g", transform=f"translate({MARGIN} {MARGIN})")
    for edge in edges:
        _draw_arrow(canvas, edge, shapes, layout)
    for vertex, shape in shapes.items():
        shape.draw(canvas, layout.places[vertex])
    if topology.more:
        svg.write(canvas, 0, height + 20, f"and {topology.more:,} more, not shown", f"fill:{svg.MUTED}")
    return svg.to_text(root), _words(topology)


@dataclass(frozen=True)
class _Shape:
    """An ellipse with a node's name or a box with a topic's name, and an optional small note below the name.

    Nodes with the same name share an ellipse, whose note gives the number of these nodes.
    """

    name: str
    title: str
    hint: str
    is_node: bool

    @property
    def label(self) -> str:
        return svg.shorten(self.name, LONGEST_NAME)

    @property
    def width(self) -> float:
        return max(CHARACTER * len(self.label) + (36 if self.is_node else 22), 6.2 * len(self.hint) + 44)

    def draw(self, canvas: Element, place: Place) -> None:
        (x, y), width = place, self.width
        group = svg.draw(canvas, "g")
        svg.draw(group, "title").text = self.title
        if self.is_node:
            style = f"fill:{svg.PAPER};stroke:{svg.WARN if self.hint else svg.ACCENT};stroke-width:1.8"
            svg.draw(group, "ellipse", style, cx=x, cy=y, rx=width / 2, ry=HEIGHT / 2)
        else:
            style = f"fill:{svg.PAPER};stroke:{svg.LINE};stroke-width:1.4"
            svg.draw(group, "rect", style, x=x - width / 2, y=y - HEIGHT / 2, width=width, height=HEIGHT, rx=3)
        name_style = f"fill:{svg.INK};font-family:{svg.CODE_FONT}"
        svg.write(group, x, y + (-2 if self.hint else 4), self.label, name_style, "middle")
        if self.hint:
            colour = svg.WARN if self.is_node else svg.MUTED
            svg.write(group, x, y + 12, self.hint, f"fill:{colour};font-size:11px", "middle")

    def edge(self, dy: float) -> float:
        """Return half the shape's width at a given vertical distance from its centre [px]."""
        return self.width / 2 * (math.sqrt(1 - (2 * dy / HEIGHT) ** 2) if self.is_node else 1)


def _shapes(topology: Topology) -> dict[Vertex, _Shape]:
    shapes: dict[Vertex, _Shape] = {}
    for name, count in topology.nodes.items():
        shapes["node", name] = _Shape(
            name, f"node {name}", f"{count} nodes with the same name" if count > 1 else "", True
        )
    for name, news in topology.topics.items():
        shapes["topic", name] = _Shape(name, f"topic {name} of type {news.type_name}", _rate_text(news.rate), False)
    return shapes


def _edges(topology: Topology) -> list[Edge]:
    edges: list[Edge] = []
    for topic, news in topology.topics.items():
        edges += [(("node", name), ("topic", topic)) for name in news.publishers]
        edges += [(("topic", topic), ("node", name)) for name in news.subscribers]
    return edges


def _draw_arrow(canvas: Element, edge: Edge, shapes: dict[Vertex, _Shape], layout: Layout) -> None:
    """Draw an arrow between two shapes through the edge's lanes. The arrow starts and ends horizontally."""
    (x1, y1), (x2, y2) = (layout.places[end] for end in edge)
    sign = 1 if x1 < x2 else -1
    dy = TWIN if sign < 0 else 0.0
    start = (x1 + sign * shapes[edge[0]].edge(dy), y1 + dy)
    tip = (x2 - sign * shapes[edge[1]].edge(dy), y2 + dy)
    back = (tip[0] - sign * HEAD, tip[1])
    line = _curve([start, *layout.lanes[edge], back])
    svg.draw(canvas, "path", f"fill:none;stroke:{svg.LINE};stroke-width:1.4", d=line)
    corners = svg.points_text([tip, (back[0], tip[1] - HEAD / 2), (back[0], tip[1] + HEAD / 2)])
    svg.draw(canvas, "polygon", f"fill:{svg.LINE}", points=corners)


def _curve(points: Sequence[Place]) -> str:
    """Return an SVG path that passes through the points and is horizontal at each point."""
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
    """Describe the graph: the nodes, then each topic with its publishers and subscribers."""
    nodes = [
        name if count == 1 else f"{name} ({count} nodes with the same name)" for name, count in topology.nodes.items()
    ]
    said = [f"Nodes: {_listed(nodes)}."]
    for topic, news in topology.topics.items():
        rate = f" ({_rate_text(news.rate)})" if news.rate is not None else ""
        said.append(f"{topic}{rate}: from {_listed(news.publishers)} to {_listed(news.subscribers)}.")
    if topology.more:
        said.append(f"And {topology.more:,} more.")
    return " ".join(said)


def _listed(names: Sequence[str]) -> str:
    return ", ".join(names) or "nobody"
