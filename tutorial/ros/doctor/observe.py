"""Collect the facts about a topic from the node graph, from the messages that arrive, and from other domains.

The doctor only subscribes; it publishes nothing on the topic. Its node is hidden, like the node of a ``ros2`` command.
"""

from __future__ import annotations

import asyncio
import time
from collections import Counter
from collections.abc import Iterable, Sequence
from contextlib import ExitStack, suppress
from dataclasses import replace
from itertools import islice
from typing import Any

import rclpy
from rclpy.context import Context
from rclpy.node import Node
from rclpy.qos import (
    DurabilityPolicy,
    LivelinessPolicy,
    ReliabilityPolicy,
)
from rclpy.serialization import deserialize_message
from rclpy.topic_endpoint_info import TopicEndpointInfo
from rclpy.utilities import get_rmw_implementation_identifier

from tutorial.errors import TutorialError
from tutorial.joints import JointMatcher
from tutorial.ros.chaos.stream import JOINTS, TOPIC
from tutorial.ros.doctor.facts import Endpoint, Facts, Topic
from tutorial.ros.doctor.machine import domains_in_use, participants, programs, reach
from tutorial.ros.topics.endpoints import publishers_on, reader_qos, subscriptions_on
from tutorial.ros.topics.graph import NAMELESS
from tutorial.ros.topics.names import EVERY_NODE_HAS, full_name, is_valid_topic, message_class

LOOK = 3.8  # [s] duration of the whole observation, which takes a little longer if the publisher appears late
LISTEN = 1.2  # [s] minimum time to wait for messages; Fast DDS discovers nodes after 1 to 4 s
ALONE_AFTER = 1.0  # [s] to wait for a publisher before the other domains are searched
READ_EVERY = 0.1  # [s] between two reads of the graph
JOINT_STATE = "sensor_msgs/msg/JointState"
CLOCK = "/clock"
# [s] how long a publisher's stored messages can still arrive; after that, an old stamp only shows that another clock
# is behind
KEPT_FOR = 2.0
MATCHED = 1000  # maximum number of joint states to match
TOPICS = 300  # maximum number of topics to compare
FOREVER = 2**62  # [ns]; longer durations mean that there is no limit


async def observe(
    node: Node,
    topic: str,
    joints: Iterable[str] | None = None,
    domains: Sequence[int] = (),
) -> Facts:
    """Collect the facts about a topic.

    Args:
        node: the node that subscribes; it must be spinning on another thread.
        topic: the topic's full name.
        joints: for joint states, the names of the viewer's joints. None means the tank's joints on the tank's topic,
            and the joints in the first message on any other topic.
        domains: the other domains to search if nobody publishes the topic.
    """
    began = time.monotonic()
    deadline = began + LOOK
    ears: dict[str, _Ear] = {}
    with ExitStack() as stack:
        others = [each for each in domains if each != node.context.get_domain_id()]
        elsewhere = stack.enter_context(_Elsewhere(topic, others))
        while time.monotonic() < deadline:
            for name in {topic, CLOCK} - ears.keys():
                if kind := _installed(*_endpoints(node, name)):
                    ears[name] = stack.enter_context(_Ear(node, name, kind))
                    deadline = max(deadline, ears[name].since + LISTEN)
            if time.monotonic() > began + ALONE_AFTER and not _endpoints(node, topic)[0]:
                await asyncio.to_thread(elsewhere.search)
            await asyncio.sleep(READ_EVERY)
        facts = await asyncio.to_thread(_read_graph, node, topic)
        if topic in ears:
            facts = replace(facts, **ears[topic].facts(), **_matched(ears[topic], facts, joints))
        return replace(
            facts,
            clock_ticks=len(ears[CLOCK].arrivals) if CLOCK in ears else 0,
            looked_into=tuple(elsewhere.domains) if elsewhere.searched else (),
            found_in=elsewhere.found(),
            participants=participants(facts.domain) if "cyclonedds" in facts.rmw and not facts.publishers else 0,
            programs=() if facts.received else tuple(await asyncio.to_thread(programs)),
        )


class _Ear:
    """A subscription that counts messages and stores joint states without decoding them.

    Attributes:
        since: when the subscription was created, according to `time.monotonic` [s].
        kind: the name of the message type.
        arrivals: the time of arrival of each message published since then [s].
        kept: the number of messages that arrived but had been published before then.
        payloads: the first joint states that arrived, at most `MATCHED`.
    """

    def __init__(self, node: Node, topic: str, kind: str) -> None:
        self._node: Any = node
        self.since, self._since_ns, self.kind = time.monotonic(), time.time_ns(), kind
        self.arrivals: list[float] = []
        self.kept = 0
        self.payloads: list[bytes] = []
        qos = reader_qos(node, topic)
        self._subscription = self._node.create_subscription(message_class(kind), topic, self._hear, qos, raw=True)

    def __enter__(self) -> _Ear:
        return self

    def __exit__(self, *_: object) -> None:
        self._node.destroy_subscription(self._subscription)

    def _hear(self, payload: bytes, info: dict[str, int]) -> None:
        """Count a message. Runs on the executor's thread."""
        if info["source_timestamp"] < self._since_ns and time.monotonic() < self.since + KEPT_FOR:
            self.kept += 1
            return
        self.arrivals.append(time.monotonic())
        if self.kind == JOINT_STATE and len(self.payloads) < MATCHED:
            self.payloads.append(payload)

    def facts(self) -> dict[str, Any]:
        """Return the facts about the messages received so far."""
        arrivals = self.arrivals.copy()
        span = arrivals[-1] - arrivals[0] if arrivals else 0.0
        rate = (len(arrivals) - 1) / span if span > 0 else 0.0
        return {
            "seconds": time.monotonic() - self.since,
            "received": len(arrivals),
            "rate": rate,
            "kept": self.kept,
        }


