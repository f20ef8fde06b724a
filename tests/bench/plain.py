"""Cyclone DDS Python alone, nothing of ROS 2, with what a `JointState` is on the wire."""

import os
from dataclasses import dataclass
from typing import Any

from cyclonedds.core import InstanceState, ReadCondition, SampleState, ViewState, WaitSet
from cyclonedds.domain import Domain, DomainParticipant
from cyclonedds.idl import IdlStruct, types
from cyclonedds.pub import DataWriter
from cyclonedds.qos import Policy, Qos
from cyclonedds.sub import DataReader
from cyclonedds.topic import Topic
from rclpy._domain import configuration

__all__ = ["DataReader", "DataWriter", "end", "message", "waitset"]

NUMBERS = types.sequence[types.float64]
kept: list[Any] = []


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
    """The message."""

    header: Header
    name: types.sequence[str]
    position: NUMBERS
    velocity: NUMBERS
    effort: NUMBERS


def end(kind: Any) -> Any:
    """Make a writer or a reader with the quality of service of a node's depth of 10, heard on this machine only."""
    number = int(os.environ["ROS_DOMAIN_ID"])
    kept.append(Domain(number, configuration()))
    participant = DomainParticipant(number)
    qos = Qos(Policy.Reliability.Reliable(2**63 - 1), Policy.History.KeepLast(10))
    return kind(participant, Topic(participant, "plain", Plain), qos)


def message(sec: int, nanosec: int) -> Plain:
    """Make a message with a stamp."""
    return Plain(Header(Time(sec, nanosec), ""), ["TURRET_Y", "TURRET_P"], [0.1, 0.2], [0.1, 0.2], [0.1, 0.2])


def waitset(reader: DataReader) -> WaitSet:
    """Make what waits for a reader's messages."""
    made = WaitSet(reader.participant)
    made.attach(ReadCondition(reader, ViewState.Any | InstanceState.Any | SampleState.Any))
    return made
