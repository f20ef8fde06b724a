"""Lays out a directed graph in layers from left to right, after Sugiyama, Tagawa and Toda (1981).

Edges that would close a cycle run from right to left. An edge that crosses several layers gets a separate row in each
of them.
"""

from collections import defaultdict
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from statistics import mean

Vertex = tuple[str, ...]
Edge = tuple[Vertex, Vertex]
Place = tuple[float, float]

GAP = 44.0  # [px] between layers, for the arrows
ROW = 54.0  # [px] between the centres of shapes in the same column


@dataclass(frozen=True)
class Layout:
    """The positions of a graph's vertices and edges [px].

    Attributes:
        places: the centre of each vertex.
        lanes: for each edge, the points where it enters and leaves each layer that it crosses, from start to end.
        size: the width and height of the layout, provided that no shape is taller than a row.
    """

    places: dict[Vertex, Place]
    lanes: dict[Edge, list[Place]]
    size: Place


def lay_out(widths: Mapping[Vertex, float], edges: Sequence[Edge]) -> Layout:
    """Place each vertex, and route each edge.

    Args:
        widths: the width of each vertex [px].
        edges: pairs of different vertices, the start and the end of each edge.
    """
    layer = _layers(widths, edges)
    chains = {}
    for a, b in edges:
        step = 1 if layer[a] < layer[b] else -1
        passed = {("lane", *a, *b, str(i)): i for i in range(layer[a] + step, layer[b], step)}
        layer |= passed
        chains[a, b] = [a, *passed, b], step
    y = _heights(layer, [link for chain, _ in chains.values() for link in pairwise(chain)])
    spans = _spans(layer, widths)
    lanes = {
        edge: [(x, y[lane]) for lane in chain[1:-1] for x in spans[layer[lane]][::step]]
        for edge, (chain, step) in chains.items()
    }
    places = {vertex: (sum(spans[layer[vertex]]) / 2, y[vertex]) for vertex in widths}
    return Layout(places, lanes, (spans[-1][1], max(y.values()) + ROW / 2) if y else (0.0, 0.0))


def _layers(vertices: Iterable[Vertex], edges: Sequence[Edge]) -> dict[Vertex, int]:
    """Return each vertex's layer: right of its predecessors or, if it has none, just left of its leftmost successor."""
    rank = {vertex: i for i, vertex in enumerate(_ordered(vertices, edges))}
    forward = [(a, b) if rank[a] < rank[b] else (b, a) for a, b in edges]
    before, after = _neighbours((b, a) for a, b in forward), _neighbours(forward)
    layer: dict[Vertex, int] = {}
    for vertex in rank:
        layer[vertex] = max((layer[a] + 1 for a in before[vertex]), default=0)
    for vertex in rank:
        if after[vertex] and not before[vertex]:
            layer[vertex] = min(layer[b] for b in after[vertex]) - 1
    return layer


def _ordered(vertices: Iterable[Vertex], edges: Sequence[Edge]) -> list[Vertex]:
    """Sort the vertices topologically, ignoring edges that close a cycle."""
    after = _neighbours(edges)
    entered = {b for _, b in edges}
    seen: set[Vertex] = set()
    finished: list[Vertex] = []

    def walk(vertex: Vertex) -> None:
        if vertex not in seen:
            seen.add(vertex)
            for following in after[vertex]:
                walk(following)
            finished.append(vertex)

    for start in sorted(vertices, key=entered.__contains__):  # vertices without predecessors first
        walk(start)
    return finished[::-1]


def _heights(layer: Mapping[Vertex, int], links: Sequence[Edge]) -> dict[Vertex, float]:
    """Return each vertex's y. Centre each layer, and sort its vertices by the mean y of their predecessors."""
    before = _neighbours((b, a) if layer[a] < layer[b] else (a, b) for a, b in links)
    columns = defaultdict(list)
    for vertex, number in layer.items():
        columns[number].append(vertex)
    tallest = max(map(len, columns.values()), default=0)
    y: dict[Vertex, float] = {}
    for _, column in sorted(columns.items()):
        column.sort(key=lambda vertex: mean(y[n] for n in before[vertex]) if before[vertex] else 0.0)
        y |= {vertex: ROW * (row + (tallest - len(column) + 1) / 2) for row, vertex in enumerate(column)}
    return y


def _spans(layer: Mapping[Vertex, int], widths: Mapping[Vertex, float]) -> list[Place]:
    """Return the x of each layer's left and right borders."""
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
