"""The doctor on real graphs: each fault is seeded in two variants, and the doctor has to name its cause first.

The tests only use rclpy, so they run on a real ROS 2, too.
"""

import asyncio
import threading
import time
from collections.abc import Callable, Coroutine, Iterator, Mapping
from contextlib import ExitStack, closing
from math import nan
from types import SimpleNamespace
from typing import Any

import pytest
from domains import reserved_domain
from rclpy.duration import Duration
from rclpy.qos import DurabilityPolicy, LivelinessPolicy, QoSProfile, qos_profile_sensor_data
from rosgraph_msgs.msg import Clock
from sensor_msgs.msg import Imu, JointState
from std_msgs.msg import String

from tutorial.ros.chaos.stream import swing
from tutorial.ros.doctor.facts import Facts
from tutorial.ros.doctor.observe import observe
from tutorial.ros.doctor.report import report
from tutorial.ros.doctor.rules import diagnose
from tutorial.ros.node_thread import NodeThread

TOPIC = "/Tank/joint_state"
KEPT = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
MANUAL = QoSProfile(depth=1, liveliness=LivelinessPolicy.MANUAL_BY_TOPIC)
SIM_TIME = ["--ros-args", "-p", "use_sim_time:=true"]


def within(deadline: float) -> QoSProfile:
    return QoSProfile(depth=1, deadline=Duration(seconds=deadline))


def alive(lease: float) -> QoSProfile:
    return QoSProfile(depth=1, liveliness_lease_duration=Duration(seconds=lease))


class Graph:
    """Publishers and subscriptions in a domain of their own, each with a node of its own, and the doctor's node."""

    def __init__(self) -> None:
        self._stack, self.ended = ExitStack(), threading.Event()
        self.domain = self._stack.enter_context(reserved_domain())
        self.doctor = self.node("_doctor")

    def node(self, name: str, *args: str) -> Any:
        with pytest.MonkeyPatch.context() as patch:
            patch.setenv("ROS_DOMAIN_ID", str(self.domain))
            return self._stack.enter_context(NodeThread(name, args)).node

    def publish(self, kind=JointState, topic=TOPIC, qos=10, rate=20.0, make=None, args=()) -> Any:
        """Publish at a rate [Hz]; 0 means never."""
        node = self.node(f"tank{len(NodeThread.alive)}", *args)
        publisher = node.create_publisher(kind, topic, qos)
        numbers = iter(range(10**6))
        if rate:
            make = make or (swing if kind is JointState else lambda _: kind())
            node.create_timer(1 / rate, lambda: publisher.publish(make(next(numbers))))
        return publisher

    def subscribe(self, kind=JointState, topic=TOPIC, qos=10) -> None:
        self.node(f"viewer{len(NodeThread.alive)}").create_subscription(kind, topic, lambda _: None, qos)

    def facts(self, topic: str = TOPIC, domains: tuple[int, ...] = ()) -> Coroutine[Any, Any, Facts]:
        return observe(self.doctor, topic, domains=domains)

    def close(self) -> None:
        self.ended.set()
        self._stack.close()


@pytest.fixture
def graph() -> Iterator[Graph]:
    with closing(Graph()) as graph:
        yield graph


def facts_of_each(faults: Mapping[Any, Callable[[Graph], str]]) -> dict[Any, Facts]:
    """Seed each fault in a domain of its own, and let the doctor examine them all at the same time."""

    async def look(asked: list[Coroutine[Any, Any, Facts]]) -> list[Facts]:
        return await asyncio.gather(*asked)

    with ExitStack() as stack:
        graphs = {key: stack.enter_context(closing(Graph())) for key in faults}
        asked = [graphs[key].facts(fault(graphs[key])) for key, fault in faults.items()]
        return dict(zip(faults, asyncio.run(look(asked)), strict=True))


def pair(publish: dict, subscribe: dict, topic: str = TOPIC):
    """Return a fault: a publisher, and a subscription that is incompatible with it."""

    def fault(graph: Graph) -> str:
        graph.publish(**publish)
        graph.subscribe(**subscribe)
        return topic

    return fault


def once(kind: Any, topic: str):
    """Return a fault: a publisher that keeps its message, and a later subscription that is volatile."""

    def fault(graph: Graph) -> str:
        graph.publish(kind, topic, KEPT, rate=0).publish(kind())
        graph.subscribe(kind, topic)
        return topic

    return fault


def once_volatile(graph: Graph) -> str:
    graph.publish(String, "/robot_description", rate=0).publish(String())
    graph.subscribe(String, "/robot_description")
    return "/robot_description"


def clock_stands(graph: Graph) -> str:
    graph.publish(Clock, "/clock", rate=0)
    graph.publish(args=SIM_TIME)
    return TOPIC


def blocked(graph: Graph) -> str:
    """Block the publishing timer with a callback that does not return."""
    graph.publish(make=lambda _: JointState(name=[str(graph.ended.wait(60))]))
    return TOPIC


def backwards(number: int) -> JointState:
    return swing(10_000 - number)


