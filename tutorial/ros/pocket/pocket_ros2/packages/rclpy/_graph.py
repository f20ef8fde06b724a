"""The node graph: nodes, and the publishers and subscriptions on topics.

DDS has participants, writers and readers, but no nodes. In ROS 2, every participant publishes a list of its nodes and
their endpoints on the topic ``ros_discovery_info``, and publishes the whole list again after each change.
"""

from collections.abc import Iterable
from contextlib import suppress

from rclpy._domain import lock
from rclpy._middleware import TransportError, decode_nodes, encode_nodes
from rclpy._rclpy_pybind11 import RCLError
from rclpy._transport import PUBLISHERS, SUBSCRIPTIONS, NodeInfo, Participant
from rclpy.logging import get_logger
from rclpy.qos import DurabilityPolicy, HistoryPolicy, QoSProfile

AT_ONCE = 256
"""Maximum number of announcements to take at once. Without a limit, a steady stream of them could block the caller."""
LONGEST = 32_768
"""Maximum size of an announcement [bytes]: enough for about 100 nodes in one process, with all their publishers.
Decoding an announcement of this size takes about 10 ms, or 40 ms during a garbage collection. A query for nodes decodes
at most two of them."""

TOPIC, TYPE_NAME = "ros_discovery_info", "rmw_dds_common/msg/ParticipantEntitiesInfo"
WRITER_PROFILE = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
READER_PROFILE = QoSProfile(history=HistoryPolicy.KEEP_ALL, durability=DurabilityPolicy.TRANSIENT_LOCAL)


class Graph:
    """The node graph as seen from one participant; its methods can be called from any thread.

    Args:
        participant: the participant.

    Attributes:
        participant: the given participant.
        changes: the reader whose messages the executor waits for before it calls :meth:`listen`.
    """

    def __init__(self, participant: Participant) -> None:
        self.participant = participant
        self._local: list[NodeInfo] = []
        self._remote: dict[bytes, list[NodeInfo]] = {}
        self._unread: dict[bytes, bytes] = {}
        self._ignored = 0
        self._logger = get_logger("rclpy")
        self._writer = participant.create_writer(TOPIC, TYPE_NAME, WRITER_PROFILE)
        self.changes = participant.create_reader(TOPIC, TYPE_NAME, READER_PROFILE, ignore_own=True)

    def add_node(self, namespace: str, name: str) -> NodeInfo:
        """Announce a node of this process, and return the entry that represents it in calls to the other methods."""
        node = NodeInfo(namespace, name)
        with lock:
            self._local.append(node)
            self._announce()
        return node

    def remove_node(self, node: NodeInfo) -> None:
        """Announce that a node has been removed."""
        with lock:
            self._local = [other for other in self._local if other is not node]
            self._announce()

    def set_endpoints(self, node: NodeInfo, writers: Iterable[bytes], readers: Iterable[bytes]) -> None:
        """Announce the identifiers of a node's writers and readers."""
        with lock:
            node.writers, node.readers = [*writers], [*readers]
            self._announce()

    def nodes(self) -> list[NodeInfo]:
        """Return all known nodes, this process's own nodes first.

        Each call decodes at most about :data:`LONGEST` bytes of announcements, and leaves the rest for the next call.
        """
        with lock:
            self.listen()
            left = LONGEST
            while left > 0 and self._unread:
                gid, data = next(iter(self._unread.items()))
                left -= len(data)
                self._learn(gid, data)
                del self._unread[gid]
            return [*self._local, *(node for nodes in self._remote.values() for node in nodes)]

    def owners(self) -> dict[bytes, NodeInfo]:
        """Return the nodes, keyed by the identifiers of their writers and readers."""
        return {guid: node for node in self.nodes() for guid in (*node.writers, *node.readers)}

    def is_complete(self) -> bool:
        """Return whether the graph is complete.

        It is complete when every discovered ROS 2 program has announced its nodes, and every announced endpoint has
        been discovered. A program is discovered before its nodes. With Fast DDS, the program may not announce its
        nodes until seconds later.
        """
        with lock:
            owned, announced = self.owners().keys(), {self.participant.guid, *self._remote}
            found = {each.guid for kind in (PUBLISHERS, SUBSCRIPTIONS) for each in self.participant.endpoints(kind)}
            unknown = self.participant.participants(only_ros=True) - announced
            return not self._unread and not unknown and owned <= found

    def listen(self) -> None:
        """Receive new announcements, and drop participants that have left: a killed process does not announce its exit.

        The executor calls this method regularly, because announcements would otherwise accumulate in a program that
        never queries the graph. Announcements are decoded only by a query, which decodes only the newest one from each
        participant.
        """
        with lock:
            self.changes.take_incompatible()  # otherwise, this status would wake the executor repeatedly
            for _ in range(AT_ONCE):
                if (sample := self.changes.take()) is None:
                    break
                self._unread[sample[0][4:20]] = sample[0]  # the gid is the first field, after the header
            alive = self.participant.participants()
            self._remote = {gid: nodes for gid, nodes in self._remote.items() if gid in alive}
            self._unread = {gid: data for gid, data in self._unread.items() if gid in alive}

    def _announce(self) -> None:
        with suppress(TransportError):  # the context is shutting down, which ends all nodes anyway
            self._writer.write(encode_nodes(self.participant.guid, self._local))

    def _learn(self, gid: bytes, data: bytes) -> None:
        try:
            if len(data) > LONGEST:
                raise RCLError(f"it has {len(data):,} bytes; at most {LONGEST:,} are read")
            self._remote[gid] = decode_nodes(data)
        except RCLError as error:
            self._ignored += 1
            self._remote.setdefault(gid, [])
            text = f"{self._ignored} node announcements have been ignored. The last one: {error}"
            self._logger.warning(text, throttle_duration_sec=10.0)
