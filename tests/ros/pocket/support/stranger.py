"""A plain DDS program that announces nodes to the pocket ROS 2 as ROS 2 does."""

from typing import Any

from rclpy._graph import TOPIC, TYPE_NAME, WRITER_PROFILE
from rclpy.serialization import serialize_message
from rmw_dds_common.msg import Gid, NodeEntitiesInfo, ParticipantEntitiesInfo


class Stranger:
    """A foreign program in the domain: only a participant, which can announce arbitrary nodes."""

    def __init__(self, participant: Any) -> None:
        self._gid = Gid(data=list(participant.guid))
        self.writer = participant.create_writer(TOPIC, TYPE_NAME, WRITER_PROFILE)

    def listing(self, *names: str, writers: int = 0) -> bytes:
        """Return an announcement of nodes, each with some publishers that do not exist."""
        gids = [Gid(data=[7] * 16)] * writers
        nodes = [NodeEntitiesInfo(node_namespace="/", node_name=name, writer_gid_seq=gids) for name in names]
        return serialize_message(ParticipantEntitiesInfo(gid=self._gid, node_entities_info_seq=nodes))

    def announce(self, data: bytes) -> None:
        """Send bytes as an announcement."""
        self.writer.write(data)
