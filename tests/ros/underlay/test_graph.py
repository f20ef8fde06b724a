"""The node graph where what is announced cannot be trusted: too often, too much, or no announcement at all."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator
from typing import Any

import pytest
from rclpy.node import Node
from rmw_dds_common.msg import Gid, NodeEntitiesInfo, ParticipantEntitiesInfo

import tutorial  # noqa: F401

pytestmark = pytest.mark.embedded  # these look behind the scenes

Announce = Callable[[bytes], None]
SpinUntil = Callable[[Callable[[], object]], None]


@pytest.fixture
def other(domain: int) -> Iterator[Any]:
    """Another participant in the domain."""
    from rclpy._domain import join, leave

    participant = join(domain)
    yield participant
    leave(participant, domain)


@pytest.fixture
def announce(other: Any, node: Node, spin_until: SpinUntil) -> Announce:
    """Send bytes as an announcement of the other participant's, once the node is heard of."""
    from rclpy._graph import _WRITER_QOS, DataWriter, Topic, payload_type

    payload = payload_type("rmw_dds_common/msg/ParticipantEntitiesInfo")
    writer = DataWriter(other, Topic(other, "ros_discovery_info", payload), _WRITER_QOS)
    spin_until(lambda: writer.get_publication_matched_status().current_count)
    return lambda data: writer.write(payload(data))


@pytest.fixture
def listing(other: Any) -> Callable[..., bytes]:
    """Return an announcement of nodes by their names."""
    from rclpy._wire import encode

    gid = Gid(data=list(other.guid.bytes))

    def listing(*names: str) -> bytes:
        nodes = [NodeEntitiesInfo(node_namespace="/", node_name=name) for name in names]
        return encode(ParticipantEntitiesInfo(gid=gid, node_entities_info_seq=nodes))

    return listing


@pytest.fixture
def decoded(monkeypatch: pytest.MonkeyPatch) -> list[bytes]:
    """Which announcements are decoded."""
    from rclpy import _graph

    decoded: list[bytes] = []
    decode = _graph.decode
    monkeypatch.setattr(_graph, "decode", lambda data, cls: decoded.append(data) or decode(data, cls))
    return decoded


def test_only_the_newest_of_many_announcements_is_decoded(
    node: Node, announce: Announce, listing: Callable[..., bytes], decoded: list[bytes], spin_until: SpinUntil
) -> None:
    for i in range(200):
        announce(listing(f"number_{i}"))
    spin_until(lambda: "number_199" in node.get_node_names())
    assert decoded == [listing("number_199")]


def test_a_look_comes_to_an_end_where_announcements_keep_coming(
    node: Node,
    announce: Announce,
    listing: Callable[..., bytes],
    monkeypatch: pytest.MonkeyPatch,
    spin_until: SpinUntil,
) -> None:
    from rclpy import _graph

    monkeypatch.setattr(_graph, "AT_ONCE", 8)
    graph = node.context.graph
    for i in range(20):
        announce(listing(f"number_{i}"))
    assert len(graph._reader.read(20)) == 20
    graph.listen()
    assert len(graph._reader.read(20)) == 12
    spin_until(lambda: "number_19" in node.get_node_names())


def test_reading_waits_its_turn(
    node: Node, announce: Announce, listing: Callable[..., bytes], monkeypatch: pytest.MonkeyPatch, other: Any
) -> None:
    """One who announces a lot again and again does not keep the others from being read."""
    from rclpy import _graph

    monkeypatch.setattr(_graph, "LONGEST", len(listing("quiet")))
    graph = node.context.graph
    monkeypatch.setattr(graph, "listen", lambda: graph._unread.update({b"a": listing("noisy")}))
    graph.listen()
    graph._unread |= {b"b": listing("quiet"), b"c": listing("quiet")}
    looks = [sorted(node.get_node_names()[1:]) for _ in range(3)]
    assert looks == [["noisy"], ["noisy", "quiet"], ["noisy", "quiet", "quiet"]]


@pytest.mark.parametrize(
    ("names", "said"),
    [
        (["x" * 200] * 400, "it has .* bytes, at most 32,768 are read"),
        (["no_utf"], ".* bytes are no ParticipantEntitiesInfo: .*"),
    ],
    ids=["long", "broken"],
)
def test_what_is_ignored_is_said_once(
    node: Node,
    announce: Announce,
    listing: Callable[..., bytes],
    names: list[str],
    said: str,
    spin_until: SpinUntil,
    capfd: pytest.CaptureFixture[str],
) -> None:
    graph = node.context.graph
    announce(listing("early"))
    spin_until(lambda: "early" in node.get_node_names())
    for count in range(1, 20):
        announce(listing(*names).replace(b"no_utf", b"no_\xff\xff\xff"))
        spin_until(lambda count=count: node.get_node_names() and graph._ignored == count)
    assert "early" in node.get_node_names()
    announce(listing("late"))
    spin_until(lambda: "late" in node.get_node_names())
    warnings = capfd.readouterr().err.splitlines()
    assert len(warnings) == 1
    assert re.search(rf"\b1 announcements of nodes have been ignored. The last: {said}$", warnings[0])
