"""Lays a directed graph out in layers from left to right, after Sugiyama, Tagawa and Toda (1981).

Edges that would close a circle run from right to left; an edge over several layers gets a lane of its own in each.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from graphlib import TopologicalSorter
from itertools import pairwise

__all__ = ["Edge", "Layout", "Place", "Vertex", "lay_out"]

Vertex = tuple[str, ...]
Edge = tuple[Vertex, Vertex]
Place = tuple[float, float]
Size = tuple[float, float]

GAP = 44.0  # [px] between two layers, for the arrows
SPACING = 18.0  # [px] between two shapes of one layer
LANE_HEIGHT = 8.0  # [px] that an edge takes in a layer it only passes
SWEEPS = 8


@dataclass(frozen=True)
class Layout:
    """Where everything is [px].

    Attributes:
        places: the middle of each vertex.
        lanes: for each edge that passes layers, where it comes into each and leaves it, in the edge's direction.
        backward: the edges that run from right to left.
        size: width and height of all.
    """

    places: dict[Vertex, Place]
    lanes: dict[Edge, list[Place]]
    backward: set[Edge]
    size: Size


def lay_out(sizes: Mapping[Vertex, Size], edges: Sequence[Edge]) -> Layout:
    """Find a place for each vertex.

    Args:
        sizes: width and height of each vertex [px].
        edges: from where to where; both ends are vertices, and differ.
    """
    backward = _closing(list(sizes), edges)
    forward = {(b, a) if (a, b) in backward else (a, b): (a, b) for a, b in edges}
    layer = _layers(list(sizes), list(forward))
    heights: dict[Vertex, float] = {vertex: height for vertex, (_, height) in sizes.items()}
    links: list[Edge] = []
    chains: dict[Edge, list[Vertex]] = {}
    for a, b in forward:
        lanes_in = {("lane", *a, *b, str(i)): i for i in range(layer[a] + 1, layer[b])}
        chains[a, b] = list(lanes_in)
        layer.update(lanes_in)
        heights.update(dict.fromkeys(lanes_in, LANE_HEIGHT))
        links += pairwise([a, *lanes_in, b])
    columns = _ordered(layer, links)
    y = _heights(columns, heights, links)
    spans = _spans(columns, {vertex: size[0] for vertex, size in sizes.items()})
    lanes = {
        forward[edge]: [(x, y[lane]) for lane in chain for x in spans[layer[lane]]]
        for edge, chain in chains.items()
        if chain
    }
    for edge in backward & lanes.keys():
        lanes[edge].reverse()
    height = max((y[vertex] + heights[vertex] / 2 for vertex in y), default=0.0)
    places = {vertex: (sum(spans[layer[vertex]]) / 2, y[vertex]) for vertex in sizes}
    return Layout(places, lanes, backward, (spans[-1][1] if spans else 0.0, height))


def _closing(vertices: Sequence[Vertex], edges: Sequence[Edge]) -> set[Edge]:
    """The edges that close a circle, as a walk through the graph meets them."""
    following = _neighbours(edges)
    entered = {b for _, b in edges}
    closing: set[Edge] = set()
    finished: set[Vertex] = set()

    def walk(path: tuple[Vertex, ...]) -> None:
        for after in following[path[-1]]:
            if after in path:
                closing.add((path[-1], after))
            elif after not in finished:
                walk((*path, after))
        finished.add(path[-1])

    for start in sorted(vertices, key=lambda vertex: vertex in entered):  # those nobody leads to come first
        if start not in finished:
            walk((start,))
    return closing


def _layers(vertices: Sequence[Vertex], edges: Sequence[Edge]) -> dict[Vertex, int]:
    """Number the layers: each vertex is right of all that lead to it, and those nobody leads to beside the next."""
    before, after = _neighbours((b, a) for a, b in edges), _neighbours(edges)
    layer = dict.fromkeys(vertices, 0)
    for vertex in TopologicalSorter(before).static_order():
        layer[vertex] = max((layer[a] + 1 for a in before[vertex]), default=0)
    for vertex in vertices:
        if after[vertex] and not before[vertex]:
            layer[vertex] = min(layer[b] for b in after[vertex]) - 1
    return layer


def _ordered(layer: Mapping[Vertex, int], links: Sequence[Edge]) -> list[list[Vertex]]:
    """Put each layer's vertices into an order with few crossings: by the middle of their neighbours' places."""
    columns: list[list[Vertex]] = [[] for _ in range(max(layer.values(), default=-1) + 1)]
    for vertex in layer:
        columns[layer[vertex]].append(vertex)
    before, after = _neighbours((b, a) for a, b in links), _neighbours(links)
    for sweep in range(SWEEPS):
        neighbours, order = (before, columns) if sweep % 2 == 0 else (after, columns[::-1])
        rank = {vertex: i / len(column) for column in columns for i, vertex in enumerate(column)}
        for column in order:
            wish = {v: _mean([rank[n] for n in neighbours[v]], rank[v]) for v in column}
            column.sort(key=wish.__getitem__)
            rank.update({vertex: i / len(column) for i, vertex in enumerate(column)})
    return columns


def _heights(
    columns: Sequence[Sequence[Vertex]], heights: Mapping[Vertex, float], links: Sequence[Edge]
) -> dict[Vertex, float]:
    """Find each vertex's place from top to bottom: near its neighbours, in its layer's order, without overlaps."""
    beside = _neighbours((*links, *((b, a) for a, b in links)))
    y: dict[Vertex, float] = dict.fromkeys((v for column in columns for v in column), 0.0)
    for sweep in range(2 * SWEEPS):
        for column in columns if sweep % 2 == 0 else columns[::-1]:
            wishes = [_mean([y[n] for n in beside[v]], y[v]) for v in column]
            y.update(zip(column, _spread(wishes, [heights[v] for v in column])))
    top = min((y[vertex] - heights[vertex] / 2 for vertex in y), default=0.0)
    return {vertex: place - top for vertex, place in y.items()}


def _spread(wishes: Sequence[float], heights: Sequence[float]) -> list[float]:
    """Move places apart as far as their heights demand: half of it downwards, half upwards."""
    down, up = list(wishes), list(wishes)
    for i in range(1, len(wishes)):
        down[i] = max(down[i], down[i - 1] + (heights[i - 1] + heights[i]) / 2 + SPACING)
    for i in range(len(wishes) - 2, -1, -1):
        up[i] = min(up[i], up[i + 1] - (heights[i] + heights[i + 1]) / 2 - SPACING)
    return [(a + b) / 2 for a, b in zip(down, up)]


def _spans(columns: Sequence[Sequence[Vertex]], widths: Mapping[Vertex, float]) -> list[Place]:
    """Where each layer begins and ends, from left to right."""
    spans, left = [], 0.0
    for column in columns:
        right = left + max((widths.get(vertex, 0.0) for vertex in column), default=0.0)
        spans.append((left, right))
        left = right + GAP
    return spans


def _neighbours(edges: Iterable[Edge]) -> defaultdict[Vertex, list[Vertex]]:
    following: defaultdict[Vertex, list[Vertex]] = defaultdict(list)
    for a, b in edges:
        following[a].append(b)
    return following


def _mean(values: Sequence[float], otherwise: float) -> float:
    return sum(values) / len(values) if values else otherwise
