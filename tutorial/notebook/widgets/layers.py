"""Lays a directed graph out in layers from left to right, after Sugiyama, Tagawa and Toda (1981).

Edges that would close a circle run from right to left; an edge over several layers gets a row of its own in each.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise

__all__ = ["Edge", "Layout", "Place", "Vertex", "lay_out"]

Vertex = tuple[str, ...]
Edge = tuple[Vertex, Vertex]
Place = tuple[float, float]

GAP = 44.0  # [px] between two layers, for the arrows
ROW = 54.0  # [px] from the middle of one shape to that of the next below
SWEEPS = 24


@dataclass(frozen=True)
class Layout:
    """Where everything is [px].

    Attributes:
        places: the middle of each vertex.
        lanes: for each edge that passes layers, where it comes into each and leaves it, in the edge's direction.
        backward: the edges that run from right to left.
        size: width and height of all, where a shape is at most as high as a row.
    """

    places: dict[Vertex, Place]
    lanes: dict[Edge, list[Place]]
    backward: set[Edge]
    size: Place


def lay_out(widths: Mapping[Vertex, float], edges: Sequence[Edge]) -> Layout:
    """Find a place for each vertex.

    Args:
        widths: of each vertex [px].
        edges: from where to where; both ends are vertices, and differ.
    """
    order, backward = _walk(widths, edges)
    layer = _layers(order, [edge for edge in edges if edge not in backward] + [(b, a) for a, b in backward])
    chains = {}
    for a, b in edges:
        step = 1 if layer[a] < layer[b] else -1
        passed = {("lane", *a, *b, str(i)): i for i in range(layer[a] + step, layer[b], step)}
        layer |= passed
        chains[a, b] = [a, *passed, b]
    y = _heights(layer, [link for chain in chains.values() for link in pairwise(chain)])
    spans = _spans(layer, widths)
    lanes = {}
    for edge, chain in chains.items():
        along = -1 if edge in backward else 1
        lanes[edge] = [(x, y[lane]) for lane in chain[1:-1] for x in spans[layer[lane]][::along]]
    places = {vertex: (sum(spans[layer[vertex]]) / 2, y[vertex]) for vertex in widths}
    return Layout(places, lanes, backward, (spans[-1][1], max(y.values()) + ROW / 2) if y else (0.0, 0.0))


def _walk(vertices: Iterable[Vertex], edges: Sequence[Edge]) -> tuple[list[Vertex], set[Edge]]:
    """Walk through the graph: its vertices, each before all that it leads to, and the edges that close a circle."""
    following = _neighbours(edges)
    entered = {b for _, b in edges}
    finished: dict[Vertex, None] = {}
    closing: set[Edge] = set()

    def walk(path: tuple[Vertex, ...]) -> None:
        for after in following[path[-1]]:
            if after in path:
                closing.add((path[-1], after))
            elif after not in finished:
                walk((*path, after))
        finished[path[-1]] = None

    for start in sorted(vertices, key=entered.__contains__):  # those nobody leads to come first
        if start not in finished:
            walk((start,))
    return list(finished)[::-1], closing


def _layers(order: Sequence[Vertex], edges: Sequence[Edge]) -> dict[Vertex, int]:
    """Number the layers: each vertex is right of all that lead to it, and those nobody leads to beside the next."""
    before, after = _neighbours((b, a) for a, b in edges), _neighbours(edges)
    layer: dict[Vertex, int] = {}
    for vertex in order:
        layer[vertex] = max((layer[a] + 1 for a in before[vertex]), default=0)
    for vertex in order:
        if after[vertex] and not before[vertex]:
            layer[vertex] = min(layer[b] for b in after[vertex]) - 1
    return layer


def _heights(layer: Mapping[Vertex, int], links: Sequence[Edge]) -> dict[Vertex, float]:
    """Find each vertex's place from top to bottom: near its neighbours, with few crossings, without overlaps."""
    beside = _neighbours((*links, *((b, a) for a, b in links)))
    columns = defaultdict(list)
    for vertex, number in layer.items():
        columns[number].append(vertex)
    y = {vertex: ROW * row for column in columns.values() for row, vertex in enumerate(column)}
    for sweep in range(SWEEPS):
        for number in sorted(columns, reverse=sweep % 2 == 1):
            wish = {v: sum(y[n] for n in beside[v]) / len(beside[v]) if beside[v] else y[v] for v in columns[number]}
            columns[number].sort(key=wish.__getitem__)
            y.update(zip(columns[number], _spread([wish[v] for v in columns[number]])))
    top = min(y.values(), default=0.0) - ROW / 2
    return {vertex: place - top for vertex, place in y.items()}


def _spread(wishes: Sequence[float]) -> list[float]:
    """Move rising places apart as far as a row: half of it downwards, half upwards."""
    down, up = list(wishes), list(wishes)
    for i in range(1, len(wishes)):
        down[i] = max(down[i], down[i - 1] + ROW)
        up[-i - 1] = min(up[-i - 1], up[-i] - ROW)
    return [(a + b) / 2 for a, b in zip(down, up)]


def _spans(layer: Mapping[Vertex, int], widths: Mapping[Vertex, float]) -> list[Place]:
    """Where each layer begins and ends, from left to right."""
    spans, left = [], 0.0
    for number in range(max(layer.values(), default=-1) + 1):
        right = left + max(widths.get(vertex, 0.0) for vertex, other in layer.items() if other == number)
        spans.append((left, right))
        left = right + GAP
    return spans


def _neighbours(edges: Iterable[Edge]) -> defaultdict[Vertex, list[Vertex]]:
    following: defaultdict[Vertex, list[Vertex]] = defaultdict(list)
    for a, b in edges:
        following[a].append(b)
    return following
