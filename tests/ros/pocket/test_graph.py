"""The node graph with bad announcements: too many, too large, or not valid."""

import re
from unittest.mock import Mock

import pytest

pytestmark = pytest.mark.pocket  # these test internals


@pytest.fixture
def heard(stranger, node, spin_until):
    """A stranger that the node has discovered."""
    spin_until(lambda: stranger.writer.count_matched())
    return stranger


def test_only_the_newest_of_many_announcements_is_decoded(node, heard, monkeypatch, spin_until):
    from rclpy import _graph

    decode = Mock(wraps=_graph.decode_nodes)
    monkeypatch.setattr(_graph, "decode_nodes", decode)
    for i in range(200):
        heard.announce(heard.listing(f"number_{i}"))
    spin_until(lambda: "number_199" in node.get_node_names())
    decode.assert_called_once_with(heard.listing("number_199"))


def test_reading_ends_although_announcements_keep_coming(node, heard, monkeypatch, spin_until):
    from rclpy import _graph

    monkeypatch.setattr(_graph, "AT_ONCE", 8)
    graph = node.context.graph
    for i in range(20):
        heard.announce(heard.listing(f"number_{i}"))
    assert len(graph.changes.dds.read(20)) == 20
    graph.listen()
    assert len(graph.changes.dds.read(20)) == 12
    spin_until(lambda: "number_19" in node.get_node_names())


def test_reading_waits_its_turn(node, stranger, monkeypatch):
    """A participant with many announcements does not keep those of others from being read."""
    from rclpy import _graph

    monkeypatch.setattr(_graph, "LONGEST", len(stranger.listing("quiet")))
    graph = node.context.graph
    monkeypatch.setattr(graph, "listen", lambda: graph._unread.update({b"a": stranger.listing("noisy")}))
    graph.listen()
    graph._unread |= {b"b": stranger.listing("quiet"), b"c": stranger.listing("quiet")}
    looks = [sorted(node.get_node_names()[1:]) for _ in range(3)]
    assert looks == [["noisy"], ["noisy", "quiet"], ["noisy", "quiet", "quiet"]]


@pytest.mark.parametrize(
    ("names", "said"),
    [
        (["x" * 200] * 400, "it has .* bytes; at most 32,768 are read"),
        (["no_utf"], ".* bytes are not a ParticipantEntitiesInfo: .*"),
    ],
    ids=["long", "broken"],
)
def test_ignored_announcements_are_reported_once(node, heard, names, said, spin_until, capfd):
    graph = node.context.graph
    heard.announce(heard.listing("early"))
    spin_until(lambda: "early" in node.get_node_names())
    ignored = heard.listing(*names).replace(b"no_utf", b"no_\xff\xff\xff")
    for count in range(1, 20):
        heard.announce(ignored)
        spin_until(lambda count=count: node.get_node_names() and graph._ignored == count)
    assert "early" in node.get_node_names()
    heard.announce(heard.listing("late"))
    spin_until(lambda: "late" in node.get_node_names())
    warnings = capfd.readouterr().err.splitlines()
    assert len(warnings) == 1
    assert re.search(rf"\b1 node announcements have been ignored. The last one: {said}$", warnings[0])


@pytest.mark.parametrize("version", ["12.0.1", "11.0.2"])
def test_an_incompatible_cyclone_dds_is_refused_before_use(version, monkeypatch):
    from rclpy import _cyclone

    _cyclone._check_version()
    _cyclone._check_version.cache_clear()
    monkeypatch.setattr("importlib.metadata.version", lambda _: version)
    with pytest.raises(RuntimeError, match=rf"installed version, {version}.* pip install cyclonedds==11\.0\.1$"):
        _cyclone._check_version()
