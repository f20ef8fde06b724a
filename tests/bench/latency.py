"""From publication to callback, between two processes: a node's callback, and plain Cyclone DDS Python.

Both publish the same message reliably: 100 times a second, with the time as a stamp in it; or as fast as they can, and
those that arrive are counted.
"""

import os
import statistics
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any

import tutorial  # noqa: F401 - promises an rclpy

# isort: split
import rclpy
from cyclonedds.core import InstanceState, ReadCondition, SampleState, ViewState, WaitSet
from cyclonedds.domain import Domain, DomainParticipant
from cyclonedds.idl import IdlStruct, types
from cyclonedds.pub import DataWriter
from cyclonedds.qos import Policy, Qos
from cyclonedds.sub import DataReader
from cyclonedds.topic import Topic
from rclpy._domain import configuration
from rclpy.executors import SingleThreadedExecutor
from sensor_msgs.msg import JointState

MESSAGES = 300
WARM_UP = 50
PERIOD = 0.01  # [s]


FLOOD = 2.0  # [s] for which those that arrive are counted


def latency() -> tuple[Callable[[], float], Callable[[], float]]:
    """Return ours and the reference: the median latency of one run [s]."""
    return lambda: between("node"), lambda: between("plain")


def throughput() -> tuple[Callable[[], float], Callable[[], float]]:
    """Return ours and the reference: the time from one message that arrives to the next, unthrottled [s]."""
    return lambda: between("node", "flood"), lambda: between("plain", "flood")


def between(kind: str, pace: str = "beat") -> float:
    """Run a publisher and a subscriber in processes of their own."""
    command = [sys.executable, __file__, kind, pace]
    with (
        subprocess.Popen([*command, "publish"]) as publisher,
        subprocess.Popen([*command, "subscribe"], stdout=subprocess.PIPE, text=True) as subscriber,
    ):
        try:
            return float(subscriber.communicate(timeout=60)[0])
        finally:
            subscriber.kill()
            publisher.kill()


def stamps() -> Iterator[int]:
    """Wait out each period, if there is one, and give the time at which to publish [ns]."""
    while FLOODS:
        yield time.time_ns()
    for _ in range(MESSAGES):
        time.sleep(PERIOD)
        yield time.time_ns()


class Log:
    """What a subscriber notes of each message: how old it is [ns]."""

    def __init__(self) -> None:
        self._ages: list[int] = []
        self._began = 0.0

    def add(self, stamp: Any) -> None:
        """Note a message, by the stamp in it."""
        self._began = self._began or time.monotonic()
        self._ages.append(time.time_ns() - stamp.sec * 1_000_000_000 - stamp.nanosec)

    @property
    def full(self) -> bool:
        """Whether that is enough."""
        return bool(self._began) and (time.monotonic() > self._began + FLOOD if FLOODS else len(self._ages) >= MESSAGES)

    def finish(self) -> None:
        """Hand the median, or the time between two, over to the parent [s]."""
        if FLOODS:
            print((time.monotonic() - self._began) / len(self._ages))
        else:
            print(statistics.median(self._ages[WARM_UP:]) / 1e9)


def node_publish() -> None:
    """Publish with rclpy."""
    rclpy.init(args=[])
    node = rclpy.create_node("publisher")
    publisher = node.create_publisher(JointState, "bench", 10)
    while rclpy.ok() and not publisher.get_subscription_count():
        time.sleep(0.01)
    for stamp in stamps():
        message = JointState(name=["TURRET_Y", "TURRET_P"], position=[0.1, 0.2], velocity=[0.1, 0.2], effort=[0.1, 0.2])
        message.header.stamp.sec, message.header.stamp.nanosec = divmod(stamp, 1_000_000_000)
        publisher.publish(message)
    publisher.wait_for_all_acked()


def node_subscribe() -> None:
    """Receive with rclpy, on the thread that spins."""

    rclpy.init(args=[])
    node = rclpy.create_node("subscriber")
    log = Log()
    node.create_subscription(JointState, "bench", lambda message: log.add(message.header.stamp), 10)
    executor = SingleThreadedExecutor()
    executor.add_node(node)
    while not log.full:
        executor.spin_once()
    log.finish()


@dataclass
class Time(IdlStruct):
    """A stamp."""

    sec: types.int32
    nanosec: types.uint32


@dataclass
class Header(IdlStruct):
    """What the message begins with."""

    stamp: Time
    frame_id: str


@dataclass
class Plain(IdlStruct):
    """The same message: field by field what `JointState` is on the wire."""

    header: Header
    name: types.sequence[str]
    position: types.sequence[types.float64]
    velocity: types.sequence[types.float64]
    effort: types.sequence[types.float64]


def plain() -> tuple[Any, Any]:
    """A participant and a topic with nothing of ROS 2, heard on this machine only."""
    number = int(os.environ["ROS_DOMAIN_ID"])
    plain.domain = Domain(number, configuration())  # type: ignore[attr-defined]
    participant = DomainParticipant(number)
    return participant, Topic(participant, "plain", Plain)


def reliable() -> Any:
    """What a node's quality of service of depth 10 is in DDS."""

    return Qos(Policy.Reliability.Reliable(2**63 - 1), Policy.History.KeepLast(10))


def plain_publish() -> None:
    """Publish with a DataWriter."""

    participant, topic = plain()
    writer = DataWriter(participant, topic, reliable())
    while not writer.get_matched_subscriptions():
        time.sleep(0.01)
    for stamp in stamps():
        sec, nanosec = divmod(stamp, 1_000_000_000)
        header = Header(Time(sec, nanosec), "")
        writer.write(Plain(header, ["TURRET_Y", "TURRET_P"], [0.1, 0.2], [0.1, 0.2], [0.1, 0.2]))
    time.sleep(0.2)


def plain_subscribe() -> None:
    """Receive with a DataReader and a WaitSet."""

    participant, topic = plain()
    reader = DataReader(participant, topic, reliable())
    waitset = WaitSet(participant)
    waitset.attach(ReadCondition(reader, ViewState.Any | InstanceState.Any | SampleState.Any))
    log = Log()
    while not log.full:
        waitset.wait(100_000_000)
        for message in reader.take(1):
            if message.sample_info.valid_data:
                log.add(message.header.stamp)
    log.finish()


if __name__ == "__main__":
    kind, pace, side = sys.argv[1:]
    FLOODS = pace == "flood"
    globals()[f"{kind}_{side}"]()
