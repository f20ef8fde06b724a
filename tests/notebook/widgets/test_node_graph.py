"""The picture of the node graph."""

import threading
from itertools import pairwise
from types import SimpleNamespace

import pytest
from hypothesis import given
from hypothesis import strategies as st
from sensor_msgs.msg import JointState, Joy

from tutorial.notebook import node_graph, until
from tutorial.notebook.widgets.graph_picture import picture
from tutorial.notebook.widgets.graph_watch import GraphWatch, TopicNews, Topology
from tutorial.notebook.widgets.layers import GAP, ROW, lay_out
from tutorial.ros.node_thread import NodeThread

from .pages import parsed


def topology(nodes: str | dict[str, int], **topics: tuple[str, str]) -> Topology:
    """Build a graph from names separated by spaces: the nodes, and for each topic its publishers and subscriptions."""
    counts = nodes if isinstance(nodes, dict) else dict.fromkeys(nodes.split(), 1)
    news = {
        f"/{topic}": TopicNews("std_msgs/msg/String", 50.02, tuple(a.split()), tuple(b.split()))
        for topic, (a, b) in topics.items()
    }
    return Topology(counts, news)


CHAIN = topology(
    "/joystick /simulation /viewer", joy=("/joystick", "/simulation"), joint_state=("/simulation", "/viewer")
)


def drawn(graph: Topology):
    svg, alt = picture(graph)
    return parsed(svg), alt


def places(root) -> dict[str, tuple[float, float]]:
    """Return the position of each name."""
    return {text.text: (float(text.get("x")), float(text.get("y"))) for text in root.iter("text")}


def edges_of(arrows: str) -> list[tuple[tuple[str], tuple[str]]]:
    return [((a,), (b,)) for a, b in (arrow.split(">") for arrow in arrows.split())]


def laid_out(arrows: str):
    edges = edges_of(arrows)
    return lay_out({vertex: 100.0 for edge in edges for vertex in edge}, edges)


def test_the_tutorials_chain_is_one_row():
    root, alt = drawn(CHAIN)
    where = places(root)
    chain = [where[name] for name in ("/joystick", "/joy", "/simulation", "/joint_state", "/viewer")]
    assert [x for x, _ in chain] == sorted(x for x, _ in chain)
    assert len({y for _, y in chain[::2]}) == 1
    assert len({y for _, y in chain[1::2]}) == 1
    assert len(list(root.iter("ellipse"))) == 3
    assert len(list(root.iter("rect"))) == 2
    assert len(list(root.iter("polygon"))) == 4
    assert alt == (
        "Nodes: /joystick, /simulation, /viewer. /joy (50 Hz): from /joystick to /simulation. "
        "/joint_state (50 Hz): from /simulation to /viewer."
    )


def test_shared_names_and_topics_with_one_side_only():
    root, alt = drawn(topology({"/tank": 2}, joint_state=("/tank", "/tank")))
    assert "2 nodes with the same name" in places(root)
    assert len(list(root.iter("ellipse"))) == 1
    assert alt.startswith("Nodes: /tank (2 nodes with the same name). ")
    root, alt = drawn(topology("/a /<b>&", heard=("", "/a"), said=("/<b>&", "")))
    assert {"/heard", "/said", "/<b>&"} <= places(root).keys()
    assert "/heard (50 Hz): from nobody to /a. /said (50 Hz): from /<b>& to nobody." in alt
    assert drawn(Topology())[1] == "there are no nodes yet"


@pytest.mark.parametrize(
    ("rate", "text"),
    [(49.96, "50 Hz"), (9.44, "9.4 Hz"), (9.5, "10 Hz"), (0.0, "0 Hz"), (1000.2, "1000 Hz"), (None, None)],
)
def test_rates(rate, text):
    graph = Topology({"/a": 1}, {"/x": TopicNews("T", rate, ("/a",), ())})
    assert places(drawn(graph)[0]).keys() - {text} == {"/a", "/x"}
    assert text is None or text in places(drawn(graph)[0])


def test_hidden_topics_are_counted():
    root, words = drawn(Topology({"/a": 1}, {"/x": TopicNews("T", None, ("/a",), ())}, more=1999))
    assert "and 1,999 more, not shown" in places(root)
    assert words.endswith("And 1,999 more.")


def test_a_source_is_beside_its_target():
    layout = laid_out("a>b b>c z>c")
    assert layout.places["z",][0] == layout.places["b",][0]
    assert lay_out({}, []).size == (0.0, 0.0)


def test_a_cycle_has_one_arrow_back():
    layout = laid_out("a>b b>c c>d d>a")
    ((start, end),) = [edge for edge in layout.lanes if layout.places[edge[0]][0] > layout.places[edge[1]][0]]
    x = [place[0] for place in layout.lanes[start, end]]
    assert x == sorted(x, reverse=True)


def test_a_long_arrow_has_a_separate_lane():
    layout = laid_out("a>b b>c a>c")
    lane = layout.lanes[("a",), ("c",)]
    assert len(lane) == 2
    assert all(abs(y - layout.places["b",][1]) > 20 for _, y in lane)


