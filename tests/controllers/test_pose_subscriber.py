"""Step 7's viewer: it shows a pose and joints with the same stamp together, or not at all."""

import math

import numpy as np
import pytest
from controlled import Node
from geometry_msgs.msg import TransformStamped
from hypothesis import given
from hypothesis import strategies as st
from sensor_msgs.msg import JointState
from tf2_msgs.msg import TFMessage

from tutorial.body import Body
from tutorial.controller import ControllerConfig
from tutorial.controllers.pose_subscriber import ALONE, MOST_WAITING, REPEATED, PoseSubscriber, StampPairs
from tutorial.joints import Arrival
from tutorial.system.paths import HOME
from tutorial.world import Placement

PLACE = (1.0, 2.0, 3.0)
LEFT = (math.sqrt(0.5), 0.0, 0.0, math.sqrt(0.5))  # w first: a quarter turn
TILTED = tuple(number / math.sqrt(30) for number in (1, 2, 3, 4))


def stamped(message, milliseconds):
    seconds, rest = divmod(milliseconds, 1000)
    message.header.stamp.sec, message.header.stamp.nanosec = seconds, rest * 1_000_000
    return message


def joint_state(milliseconds, position=0.0, name="TURRET_Y"):
    return stamped(JointState(name=[name], position=[position]), milliseconds)


def transform(milliseconds, x=0.0, wxyz=(1.0, 0.0, 0.0, 0.0), parent="odom", child="Robot/base_link"):
    message = stamped(TransformStamped(child_frame_id=child), milliseconds)
    message.header.frame_id = parent
    message.transform.translation.x = x
    q = message.transform.rotation
    q.w, q.x, q.y, q.z = wxyz
    return message


class Viewer:
    """A `PoseSubscriber` on a displayed body."""

    def __init__(self, node):
        self.node, self.calls, self.reports = node, [], []
        self.body = Body.displayed(Placement("Robot", HOME / "project/models/tank.xml", PLACE))
        self.body.on_change(self.reports.append)
        self.controller = PoseSubscriber()
        self.controller.configure(ControllerConfig(self.body, self.node, lambda *call: self.calls.append(call), None))

    def run_calls(self):
        for function, *args in self.calls:
            function(*args)
        self.calls.clear()

    def hear(self, *messages):
        for message in messages:
            if isinstance(message, JointState):
                self.controller.on_joint_state(message)
            else:
                self.controller.on_tf(TFMessage(transforms=[message]))
            self.run_calls()
        return self.body.position[0], self.body.joints[0].position

    @property
    def left_out(self):
        return dict(self.controller.tally.left_out)


@pytest.fixture
def viewer():
    return Viewer(Node())


def test_pose_and_joints_with_the_same_stamp_are_shown_together(viewer):
    assert viewer.node.topics == ["Robot/joint_state", "/tf"]
    assert viewer.hear(joint_state(20, 0.25)) == (1.0, 0.0)
    assert viewer.hear(transform(20, 5.0, LEFT)) == (5.0, 0.25)
    tilted = transform(40, 6.0, 1.004 * np.array(TILTED))  # this quaternion is slightly too long
    tilted.transform.translation.y, tilted.transform.translation.z = 7.0, 8.0
    assert viewer.hear(tilted) == (5.0, 0.25)
    assert viewer.hear(joint_state(40, 0.5)) == (6.0, 0.5)
    assert viewer.body.data.xpos[1].tolist() == [6.0, 7.0, 8.0]
    assert viewer.body.data.xquat[1] == pytest.approx(TILTED)
    assert np.linalg.det(viewer.body.data.xmat[1].reshape(3, 3)) == pytest.approx(1.0)
    assert list(map(str, viewer.reports)) == ["1 joint shown"] * 2
    assert viewer.hear(joint_state(30, 0.25), transform(30, 4.0)) == (6.0, 0.5), "a late message moves nothing"
    assert viewer.reports[-1].arrival is Arrival.LATE
    assert viewer.left_out == {}
    viewer.controller.unconfigure()
    assert viewer.node.topics == []


class Eager(Node):
    """A node that delivers a message as soon as a subscription exists."""

    def create_subscription(self, kind, topic, callback, depth, raw=False):
        callback(joint_state(20) if kind is JointState else TFMessage(transforms=[transform(20)]))
        return super().create_subscription(kind, topic, callback, depth)


def test_messages_may_arrive_during_configure():
    viewer = Viewer(Eager())
    viewer.run_calls()
    assert viewer.controller.tally.shown == 1


@pytest.mark.parametrize("missing", [joint_state, transform])
def test_a_message_without_a_partner_is_only_counted(viewer, missing):
    viewer.hear(transform(20, 5.0), joint_state(20, 0.25))
    other = transform if missing is joint_state else joint_state
    assert viewer.hear(other(40, 0.75)) == (5.0, 0.25)
    assert viewer.hear(transform(60, 6.0), joint_state(60, 0.5)) == (6.0, 0.5)
    assert viewer.left_out == {ALONE: 1}
    assert viewer.hear(missing(40, 0.125)) == (6.0, 0.5), "its partner is too late"
    assert len(viewer.reports) == 2
    assert viewer.node.said == [f"Robot: messages not shown so far: 1 {ALONE}"]


def test_messages_before_both_topics_arrive_are_not_reported(viewer):
    viewer.hear(*(joint_state(20 * i) for i in range(5)), transform(80, 5.0))
    assert len(viewer.reports) == 1
    assert viewer.node.said == []