class _Elsewhere(ExitStack):
    """Searches other domains for publishers of a topic, with the same middleware and the same discovery range.

    If the discovery range is LOCALHOST, it joins only domains whose ports are in use. On exit, it leaves all
    domains that it has joined.
    """

    def __init__(self, topic: str, domains: list[int]) -> None:
        super().__init__()
        self._topic, self.domains = topic, domains
        self.searched = False
        self._nodes: dict[int, Node] = {}

    def search(self) -> None:
        """Join the domains on the first call; later calls do nothing."""
        if self.searched:
            return
        self.searched = True
        for domain in domains_in_use(self.domains) if reach() == "LOCALHOST" else self.domains:
            with suppress(RuntimeError):  # this domain is full
                context = Context()
                rclpy.init(context=context, domain_id=domain)
                self.callback(context.try_shutdown)
                node = Node("_doctor", context=context, enable_rosout=False, start_parameter_services=False)
                self.callback(node.destroy_node)
                self._nodes[domain] = node

    def found(self) -> tuple[int, ...]:
        """Return the domains with publishers of the topic."""
        return tuple(domain for domain, node in self._nodes.items() if publishers_on(node, self._topic))


def _endpoints(node: Node, topic: str) -> tuple[tuple[Endpoint, ...], tuple[Endpoint, ...]]:
    """Return the topic's publishers and subscriptions, including the node's own."""
    # The real rclpy lists no endpoints at all if any name is not valid UTF-8.
    with suppress(RuntimeError, UnicodeDecodeError):
        publishers, subscriptions = publishers_on(node, topic), subscriptions_on(node, topic)
        return tuple(map(_endpoint, publishers)), tuple(map(_endpoint, subscriptions))
    return (), ()


def _endpoint(info: TopicEndpointInfo) -> Endpoint:
    qos, hashed = info.qos_profile, str(info.topic_type_hash)
    return Endpoint(
        node="" if info.node_name == NAMELESS else full_name(info.node_name, info.node_namespace),
        type=info.topic_type,
        hash="" if hashed == "INVALID" else hashed,
        reliable=qos.reliability == ReliabilityPolicy.RELIABLE,
        transient_local=qos.durability == DurabilityPolicy.TRANSIENT_LOCAL,
        deadline=_seconds(qos.deadline.nanoseconds),
        manual=qos.liveliness == LivelinessPolicy.MANUAL_BY_TOPIC,
        lease=_seconds(qos.liveliness_lease_duration.nanoseconds),
        lifespan=_seconds(qos.lifespan.nanoseconds),
    )


def _seconds(nanoseconds: int) -> float:
    return nanoseconds / 1e9 if 0 < nanoseconds < FOREVER else float("inf")


def _installed(publishers: Sequence[Endpoint], subscriptions: Sequence[Endpoint]) -> str:
    """Return an installed type of a publisher, preferably one that a subscription also has; empty if there is none."""
    wanted = {each.type for each in subscriptions}
    for kind in sorted({each.type for each in publishers}, key=lambda each: each not in wanted):
        with suppress(TutorialError):
            message_class(kind)
            return kind
    return ""


def _read_graph(node: Node, topic: str) -> Facts:
    """Return the facts that the node graph shows."""
    publishers, subscriptions = _endpoints(node, topic)
    me = full_name(node.get_name(), node.get_namespace())
    clocks, clock_users = _endpoints(node, CLOCK)
    return Facts(
        topic,
        domain=node.context.get_domain_id(),
        reach=reach(),
        rmw=get_rmw_implementation_identifier(),
        publishers=tuple(each for each in publishers if each.node != me),  # the doctor also publishes on /rosout
        subscriptions=tuple(each for each in subscriptions if each.node != me),
        here=next((replace(each, node="the doctor") for each in subscriptions if each.node == me), None),
        installed=not publishers or bool(_installed(publishers, subscriptions)),
        topics=_other_topics(node, topic),
        clock_users=tuple(each.node for each in clock_users if each.node != me),
        clock_publishers=len(clocks),
    )


def _other_topics(node: Node, topic: str) -> tuple[Topic, ...]:
    listed: list[tuple[str, list[str]]] = []
    with suppress(RuntimeError, UnicodeDecodeError):
        listed = node.get_topic_names_and_types()
    others = (each for each in listed if each[0] not in (topic, *EVERY_NODE_HAS) and is_valid_topic(each[0]))
    return tuple(Topic(name, tuple(types), node.count_publishers(name)) for name, types in islice(others, TOPICS))


def _matched(ear: _Ear, facts: Facts, joints: Iterable[str] | None) -> dict[str, Any]:
    """Match the received joint states as a viewer does, and return the facts about those that move no joint."""
    complaints: Counter[str] = Counter()
    joints = JOINTS if joints is None and facts.topic == TOPIC else joints
    matcher = JointMatcher(joints, lambda: len(facts.publishers)) if joints is not None else None
    for payload in ear.payloads.copy():
        try:
            message: Any = deserialize_message(payload, message_class(ear.kind))
        except Exception:  # noqa: BLE001 - the bytes can be anything if the definitions differ
            continue
        matcher = matcher or JointMatcher(message.name, lambda: len(facts.publishers))
        positions, report = matcher.match(message)
        if not positions:
            complaints[str(report)] += 1
    most = complaints.most_common(1)
    return {"unmoved": complaints.total(), "complaint": most[0][0] if most else ""}
