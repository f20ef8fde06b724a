"""Implement both ends with plain Cyclone DDS Python and the wire type of `JointState`, without ROS 2."""

import os
from collections.abc import Callable
from typing import Any

import tutorial  # noqa: F401 - only for the settings of Cyclone DDS

# isort: split
from cyclonedds.core import InstanceState, ReadCondition, SampleState, ViewState, WaitSet
from cyclonedds.domain import Domain, DomainParticipant
from cyclonedds.idl import make_idl_struct, types
from cyclonedds.pub import DataWriter
from cyclonedds.qos import Policy, Qos
from cyclonedds.sub import DataReader
from cyclonedds.topic import Topic
from rclpy._domain import configuration


def struct(name: str, /, **fields: Any) -> Any:
    """Return a wire type."""
    package, _, short = name.split("/")
    made = make_idl_struct(f"{short}_", f"{package}::msg::dds_::{short}_", fields)
    made.__idl__.populate()
    return made


TIME = struct("builtin_interfaces/msg/Time", sec=types.int32, nanosec=types.uint32)
HEADER = struct("std_msgs/msg/Header", stamp=TIME, frame_id=str)
NUMBERS = dict.fromkeys(("position", "velocity", "effort"), types.sequence[types.float64])
JOINT_STATE = struct("sensor_msgs/msg/JointState", header=HEADER, name=types.sequence[str], **NUMBERS)

number = int(os.environ["ROS_DOMAIN_ID"])
domain = Domain(number, configuration())
participant = DomainParticipant(number)
ends = (
    participant,
    Topic(participant, "plain", JOINT_STATE),
    Qos(Policy.Reliability.Reliable(2**63 - 1), Policy.History.KeepLast(10)),
)
"""The arguments of a writer and a reader, with the quality of service of a node with depth 10."""


def publisher() -> tuple[Any, Callable[..., Any], Callable[..., Any], Callable[[], int]]:
    """Return a message and the functions that serialize it, send it, and count the listeners."""
    writer = DataWriter(*ends)
    return (
        JOINT_STATE(HEADER(TIME(0, 0), ""), [], [], [], []),
        _serialized,
        writer.write,
        writer.get_matched_subscriptions,
    )


def subscriber(add: Callable[[Any], None]) -> Callable[[], object]:
    """Call `add` with each message that a WaitSet reports; return the function that waits for more."""
    reader, waitset = DataReader(*ends), WaitSet(participant)
    waitset.attach(ReadCondition(reader, ViewState.Any | InstanceState.Any | SampleState.Any))

    def wait() -> None:
        waitset.wait(100_000_000)
        for message in reader.take(1):
            if message.sample_info.valid_data:
                add(message)

    return wait


def _serialized(message: Any) -> Any:
    data = message.serialize()
    message.serialize = lambda **_: data
    return message
