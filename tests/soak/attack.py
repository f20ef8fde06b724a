"""Attack a program from a separate process: ``python attack.py KIND SECONDS``.

It attacks every program that shows the tank's joint states in this ROS domain. It uses the pocket ROS 2, even if its
victim does not, because a real one does not let a program send such things.
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

import tutorial  # noqa: F401 - makes rclpy importable

# isort: split
from rclpy._cyclone import Writer, join
from rclpy._domain import default_domain_id
from rclpy._graph import TOPIC, TYPE_NAME, WRITER_PROFILE
from rclpy._wire import encode
from rclpy.qos import QoSProfile
from rmw_dds_common.msg import Gid, NodeEntitiesInfo, ParticipantEntitiesInfo
from sensor_msgs.msg import JointState

JOINT_STATE = "sensor_msgs/msg/JointState"
PROFILE = QoSProfile(depth=1)
PROCESSES = 8  # the number of processes whose ports it tries

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
"""Sends once; it is called repeatedly."""


def names() -> Step:
    """Create and remove nodes and topics with names that are not allowed."""
    announcing = participant.create_writer(TOPIC, TYPE_NAME, WRITER_PROFILE)
    gid = Gid(data=list(participant.guid))
    numbers, there = count(), list[Writer]()

    def step() -> None:
        number = next(numbers)
        nodes = [NodeEntitiesInfo(node_namespace="/", node_name=f"{name[:240]}{number}") for name in NODES]
        announcement = ParticipantEntitiesInfo(gid=gid, node_entities_info_seq=nodes)
        announcing.write(encode(announcement))
        for topic in TOPICS:
            there.append(participant.create_writer(f"{topic}{number}"[:240], JOINT_STATE, PROFILE))
        while len(there) > 100:
            there.pop(0).close()

    return step


def messages() -> Step:
    """Publish invalid joint states."""
    publisher = participant.create_writer("rt/Tank/joint_state", JOINT_STATE, PROFILE)
    hostile = cycle([encode(message) for message in HOSTILE])
    return lambda: publisher.write(next(hostile))


def encapsulations() -> Step:
    """Send joint states with an encapsulation that does not exist.

    Cyclone DDS cannot send these, so build the packets here, in the name of a writer that Cyclone DDS announced.
    """
    publisher = participant.create_writer("rt/Tank/joint_state", JOINT_STATE, PROFILE)
    while not publisher.count_matched():
        time.sleep(0.05)
    guid, domain, numbers = publisher.guid, default_domain_id(), count(1)
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
