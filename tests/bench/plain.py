"""Cyclone DDS Python alone, nothing of ROS 2, with what a `JointState` is on the wire."""

import os
from typing import Any

from cyclonedds.core import InstanceState, ReadCondition, SampleState, ViewState, WaitSet
from cyclonedds.domain import Domain, DomainParticipant
from cyclonedds.pub import DataWriter
from cyclonedds.qos import Policy, Qos
from cyclonedds.sub import DataReader
from cyclonedds.topic import Topic
from rclpy._domain import configuration
from wire import HEADER, JOINT_STATE, TIME

__all__ = ["DataReader", "DataWriter", "end", "message", "waitset"]

kept: list[Any] = []


def end(kind: Any) -> Any:
    """Make a writer or a reader with the quality of service of a node's depth of 10, heard on this machine only."""
    number = int(os.environ["ROS_DOMAIN_ID"])
    kept.append(Domain(number, configuration()))
    participant = DomainParticipant(number)
    qos = Qos(Policy.Reliability.Reliable(2**63 - 1), Policy.History.KeepLast(10))
    return kind(participant, Topic(participant, "plain", JOINT_STATE), qos)


def message(sec: int, nanosec: int) -> Any:
    """Make a message with a stamp."""
    return JOINT_STATE(HEADER(TIME(sec, nanosec), ""), ["TURRET_Y", "TURRET_P"], [0.1, 0.2], [0.1, 0.2], [0.1, 0.2])


def waitset(reader: DataReader) -> WaitSet:
    """Make what waits for a reader's messages."""
    made = WaitSet(reader.participant)
    made.attach(ReadCondition(reader, ViewState.Any | InstanceState.Any | SampleState.Any))
    return made
