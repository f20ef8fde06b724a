"""A program that brings hostile names and texts into a ROS domain: ``hostile_peer.py [nameless]``.

It is Cyclone DDS alone, nothing of ROS 2: what a node, a topic or a type is called is for it to choose. It ends when
nobody holds its stdin any more.
"""

from __future__ import annotations

import os
import subprocess
import sys
import threading
import time
from collections.abc import Iterator, Sequence
from contextlib import contextmanager, suppress
from typing import Any

from cyclonedds.core import DDSException, Policy, Qos
from cyclonedds.domain import Domain, DomainParticipant
from cyclonedds.idl import make_idl_struct, types
from cyclonedds.pub import DataWriter
from cyclonedds.topic import Topic
from wire import HEADER, JOINT_STATE, STRING, TIME, struct

ESCAPES = "\x1b[2J\x1b]0;mine\x07"
"""Clears the screen of a terminal, and names its window."""
BACKWARDS = "\u202egpj.exe"
FORGED = "a\r\n/forged\u2028\x85b"
MARKUP = "<img src=x onerror=window.pwned=1>"
LONG = "n" * 250
TEXTS = (ESCAPES, BACKWARDS, FORGED, MARKUP, "\ufeff\x7f\x9b31m\t", LONG)
"""What the joints are called on JOINTS."""
JOINTS = "/Tank/joint_state"
NODES = (*((text, "/") for text in TEXTS), ("plain", "no_slash"), ("a/b", "//x/"), ("1abc", "/"))
"""Names and namespaces; the first has all publishers."""
NAMELESS = ("", "")
"""One with which a real ROS 2 lists no nodes at all."""
TOPICS = ("/1abc", "/a/", "//x", "/", "/<b>x</b>", "/_/", "/{", f"/{'a' * 300}", "/plain")
TYPES = (f"{ESCAPES}::msg::dds_::X_", f"a\n/forged [{BACKWARDS}]", MARKUP, "antigravity::msg::dds_::X_")
"""What ``/type0`` to ``/type3`` are of. In the last there is no message: it is a module that opens a browser."""

DOMAIN = """<CycloneDDS><Domain Id="any">
 <General><AllowMulticast>false</AllowMulticast>
  <Interfaces><NetworkInterface address="127.0.0.1"/></Interfaces></General>
 <Discovery><ParticipantIndex>auto</ParticipantIndex><MaxAutoParticipantIndex>32</MaxAutoParticipantIndex>
  <SPDPInterval>1s</SPDPInterval><Peers><Peer address="127.0.0.1" PruneDelay="inf"/></Peers></Discovery>
</Domain></CycloneDDS>"""
HASHED = Policy.Userdata(f"typehash=RIHS01_{'0' * 64};".encode())
"""Or rmw_cyclonedds itself warns of each endpoint, with its topic's name as it comes."""
RELIABLE = Policy.Reliability.Reliable(100_000_000)
"""It waits 0.1 s [ns] for who is slow, and then goes on."""


@contextmanager
def hostile_peer(domain: int, *arguments: str) -> Iterator[None]:
    """Run this program in a domain, from when it has said everything once."""
    process = subprocess.Popen(
        [sys.executable, __file__, *arguments],
        env={**os.environ, "ROS_DOMAIN_ID": str(domain)},
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        text=True,
    )
    with process:
        assert process.stdout is not None
        assert process.stdout.readline() == "ready\n"
        try:
            yield
        finally:
            process.communicate()


GID = struct("rmw_dds_common/msg/Gid", _data_octets=types.array[types.uint8, 16])
NODE = struct(
    "rmw_dds_common/msg/NodeEntitiesInfo",
    node_namespace=types.bounded_str[256],
    node_name=types.bounded_str[256],
    reader_gid_seq=types.sequence[GID],
    writer_gid_seq=types.sequence[GID],
)
PARTICIPANT = struct("rmw_dds_common/msg/ParticipantEntitiesInfo", gid=GID, node_entities_info_seq=types.sequence[NODE])


class Peer:
    """The participant and its writers."""

    def __init__(self, domain: int) -> None:
        self._domain = Domain(domain, DOMAIN)
        self._participant = DomainParticipant(domain)
        self._writers: list[Any] = []

    def write(self, topic: str, kind: Any, *policies: Any) -> Any:
        qos = Qos(HASHED, RELIABLE, *policies)
        self._writers.append(DataWriter(self._participant, Topic(self._participant, topic, kind), qos))
        return self._writers[-1]

    def announce(self, names: Sequence[tuple[str, str]]) -> None:
        """Say which nodes there are."""
        writers = [GID(list(writer.guid.bytes)) for writer in self._writers]
        nodes = [NODE(space, name, [], [] if i else writers) for i, (name, space) in enumerate(names)]
        writer = self.write("ros_discovery_info", PARTICIPANT, Policy.Durability.TransientLocal)
        writer.write(PARTICIPANT(GID(list(self._participant.guid.bytes)), nodes))


def speak(joints: Any) -> None:
    """Name joints by the texts, again and again."""
    for tick in range(10**9):
        stamp = TIME(*divmod(tick * 100_000_000, 1_000_000_000))
        with suppress(DDSException):
            joints.write(JOINT_STATE(HEADER(stamp, MARKUP), [*TEXTS], [0.1] * len(TEXTS), [], []))
        time.sleep(0.1)


def main() -> None:
    """Bring all of it, say so, and speak until the end."""
    peer = Peer(int(os.environ["ROS_DOMAIN_ID"]))
    for topic in TOPICS:
        peer.write(f"rt{topic}", STRING)
    for i, name in enumerate(TYPES):
        peer.write(f"rt/type{i}", make_idl_struct("X", name, {"data": str}))
    joints = peer.write(f"rt{JOINTS}", JOINT_STATE)
    peer.announce((*NODES, NAMELESS) if "nameless" in sys.argv else NODES)
    threading.Thread(target=speak, args=(joints,), daemon=True).start()
    print("ready", flush=True)
    sys.stdin.read()


if __name__ == "__main__":
    main()
