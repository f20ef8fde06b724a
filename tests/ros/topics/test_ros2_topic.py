"""The output of tutorial/ros/topics, compared with that of a real ``ros2 topic``."""

import asyncio
from collections.abc import Iterator
from contextlib import aclosing
from itertools import chain, repeat
from unittest.mock import Mock

import pytest
import yaml
from diagnostic_msgs.msg import DiagnosticStatus, KeyValue
from programs import until
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy
from rclpy.time import Time
from recorded import joint_state, recorded, recorded_nodes
from sensor_msgs.msg import Image, Imu, Joy
from std_msgs.msg import Empty, Float32MultiArray, String

from tutorial.errors import TutorialError
from tutorial.ros.node_thread import MeteredNode, NodeThread
from tutorial.ros.topics import graph
from tutorial.ros.topics.endpoints import reader_qos
from tutorial.ros.topics.graph import QUIET_READS, READ_EVERY, wait_for_graph
from tutorial.ros.topics.listening import topic_echo, topic_hz
from tutorial.ros.topics.listing import topic_info, topic_list
from tutorial.ros.topics.message_yaml import field_text, message_to_yaml
from tutorial.ros.topics.names import escape_name, is_valid_topic, message_class

JOINT_STATE = "/Tank/joint_state"


@pytest.fixture
def asker(domain: int) -> Iterator[MeteredNode]:
    """The node that runs the commands, hidden like the one of ``ros2``."""
    with NodeThread("_asker") as thread:
        yield thread.node


async def first(texts) -> str:
    async with aclosing(texts):
        return await anext(texts)


def refusal(texts) -> str:
    """Return the error that is raised instead of a first text."""
    with pytest.raises(TutorialError) as caught:
        asyncio.run(first(texts))
    return str(caught.value)


@pytest.fixture
def met(asker) -> Iterator[MeteredNode]:
    """The same node, beside the recorded nodes. At the end, it must have destroyed its subscriptions."""
    with recorded_nodes():
        yield asker
    assert not list(asker.subscriptions)


class TestGraph:
    def test_hidden_topics_are_not_listed_and_names_are_escaped(self, asker, monkeypatch):
        found = [("/Tank/_secret", []), ("/_secret", []), ("/Tank/plain_", ["a\nb", "c"]), ("/a\r\nforge", ["x"])]
        monkeypatch.setattr(asker, "get_topic_names_and_types", lambda: found)
        assert asyncio.run(topic_list(asker, show_types=True)) == "/Tank/plain_ [a\\nb, c]\n/a\\r\\nforge [x]\n"

    def test_the_wait_gives_up_when_the_graph_keeps_changing(self, asker, monkeypatch):
        nodes = iter(range(1000))
        monkeypatch.setattr(asker, "get_node_names_and_namespaces", lambda: [(f"node{next(nodes)}", "/")])
        assert not asyncio.run(wait_for_graph(asker, timeout=0.3))


class TestEcho:
    def test_unknown_field(self, met):
        said = refusal(topic_echo(met, JOINT_STATE, field="header.positions"))
        assert "Invalid field 'header.positions': 'Header' object has no attribute" in said

    def test_two_types_on_one_topic(self, asker):
        with NodeThread("_one") as one, NodeThread("_other") as other:  # Fast DDS allows only one type for each
            publisher = one.node.create_publisher(String, "/both", 1)
            one.node.create_timer(0.05, lambda: publisher.publish(String(data="here")))
            other.node.create_publisher(Joy, "/both", 1)
            assert refusal(topic_echo(asker, "/both")) == (
                "Cannot echo topic '/both', as it contains more than one type: "
                "[sensor_msgs/msg/Joy, std_msgs/msg/String]"
            )
            assert asyncio.run(first(topic_echo(asker, "both", "std_msgs/String"))) == "data: here\n---\n"
            text = asyncio.run(topic_info(asker, "/both"))
            assert text.startswith("Type: ['sensor_msgs/msg/Joy', 'std_msgs/msg/String']\n")


