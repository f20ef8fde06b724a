"""The exercise `reach`: right answers in various styles, and wrong ones."""

from copy import deepcopy

from rclpy.qos import DurabilityPolicy, HistoryPolicy, QoSProfile, ReliabilityPolicy
from sensor_msgs.msg import JointState

from tutorial.checks.reach import ROBOT, WALL, Relay, reach

from . import edited

KEPT = QoSProfile(depth=10, durability=DurabilityPolicy.TRANSIENT_LOCAL)
EASY = QoSProfile(depth=1, reliability=ReliabilityPolicy.BEST_EFFORT)


class OtherProfiles:
    """Use relative names, and profiles of its own."""

    def __init__(self, node):
        everything = {"history": HistoryPolicy.KEEP_LAST, "reliability": ReliabilityPolicy.RELIABLE, "depth": 5}
        kept = QoSProfile(durability=DurabilityPolicy.TRANSIENT_LOCAL, **everything)
        self.out = node.create_publisher(JointState, "wall/joint_state", kept)
        self.ear = node.create_subscription(JointState, "robot/joint_state", lambda m: self.on_joint_state(m), EASY)

    def on_joint_state(self, message):
        return self.out.publish(message)


class Copies(Relay):
    """Publish copies."""

    def on_joint_state(self, message):
        self.publisher.publish(deepcopy(message))


class Counts(Relay):
    """Keep the node and a number."""

    def __init__(self, node):
        self.node, self.count = node, 0
        self.publisher = self.node.create_publisher(JointState, WALL, KEPT)
        self.subscription = self.node.create_subscription(JointState, ROBOT, self.on_joint_state, EASY)

    def on_joint_state(self, message):
        self.count += 1
        super().on_joint_state(message)


class Renamed:
    """Use different names."""

    def __init__(self, rclpy_node):
        self.to_wall = rclpy_node.create_publisher(JointState, WALL, KEPT)
        rclpy_node.create_subscription(JointState, ROBOT, self.on_joint_state, EASY)

    def on_joint_state(self, state):
        self.to_wall.publish(state)


RIGHT = [OtherProfiles, Copies, Counts, Renamed]


class InTheCallback(Relay):
    def __init__(self, node):
        self.node = node
        node.create_subscription(JointState, ROBOT, self.on_joint_state, EASY)

    def on_joint_state(self, message):
        self.node.create_publisher(JointState, WALL, KEPT).publish(message)


class HearsFirst(Relay):
    def __init__(self, node):
        self.subscription = node.create_subscription(JointState, ROBOT, self.on_joint_state, EASY)
        self.publisher = node.create_publisher(JointState, WALL, KEPT)


class OnlyChanges(Relay):
    last = None

    def on_joint_state(self, message):
        if message.position != self.last:
            self.last = message.position
            self.publisher.publish(message)


class Timed(Relay):
    def __init__(self, node):
        super().__init__(node)
        self.newest = None
        node.create_timer(0.1, lambda: self.publisher.publish(self.newest))

    def on_joint_state(self, message):
        self.newest = message


class Echo(Relay):
    def __init__(self, node):
        super().__init__(node)
        node.create_subscription(JointState, WALL, self.on_joint_state, KEPT)


SUBSCRIBED, PUBLISH = "self.on_joint_state, qos_profile_sensor_data", "self.publisher.publish(message)"
NEW = "You probably publish a new message, change it, or publish it twice"
WRONG = [
    (InTheCallback, ["create the publisher only in the callback"]),
    (HearsFirst, "Create the subscription last"),
    (OnlyChanges, "skip a message that repeats"),
    (Timed, "is missing or never reached"),
    (Echo, "more than once"),
]
WRONG += [
    (edited(reach, edit), cause)
    for edit, cause in [
        ((SUBSCRIBED, "self.on_joint_state, 1"), "your subscription asks for RELIABLE"),
        (('"/wall/joint_state", kept', '"/wall/joint_state", 10'), "your publisher is VOLATILE"),
        (('"/wall/joint_state"', '"/wall/joint_states"'), "publish on a different topic"),
        (('"/robot/joint_state"', '"/Robot/joint_state"'), "subscribe to a different topic"),
        ((PUBLISH, "self.publisher.publish(JointState(name=message.name, position=message.position))"), NEW),
        ((PUBLISH, "message.header.stamp.sec += 1\nself.publisher.publish(message)"), NEW),
        ((PUBLISH, f"{PUBLISH}\n{PUBLISH}"), NEW),
        ((PUBLISH, f"if message.position[0]:\n    {PUBLISH}"), "treat 0 as missing"),
    ]
]