@given(st.sets(st.tuples(st.integers(0, 9), st.integers(0, 9)).filter(lambda edge: edge[0] != edge[1]), max_size=25))
def test_any_graph_is_laid_out_without_overlaps(numbers):
    layout = laid_out(" ".join(f"{a}>{b}" for a, b in sorted(numbers)))
    columns: dict[float, list[float]] = {}
    for x, y in layout.places.values():
        columns.setdefault(x, []).append(y)
    for column in columns.values():
        assert all(b - a >= ROW - 1e-6 for a, b in pairwise(sorted(column)))
    assert all(b - a >= 100 + GAP for a, b in pairwise(sorted(columns)))
    width, height = layout.size
    assert all(0 <= x <= width and 0 <= y <= height for x, y in layout.places.values())
    assert all(layout.places[a][0] != layout.places[b][0] for a, b in layout.lanes)


class Crowd:
    """A fake node that sees very many nodes and topics; each topic has two nodes."""

    def __init__(self, topics: list[str]) -> None:
        self.topics = topics
        self.asked: list[str] = []

    def get_node_names_and_namespaces(self) -> list[tuple[str, str]]:
        return [(f"node{i:04}" + "n" * 10_000, "/") for i in range(2000)]

    def get_topic_names_and_types(self) -> list[tuple[str, list[str]]]:
        return [(topic, ["what/is/This"]) for topic in self.topics]

    def get_publishers_info_by_topic(self, topic: str, no_mangle: bool = False) -> list[SimpleNamespace]:
        self.asked.append(topic)
        return [SimpleNamespace(node_name=name, node_namespace="/") for name in ("sim", "z_unknown")]

    get_subscriptions_info_by_topic = get_publishers_info_by_topic


def test_with_very_many_topics_it_shows_the_first_ones():
    crowd = Crowd(["/joy", "/Tank/joint_state"])
    watch = GraphWatch(crowd)
    assert list(watch.look().topics) == ["/Tank/joint_state", "/joy"]
    crowd.topics += [f"/a{i:04}" for i in range(2000)]
    crowd.asked.clear()
    graph = watch.look()
    assert {"/joy", "/Tank/joint_state"} < graph.topics.keys()
    assert {"/sim", "/z_unknown"} < graph.nodes.keys()
    assert len(crowd.asked) == 2 * len(graph.topics) == 80
    assert len(graph.nodes) == 40
    assert graph.more == 2002 - 40 + 2002 - 40


def test_long_names_are_shortened():
    svg, words = picture(GraphWatch(Crowd([f"/{'t' * 10_000}"])).look())
    assert len(svg) + len(words) < 100_000
    assert "... and 9,746 more characters" in words


def test_an_invalid_topic_is_queried_by_its_dds_name(domain):
    crowd = Crowd(["//x"])
    assert list(GraphWatch(crowd).look().topics) == ["//x"]
    assert crowd.asked == ["rt//x", "rt//x"]


async def test_the_graph_shows_rates_and_an_ended_one_keeps_its_picture(domain):
    threads = threading.active_count()
    graph = node_graph()
    assert repr(graph) == "NodeGraph()"
    with NodeThread("simulation") as simulation, NodeThread("viewer") as viewer, NodeThread("_hidden") as hidden:
        publisher = simulation.node.create_publisher(JointState, "/Tank/joint_state", 1)
        simulation.node.create_subscription(Joy, "/joy", lambda _: None, 1)
        simulation.node.create_timer(0.02, lambda: publisher.publish(JointState()))
        viewer.node.create_subscription(JointState, "/Tank/joint_state", lambda _: None, 1)
        hidden.node.create_publisher(Joy, "/joy", 1)
        hidden.node.create_publisher(Joy, "/_joy", 1)
        await until(lambda: "/Tank/joint_state (" in graph.alt and "/joy: from nobody to" in graph.alt)
        alt = graph.alt
    assert alt.startswith("Nodes: /simulation, /viewer. /Tank/joint_state (")
    assert alt.endswith(" Hz): from /simulation to /viewer. /joy: from nobody to /simulation.")
    await until(lambda: graph.alt == "there are no nodes yet")
    with NodeThread("tank"), NodeThread("tank"):
        await until(lambda: "/tank (2 nodes with the same name)" in graph.alt)
        graph.end()
    graph.end()
    assert graph.ended
    assert "/tank" in graph.svg
    assert threading.active_count() <= threads


async def test_an_error_of_the_graph_is_shown(domain, monkeypatch):
    """A real ROS 2 raises one while a node with an empty name exists."""

    def fail(_self):
        raise RuntimeError("Failed to get node names: empty node name\n")

    monkeypatch.setattr(GraphWatch, "look", fail)
    graph = node_graph()
    await until(lambda: graph.alt == r"ROS 2 reports: Failed to get node names: empty node name\n")
    monkeypatch.undo()
    await until(lambda: not graph.alt.startswith("ROS 2 reports"))