class TestHz:
    def test_an_unknown_topic_is_waited_for(self, asker):
        async def watch():
            async with aclosing(topic_hz(asker, "/late")) as texts:
                warning = await anext(texts)
                publisher = asker.create_publisher(String, "/late", 1)
                timer = asker.create_timer(0.01, lambda: publisher.publish(String()))
                rate = await anext(texts)
                timer.destroy()
                return warning, rate

        warning, rate = asyncio.run(watch())
        assert warning == recorded("ros2 topic hz /nothing").replace("/nothing", "/late")
        assert rate.startswith("average rate: ")
        assert not list(asker.subscriptions)

    def test_the_newest_intervals_count_and_a_jump_back_resets_them(self, asker, monkeypatch):
        times = chain([0, 10, 10.5, 11, 3, 3.25, 3.5, 3.75], repeat(4))  # one for each message
        clock = Mock(ros_time_is_active=True, now=lambda: Time(seconds=next(times)))
        publisher = asker.create_publisher(String, "/now_and_then", 1)
        asker.create_timer(0.01, lambda: publisher.publish(String()))
        monkeypatch.setattr(asker, "get_clock", lambda: clock)

        async def watch():
            async with aclosing(topic_hz(asker, "/now_and_then", window=3)) as texts:
                return await anext(texts), await anext(texts)

        figures = "average rate: {:.3f}\n\tmin: {:.3f}s max: {:.3f}s std dev: 0.00000s window: {}\n"
        assert asyncio.run(watch()) == (figures.format(2, 0.5, 0.5, 2), figures.format(4, 0.25, 0.25, 3))

    def test_a_missing_topic_or_message_is_reported(self, met):
        async def watch():
            async with aclosing(topic_hz(met, "/never", timeout=0.1)) as texts:
                await anext(texts)  # the warning
                yield await anext(texts)

        said = "no message arrived on {} within 0.1 s; it has {}."
        assert said.format("/never", "0 publishers") in refusal(watch())
        for look in (topic_hz, topic_echo):
            assert said.format("/joy", "1 publisher") in refusal(look(met, "/joy", timeout=0.1))


class TestQoS:
    RELIABLE, BEST_EFFORT = ReliabilityPolicy.RELIABLE, ReliabilityPolicy.BEST_EFFORT
    LASTING, VOLATILE = DurabilityPolicy.TRANSIENT_LOCAL, DurabilityPolicy.VOLATILE

    @pytest.mark.parametrize(
        ("offered", "asked"),
        [
            ([], (BEST_EFFORT, VOLATILE)),
            ([(RELIABLE, LASTING)], (RELIABLE, LASTING)),
            ([(RELIABLE, LASTING), (RELIABLE, VOLATILE)], (RELIABLE, VOLATILE)),
            ([(RELIABLE, VOLATILE), (BEST_EFFORT, VOLATILE)], (BEST_EFFORT, VOLATILE)),
        ],
    )
    def test_a_reader_asks_for_what_all_publishers_offer(self, asker, offered, asked):
        for reliability, durability in offered:
            asker.create_publisher(String, "/x", QoSProfile(depth=1, reliability=reliability, durability=durability))
        until(lambda: len(asker.get_publishers_info_by_topic("/x")) == len(offered), "the publishers")
        qos = reader_qos(asker, "/x")
        assert (qos.reliability, qos.durability) == asked


HALF, KEY_VALUE = "- 0.5\n", "- key: a\n  value: '1'\n"


