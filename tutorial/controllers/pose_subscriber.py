"""Step 7: show the pose and the joints of another program's robot, both with the same stamp."""

from collections.abc import Callable
from typing import Any

from geometry_msgs.msg import Transform, TransformStamped
from sensor_msgs.msg import JointState
from tf2_msgs.msg import TFMessage

from tutorial.body import Body
from tutorial.controller import ControllerConfig, SimpleController
from tutorial.joints import JointMatcher
from tutorial.pose_faults import Tally, fault_of

MOST_WAITING = 50  # messages per topic: a second's worth
ALONE, REPEATED = "without a partner with the same stamp", "with a repeated stamp"


class PoseSubscriber(SimpleController):
    """Show the pose and the joint states that another program publishes, always as a pair with equal stamps."""

    def configure(self, config: ControllerConfig) -> None:  # main thread
        """Subscribe to the body's joint states, and to all robots' transforms."""
        self.body, self.node, self.call_later = config.body, config.node, config.call_later
        self.frame = f"{self.body.name}/base_link"
        self.tally = Tally(self.body.name, self.node)
        self.pairs = self.make_pairs()
        topic = f"{self.body.name}/joint_state"
        self.joint_states = self.node.create_subscription(JointState, topic, self.on_joint_state, 10)
        self.transforms = self.node.create_subscription(TFMessage, "/tf", self.on_tf, 100)
        self.matcher = JointMatcher(self.body.joint_ranges, self.joint_states.get_publisher_count)

    def make_pairs(self) -> Any:
        """Return the object that pairs messages with equal stamps."""
        return StampPairs(self.tally.leave_out)

    def on_joint_state(self, message: JointState) -> None:  # executor's thread: post and return
        """Hand the message to the main thread."""
        self.call_later(self.take, "joints", message)

    def on_tf(self, message: TFMessage) -> None:  # executor's thread
        """Hand this body's transform to the main thread, and ignore the transforms of other bodies."""
        own = [each for each in message.transforms if each.child_frame_id == self.frame]
        for transform in own[:1]:
            self.call_later(self.take, "pose", transform)

    def take(self, stream: str, message: JointState | TransformStamped) -> None:  # main thread
        """Show the message together with its partner, or store it until its partner arrives."""
        if fault := fault_of(message):
            self.tally.leave_out(fault)
        elif pair := self.pairs.add(stream, message):
            self.show(*pair)

    def show(self, joints: JointState, pose: TransformStamped) -> None:
        """Set the pose and the joints together, or neither if the joint states are dropped."""
        positions, report = self.matcher.match(joints)
        if not report.dropped:
            set_pose(self.body, pose.transform)
            self.body.set_joint_positions(positions)
            self.body.calc_forward_kinematics()
            self.tally.shown += 1
        self.body.notify_change(report)

    def unconfigure(self) -> None:  # main thread
        """Stop listening."""
        self.node.destroy_subscription(self.joint_states)
        self.node.destroy_subscription(self.transforms)


def set_pose(body: Body, transform: Transform) -> None:
    """Set the pose of a displayed body to a transform in the frame ``odom``. Main thread only."""
    p, q = transform.translation, transform.rotation
    body.position = p.x, p.y, p.z
    body.orientation_wxyz = q.w, q.x, q.y, q.z


class StampPairs:
    """Pairs messages that have equal stamps and come from two streams, much like `message_filters.TimeSynchronizer`.

    A message waits for its partner. Both streams are in order, so a message older than a complete pair will never get a
    partner. If too many messages are waiting, the first to arrive is dropped, whatever its stamp, because the stamps of
    a restarted publisher can begin at 0 again.

    Args:
        leave_out: called with the reason for each message that is dropped.
    """

    def __init__(self, leave_out: Callable[[str], object]) -> None:
        self.leave_out = leave_out
        self.waiting: dict[tuple[int, int], dict[str, Any]] = {}  # by stamp, in order of arrival; then by stream
        self.newest: tuple[int, int] | None = None  # the stamp of the last pair

    def add(self, stream: str, message: Any) -> tuple[Any, Any] | None:
        """Add a stream's next message. Return the joints and the pose with its stamp, or None if one is missing."""
        stamp = message.header.stamp.sec, message.header.stamp.nanosec
        if stamp == self.newest:
            self.leave_out(REPEATED)
            return None
        if stream in self.waiting.get(stamp, ()):
            del self.waiting[stamp]
            self.leave_out(REPEATED)
        together = self.waiting.setdefault(stamp, {})
        together[stream] = message
        complete = len(together) == 2
        while (first := next(iter(self.waiting))) != stamp and (complete or len(self.waiting) > MOST_WAITING):
            del self.waiting[first]
            self.leave_out(ALONE)
        if not complete:
            return None
        self.newest = stamp
        del self.waiting[stamp]
        return together["joints"], together["pose"]
