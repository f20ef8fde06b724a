"""Attack a program from a separate process: ``python attack.py KIND SECONDS``.

It attacks every program that shows the tank's joint states in this ROS domain.
It uses the pocket ROS 2, even if its victim does not, because a real one does not let a program send such things.
"""

import math
import os
import socket
import struct
import sys
import time
from collections.abc import Callable
from contextlib import suppress
from itertools import count, cycle

os.environ["TUTORIAL_ROS"] = "pocket"

import tutorial  # noqa: F401 - promises an rclpy

# isort: split
from cyclonedds.pub import DataWriter
from cyclonedds.qos import Policy, Qos
from cyclonedds.topic import Topic
from rclpy._domain import close, default_domain_id, join
from rclpy._graph import _WRITER_QOS
from rclpy._wire import encode, payload_type
from rmw_dds_common.msg import Gid, NodeEntitiesInfo, ParticipantEntitiesInfo
from sensor_msgs.msg import JointState

RELIABLE = Qos(Policy.Reliability.Reliable(10**9), Policy.History.KeepLast(1))
PROCESSES = 8  # whose ports it tries

TOPICS = ("rt/1abc", "rt/a/", "rt//x", "rt/", "rt/<b>x</b>", "rt/" + "x" * 200)
NODES = ("\x1b[2Jgone", "line\nforged", "<img src=x onerror=alert(1)>", "\u202egpj", "", "x" * 250)
HOSTILE = (
    JointState(name=["TURRET_Y", "TURRET_P"], position=[math.nan, math.inf]),
    JointState(name=["TURRET_Y"] * 1000, position=[1e300] * 1000),
    JointState(name=["<b>\x1b[2J\u202e"] * 50, position=[0.1] * 50),
    JointState(name=["TURRET_Y", "TURRET_P"], position=[0.1]),
    JointState(name=["TURRET_P"], position=[0.1] * 5000),
    JointState(name=[f"JOINT_{i}" for i in range(500)], position=[], velocity=[-math.inf] * 3),
)

Step = Callable[[], object]
"""Sends once; it is called again and again."""


def writer(topic: str, type_name: str, qos: Qos) -> DataWriter:
    """Return a writer of arbitrary bytes."""
    return DataWriter(participant, Topic(participant, topic, payload_type(type_name)), qos)


def names() -> Step:
    """Create and remove nodes and topics with names that are not allowed."""
    announcing = writer("ros_discovery_info", "rmw_dds_common/msg/ParticipantEntitiesInfo", _WRITER_QOS)
    gid = Gid(data=list(participant.guid.bytes))
    numbers, there = count(), list[DataWriter]()

    def step() -> None:
        number = next(numbers)
        nodes = [NodeEntitiesInfo(node_namespace="/", node_name=f"{name[:240]}{number}") for name in NODES]
        announcement = ParticipantEntitiesInfo(gid=gid, node_entities_info_seq=nodes)
        announcing.write(announcing.topic.data_type(encode(announcement)))
        for topic in TOPICS:
            there.append(writer(f"{topic}{number}"[:240], "sensor_msgs/msg/JointState", RELIABLE))
        while len(there) > 100:
            close(there.pop(0))

    return step


def messages() -> Step:
    """Publish invalid joint states."""
    publisher = writer("rt/Tank/joint_state", "sensor_msgs/msg/JointState", RELIABLE)
    hostile = cycle([publisher.topic.data_type(encode(message)) for message in HOSTILE])
    return lambda: publisher.write(next(hostile))


def encapsulations() -> Step:
    """Send joint states with an encapsulation that does not exist.

    Cyclone DDS cannot send these, so this makes the packets itself, in the name of a writer that Cyclone DDS announced.
    """
    publisher = writer("rt/Tank/joint_state", "sensor_msgs/msg/JointState", RELIABLE)
    while not publisher.get_publication_matched_status().current_count:
        time.sleep(0.05)
    guid, domain, numbers = publisher.guid.bytes, default_domain_id(), count(1)
    sender = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)

    def step() -> None:
        body = struct.pack("<HH4s4siI", 0, 16, bytes(4), guid[12:], 0, next(numbers)) + b"\0\x09\0\0" + bytes(60)
        packet = b"RTPS\2\1\1\x10" + guid[:12] + struct.pack("<BBH", 0x15, 5, len(body)) + body
        for index in range(PROCESSES):
            sender.sendto(packet, ("127.0.0.1", 7411 + 250 * domain + 2 * index))

    return step


RATES = {names: 20, messages: 5000, encapsulations: 450}  # [Hz]


def main(kind: Callable[[], Step], seconds: float) -> int:
    """Send at a rate for some seconds, or until Ctrl-C, without catching up; return the number of sends."""
    step, sent = kind(), 0
    print("on", flush=True)
    began = due = time.monotonic()
    with suppress(KeyboardInterrupt):
        while due < began + seconds:
            step()
            sent += 1
            due = max(due + 1 / RATES[kind], time.monotonic() - 0.1)
            time.sleep(max(0.0, due - time.monotonic()))
    return sent


if __name__ == "__main__":
    participant = join(default_domain_id())
    print(main(next(kind for kind in RATES if kind.__name__ == sys.argv[1]), float(sys.argv[2])))