class TestYaml:
    @pytest.mark.parametrize(
        ("message", "part"),
        [
            (String(data="Panzer für 3: 'x'"), "^data: 'Panzer für 3: ''x'''\n$"),
            (String(data="a b " * 40), f"^data: {'a b ' * 32}...\n$"),
            (String(data="a\nb"), "^data: 'a\n\n  b'\n$"),
            (Empty(), "^{}\n$"),
            (DiagnosticStatus(level=b"\x02"), '^level: "\\x02"\n'),
            (Image(data=bytes(range(200))), "data:\n- 0\n- 1\n"),
            (DiagnosticStatus(values=[KeyValue(key="a", value="1")] * 2), f"values:\n{2 * KEY_VALUE}$"),
            (Imu(), "orientation_covariance:\n- 0.0\n- 0.0\n"),
            (Float32MultiArray(data=[0.5] * 128), f"data:\n{128 * HALF}$"),
            (Float32MultiArray(data=[0.5] * 129), f"data:\n{128 * HALF}- '...'\n$"),
        ],
    )
    def test_the_text(self, message, part):
        """``^`` and ``$`` mark its beginning and end."""
        assert part in f"^{message_to_yaml(message)}$"

    @pytest.mark.parametrize(
        "text",
        ["\x1b[2J", "\x00\x7f\x9b", "\u202egpj", "a\n\u2028---\u2029", "\ufeff", "\x85", "half \ud800", "\\\u202e'\""],
    )
    def test_invisible_characters_are_escaped_and_read_back_unchanged(self, text):
        written = message_to_yaml(String(data=text))
        assert written.startswith('data: "')
        assert written.removesuffix("\n").isprintable()
        assert yaml.safe_load(written) == {"data": text}
        assert field_text(String(data=text), "data").replace("\n", "").isprintable()

    def test_a_multiline_string_stays_multiline(self):
        assert field_text(String(data="a\n\tb\n"), "data") == "a\n\\tb\n\n---\n"

    @pytest.mark.parametrize(
        "name",
        ["sensor_msgs/msg/Joyy", "no_such_msgs/msg/Joy", "Joy", "//Joy", "os/path/join", "a.b/msg/C"],
    )
    def test_unknown_message_types_are_refused(self, name):
        with pytest.raises(TutorialError) as caught:
            message_class(name)
        assert str(caught.value) == f"The message type '{name}' is invalid"

    def test_a_type_name_from_the_network_imports_no_other_module(self, tmp_path, monkeypatch):
        """An import runs code: Python's own module ``antigravity`` opens a browser."""
        (tmp_path / "trap").mkdir()
        (tmp_path / "trap" / "__init__.py").write_text("raise SystemExit")
        (tmp_path / "trapped.py").write_text("raise SystemExit")
        monkeypatch.syspath_prepend(tmp_path)
        for name in ("trap/msg/X", "trapped/msg/X", "trap/trap/X", f"trap/msg/{'X' * 300}"):
            with pytest.raises(TutorialError, match="The message type 'tr"):
                message_class(name)


class TestNames:
    def test_a_name_is_cut_at_ros_2s_maximum(self):
        assert escape_name("/" + "a" * 254) == "/" + "a" * 254
        assert escape_name("\x1b" + "a" * 1254) == r"\x1b" + "a" * 254 + "... and 1,000 more characters"

    @pytest.mark.parametrize("topic", ["/1abc", "/a/", "//x", "/", "/<b>x</b>", "/half\ud800", "joy"])
    def test_invalid_topics_are_escaped(self, topic):
        assert not is_valid_topic(topic)


class TestNoArr:
    def test_sequences_and_arrays(self):
        assert "position: '<sequence type: double, length: 2>'\n" in message_to_yaml(joint_state(), no_arr=True)
        assert "orientation_covariance: '<array type: double[9]>'\n" in message_to_yaml(Imu(), no_arr=True)
        message = DiagnosticStatus(values=[KeyValue()])
        assert "<sequence type: diagnostic_msgs/msg/KeyValue, length: 1>" in message_to_yaml(message, no_arr=True)


def settle(asker, **how):
    return asyncio.run(wait_for_graph(asker, timeout=4 * QUIET_READS * READ_EVERY, **how))


@pytest.mark.pocket
def test_it_waits_for_a_discovered_ros_2_program(asker, stranger):
    assert not settle(asker)


@pytest.mark.pocket
def test_it_waits_until_all_nodes_and_endpoints_are_known(asker, stranger, monkeypatch):
    monkeypatch.setattr(graph, "DISCOVERY_TIMEOUT", 0.0)

    async def announced_in_the_meantime():
        waiting = asyncio.create_task(wait_for_graph(asker, timeout=60.0))
        await asyncio.sleep(0)  # its first query
        stranger.announce(stranger.listing("late"))
        return await waiting

    assert asyncio.run(announced_in_the_meantime())
    assert "late" in asker.get_node_names()
    stranger.announce(stranger.listing("late", writers=1))
    assert not settle(asker), "one of its publishers is still missing"


@pytest.mark.pocket
def test_it_does_not_wait_for_a_plain_dds_program(asker, domain):
    from cyclonedds.domain import DomainParticipant

    other = DomainParticipant(domain)
    assert asyncio.run(wait_for_graph(asker, timeout=60.0))
    del other


@pytest.mark.pocket
def test_it_waits_longer_for_the_requested_topic(asker, monkeypatch):
    monkeypatch.setattr(graph, "DISCOVERY_TIMEOUT", 60.0)
    looks = iter([False, False, True])
    assert asyncio.run(wait_for_graph(asker, timeout=60.0, wanted=lambda: next(looks)))
    assert next(looks, "all taken") == "all taken"
