"""What ``tank`` prints beside a program, made with plain Cyclone DDS, whose names contain control characters."""

import pytest
from programs import until
from rclpy.serialization import serialize_message
from rmw_dds_common.msg import Gid, NodeEntitiesInfo, ParticipantEntitiesInfo
from sensor_msgs.msg import JointState

from tutorial.ros.node_thread import NodeThread
from tutorial.ros.topics.names import escape_name, full_name

pytestmark = pytest.mark.pocket  # the program talks to it; on a real ROS 2, tank writes names in the same way

ESCAPES = "\x1b[2J\x1b]0;mine\x07"
"""Clears a terminal's screen, and sets its window's title."""
BACKWARDS = "\u202egpj.exe"
FORGED = "a\r\n/forged\u2028\x85b"
LONG = "n" * 250
TEXTS = (FORGED, ESCAPES, BACKWARDS, "<b>x</b>", "\ufeff\x7f\x9b31m\t", LONG)
"""The names of the joints and the nodes; the first node owns all publishers."""
NODES = (*((text, "/") for text in TEXTS), ("plain", "no_slash"), ("a/b", "//x/"), ("1abc", "/"), ("", ""))
TOPICS = {
    **dict.fromkeys(("/1abc", "/a/", "//x", "/", "/<b>x</b>", "/{", f"/{'a' * 240}"), "std_msgs::msg::dds_::String_"),
    **{"/type0": f"{ESCAPES}::msg::dds_::X_", "/type1": f"a\n/forged [{BACKWARDS}]"},
}
JOINTS = "/Tank/joint_state"


@pytest.fixture
def hostile(domain):
    """The hostile program in the test's domain, and a node that publishes joint states."""
    from cyclonedds.idl import make_idl_struct
    from cyclonedds.pub import DataWriter
    from cyclonedds.topic import Topic
    from rclpy._cyclone import join, to_dds
    from rclpy._graph import TOPIC, TYPE_NAME, WRITER_PROFILE

    participant = join(domain)

    def writer(topic, kind):
        qos = to_dds(WRITER_PROFILE, TYPE_NAME, writer=True)
        return DataWriter(participant.dds, Topic(participant.dds, topic, kind), qos)

    writers = [writer(f"rt{topic}", make_idl_struct("X", kind, {"data": str})) for topic, kind in TOPICS.items()]
    nodes = [NodeEntitiesInfo(node_namespace=space, node_name=name) for name, space in NODES]
    nodes[0].writer_gid_seq = [Gid(data=list(each.guid.bytes)) for each in writers]
    announcement = ParticipantEntitiesInfo(gid=Gid(data=list(participant.guid)), node_entities_info_seq=nodes)
    announcing = participant.create_writer(TOPIC, TYPE_NAME, WRITER_PROFILE)
    announcing.write(serialize_message(announcement))
    with NodeThread("joints") as thread:
        publisher, message = thread.node.create_publisher(JointState, JOINTS, 1), JointState(name=TEXTS)
        message.position = [0.1] * len(TEXTS)

        def publish():
            message.header.stamp.sec += 1
            publisher.publish(message)

        thread.node.create_timer(0.1, publish)
        yield
    participant.leave()


@pytest.mark.parametrize(
    ("command", "status", "lines"),
    [
        ("topic list -t", 0, [r"/type1 [a\n/forged [\u202egpj", "//x [std_msgs/msg/String]"]),
        ("topic info -v /1abc", 0, ["Publisher count: 1", f"Node name: {escape_name(FORGED)}"]),
        (f"topic echo --once {JOINTS}", 0, [f"- {LONG[:128]}..."]),
        ("topic echo /type0", 1, [f"The message type '{escape_name(ESCAPES)}/msg/X' is invalid"]),
        ("node list", 0, [escape_name(full_name(*names)) for names in NODES]),
        pytest.param("doctor", None, ["\npackages   ok ", r"/forged\u2028\x85b"], marks=pytest.mark.process),
        ("run step3 --headless --duration 3", 0, [f"unknown {FORGED!r}, {ESCAPES!r}, {BACKWARDS!r} and 3 more"]),
    ],
)
def test_names_and_texts_are_printed_as_escapes(hostile, tank, command, status, lines):
    """Try again if the programs have not discovered each other yet. All output except line breaks must be printable."""

    def says_so():
        run = tank(command)
        assert run.output.replace("\n", "").isprintable(), ascii(run.output)
        return status in (None, run.status) and all(line in run.output for line in lines)

    until(says_so, f"the end with {status}, and {lines}")
