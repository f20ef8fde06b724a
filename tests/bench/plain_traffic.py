"""The same with Cyclone DDS Python alone, nothing of ROS 2: ``plain_traffic.py beat publish``."""

import os
import sys
import time
from dataclasses import dataclass
from typing import Any

import tutorial  # noqa: F401 - promises an rclpy

# isort: split
from cyclonedds.core import InstanceState, ReadCondition, SampleState, ViewState, WaitSet
from cyclonedds.domain import Domain, DomainParticipant
from cyclonedds.idl import IdlStruct, types
from cyclonedds.pub import DataWriter
from cyclonedds.qos import Policy, Qos
from cyclonedds.sub import DataReader
from cyclonedds.topic import Topic
from rclpy._domain import configuration
from traffic_log import FLOODS, Log, flood, stamps


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


def serialized(message: Any) -> Any:
    """Return the message, which from now on gives a writer the same bytes each time."""
    data = message.serialize()
    message.serialize = lambda **_: data
    return message


def publish() -> None:
    """Publish with a DataWriter."""

    participant, topic = plain()
    writer = DataWriter(participant, topic, reliable())
    while not writer.get_matched_subscriptions():
        time.sleep(0.01)
    for stamp in stamps():
        sec, nanosec = divmod(stamp, 1_000_000_000)
        header = Header(Time(sec, nanosec), "")
        message = Plain(header, ["TURRET_Y", "TURRET_P"], [0.1, 0.2], [0.1, 0.2], [0.1, 0.2])
        if FLOODS:
            flood(writer.write, serialized(message))
        writer.write(message)


def subscribe() -> None:
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
    {"publish": publish, "subscribe": subscribe}[sys.argv[2]]()