def test_joints_without_poses_are_not_shown_and_do_not_pile_up(viewer):
    viewer.hear(*(joint_state(20 * i, 0.1) for i in range(2 * MOST_WAITING)))
    assert viewer.node.said == []
    viewer.hear(*(joint_state(20 * i, 0.1) for i in range(2 * MOST_WAITING, 500)))
    assert viewer.node.said[-1] == f"Robot: messages not shown so far: {500 - MOST_WAITING} {ALONE}"
    assert viewer.left_out == {ALONE: 500 - MOST_WAITING}
    assert len(viewer.controller.pairs.waiting) == MOST_WAITING
    assert not viewer.reports


def test_a_restarted_publisher_is_shown_at_once(viewer):
    for i in range(1000, 1010):
        viewer.hear(joint_state(20 * i, 0.25), transform(20 * i, 5.0))
    viewer.hear(*(joint_state(20 * i, 0.75) for i in range(1010, 1050)))  # the transforms stop earlier
    for i in range(10):
        assert viewer.hear(transform(20 * i, 0.1 * i), joint_state(20 * i, 0.01 * i)) == (0.1 * i, 0.01 * i)
    assert str(viewer.reports[10]) == "1 joint shown; the publisher was restarted"
    assert viewer.left_out == {ALONE: 40}


def test_it_follows_one_of_two_publishers_with_its_pose(viewer):
    viewer.node.publishers = 2
    for i in range(10):
        first, second = 100_000 + 20 * i, 3_000 + 20 * i
        viewer.hear(joint_state(first, 0.01 * i), joint_state(second, -0.5))
        assert viewer.hear(transform(first, 5.0 + i), transform(second, -5.0)) == (5.0 + i, 0.01 * i)
    assert sum(report.arrival is Arrival.ANOTHER for report in viewer.reports) == 10
    assert viewer.left_out == {}


def test_unstamped_messages_do_not_pair_and_the_last_of_a_stamp_wins(viewer):
    assert viewer.hear(joint_state(0, 0.5), transform(0, 5.0)) == (5.0, 0.5)
    assert viewer.hear(joint_state(0, 0.75), transform(0, 6.0), transform(0, 7.0)) == (5.0, 0.5)
    assert viewer.left_out == {REPEATED: 3}
    assert viewer.hear(joint_state(20, 0.5), joint_state(20, 0.25), transform(20, 8.0)) == (8.0, 0.25)
    assert viewer.left_out == {REPEATED: 4}


@pytest.mark.parametrize(
    ("why", "message"),
    [
        ("a parent frame other than odom", transform(20, 5.0, parent="map")),
        *(("a position that is not finite", transform(20, x)) for x in (math.nan, 1e300)),
        *(("not a unit quaternion", transform(20, 5.0, (w, x, 0, 0))) for w, x in ((0, 0), (1, math.nan), (1, 0.2))),
    ],
)
def test_an_invalid_pose_is_only_counted(viewer, why, message):
    assert viewer.hear(message, joint_state(20, 0.5)) == (1.0, 0.0)
    assert not viewer.reports
    assert viewer.hear(transform(40, 5.0), joint_state(40, 0.5)) == (5.0, 0.5)
    (said, count), alone = viewer.left_out.items()
    assert why in said
    assert (count, alone) == (1, (ALONE, 1))


LARGE = [JointState(name=[""] * 100_001), JointState(name=["A" * 100_000], position=[0.0])]


@pytest.mark.parametrize("message", LARGE)
def test_a_message_that_is_too_large_does_not_wait(viewer, message):
    viewer.hear(stamped(message, 20), transform(20, 5.0))
    assert viewer.left_out == {"with more joints than any robot has": 1}
    assert list(viewer.controller.pairs.waiting.values()) == [{"pose": transform(20, 5.0)}]


def test_only_its_own_transform_reaches_the_main_thread(viewer):
    others = [transform(20, child=f"Robot_{i}/base_link") for i in range(9_000)]
    viewer.controller.on_tf(TFMessage(transforms=others))
    assert len(viewer.calls) == 0
    viewer.controller.on_tf(TFMessage(transforms=[*others, transform(20, 5.0), transform(20, 6.0)]))
    assert len(viewer.calls) == 1


STREAMS = "joints", "pose"


@given(st.lists(st.tuples(st.sampled_from(STREAMS), st.integers(0, 12)), max_size=60))
def test_each_message_is_paired_waits_or_is_left_out(arrivals):
    left_out, paired = [], 0
    pairs = StampPairs(left_out.append)
    for count, (stream, at) in enumerate(arrivals, 1):
        message = stamped(JointState(name=[stream, str(count)]), at)
        pair = pairs.add(stream, message)
        if pair is not None:
            assert tuple(each.name[0] for each in pair) == STREAMS
            assert pair[STREAMS.index(stream)] is message
            assert pair[0].header.stamp == pair[1].header.stamp
            paired += 2
        assert count == paired + len(pairs.waiting) + len(left_out)


@given(st.lists(st.tuples(st.sampled_from(STREAMS), st.integers(1, 60)), max_size=10))
def test_interleaving_two_ordered_streams_loses_nothing(runs):
    left_out, found, sent = [], [], dict.fromkeys(STREAMS, 0)
    pairs = StampPairs(left_out.append)
    for turn in (stream for stream, length in runs for _ in range(length)):
        ahead = sent["joints"] - sent["pose"]
        stream = STREAMS[ahead > 0] if abs(ahead) == MOST_WAITING else turn
        sent[stream] += 1
        if pairs.add(stream, stamped(JointState(), 20 * sent[stream])) is not None:
            assert sent[stream] == min(sent.values())
            found.append(sent[stream])
    assert found == list(range(1, min(sent.values()) + 1))
    assert not left_out