UNRELIABLE = qos_profile_sensor_data
FAULTS = {
    "nobody": (lambda graph: TOPIC, pair({"kind": Imu, "topic": "/imu"}, {})),
    "name": (
        pair({"topic": "/Tank/joint_states"}, {}),
        pair({"kind": Imu, "topic": "/imu"}, {"kind": Imu, "topic": "/Tank/IMU"}, "/Tank/IMU"),
    ),
    "type": (pair({"kind": Imu}, {}), pair({"kind": String}, {"qos": UNRELIABLE})),
    "reliability": (
        pair({"qos": UNRELIABLE}, {}),
        pair({"kind": Imu, "qos": UNRELIABLE, "topic": "/imu"}, {"kind": Imu, "topic": "/imu"}, "/imu"),
    ),
    "durability": (pair({}, {"qos": KEPT}), pair({"qos": 1, "rate": 0}, {"qos": KEPT})),
    "deadline": (pair({}, {"qos": within(0.1)}), pair({"qos": within(0.5)}, {"qos": within(0.1)})),
    "liveliness": (pair({}, {"qos": MANUAL}), pair({"qos": alive(5)}, {"qos": alive(2)})),
    "late": (once(String, "/description"), once_volatile),
    "clock": (pair({"args": SIM_TIME}, {}), clock_stands),
    "silent": (pair({"rate": 0}, {}), blocked),
    "unknown": (
        pair({"make": lambda number: swing(number, ["TURET_Y", "barrel"])}, {}),
        pair({"make": lambda number: swing(number, ["Tank/TURRET_Y", "Tank/TURRET_P"])}, {}),
    ),
    "dropped": (
        pair({"make": backwards}, {}),
        pair({"make": lambda number: JointState(name=["TURRET_Y"], position=[nan])}, {}),
    ),
}


@pytest.fixture(scope="module")
def found() -> dict[tuple[str, int], Facts]:
    return facts_of_each({(name, variant): FAULTS[name][variant] for name in FAULTS for variant in (0, 1)})


@pytest.mark.parametrize("variant", [0, 1])
@pytest.mark.parametrize("name", FAULTS)
def test_the_cause_comes_first(found, name, variant):
    facts = found[name, variant]
    assert [cause.name for cause in diagnose(facts)][:1] == [name], report(facts)


def fleet(graph: Graph) -> str:
    """Several publishers and subscriptions, and similar names."""
    for topic in (TOPIC, "/Tank/joint_states", "/Tank2/joint_state"):
        graph.publish(topic=topic)
        graph.subscribe(topic=topic)
    graph.subscribe(qos=UNRELIABLE)
    return TOPIC


def once_and_kept(graph: Graph) -> str:
    graph.publish(String, "/description", KEPT, rate=0).publish(String())
    graph.subscribe(String, "/description", KEPT)
    return "/description"


HEALTHY = {
    "default": pair({}, {}),
    "no viewer": lambda graph: graph.publish() and TOPIC,
    "best effort": pair({"qos": UNRELIABLE}, {"qos": UNRELIABLE}),
    "reliable to best effort": pair({}, {"qos": UNRELIABLE}),
    "kept": pair({"qos": KEPT}, {"qos": KEPT}),
    "once": once_and_kept,
    "fleet": fleet,
    "strict": pair({"qos": within(0.1)}, {"qos": within(0.5)}),
}


@pytest.fixture(scope="module")
def well() -> dict[str, Facts]:
    return facts_of_each(HEALTHY)


@pytest.mark.parametrize("name", HEALTHY)
def test_all_is_well(well, name):
    said = "the publisher keeps 1 message" if name == "once" else "messages a second arrive."
    assert "\nAll is well: " in report(well[name])
    assert said in report(well[name])


@pytest.mark.pocket
@pytest.mark.parametrize(("kind", "topic"), [(JointState, TOPIC), (Imu, "/imu")])
def test_other_hash(graph, monkeypatch, kind, topic):
    with monkeypatch.context() as patch:
        patch.setattr("rclpy._cyclone.type_hash", lambda _: f"RIHS01_{'0' * 64}")
        graph.publish(kind, topic)
    graph.subscribe(kind, topic)
    assert diagnose(asyncio.run(graph.facts(topic)))[0].name == "hash"


@pytest.mark.parametrize("subscribed", [True, False])
def test_other_domain(graph, subscribed):
    if subscribed:
        graph.subscribe()
    with closing(Graph()) as elsewhere:
        elsewhere.publish()
        facts = asyncio.run(graph.facts(domains=(elsewhere.domain,)))
    cause = diagnose(facts)[0]
    assert (cause.name, facts.found_in) == ("domain", (elsewhere.domain,))
    assert cause.fill(cause.rule.command) == f"export ROS_DOMAIN_ID={elsewhere.domain}"


def test_a_publisher_whose_clock_is_behind(graph, monkeypatch):
    graph.publish()
    clock = SimpleNamespace(monotonic=time.monotonic, time_ns=lambda: time.time_ns() + 10**12)
    monkeypatch.setattr("tutorial.ros.doctor.observe.time", clock)
    assert "messages a second arrive." in report(asyncio.run(graph.facts()))
