"""The exercise `reach`: right answers in various styles, and wrong ones."""

import threading
from copy import deepcopy

import rclpy
from rclpy.duration import Infinite
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, HistoryPolicy, QoSProfile, ReliabilityPolicy, qos_profile_sensor_data
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


class OneProfile:
    """Change a profile of its own between the publisher and the subscription, and log in a timer."""

    def __init__(self, node):
        qos = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL, lifespan=Infinite)
        self.publisher = node.create_publisher(JointState, WALL, qos)
        qos.reliability, qos.durability = ReliabilityPolicy.BEST_EFFORT, DurabilityPolicy.VOLATILE
        node.create_timer(timer_period_sec=1.0, callback=lambda: node.get_logger().debug("alive"))
        node.create_subscription(JointState, ROBOT, self.on_joint_state, qos)

    def on_joint_state(self, message):
        self.publisher.publish(message)


RIGHT = [OtherProfiles, Copies, Counts, Renamed, OneProfile]


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


class Once(Relay):
    def __init__(self, node):
        super().__init__(node)
        self.node, self.newest = node, None

    def on_joint_state(self, message):
        self.newest = message
        self.timer = self.node.create_timer(0.0, self.on_timer)

    def on_timer(self):
        self.publisher.publish(self.newest)
        self.timer.cancel()


class Again(Timed):
    def on_joint_state(self, message):
        super().on_joint_state(message)
        self.publisher.publish(message)


class InAThread(Relay):
    def on_joint_state(self, message):
        threading.Thread(target=self.publisher.publish, args=(message,)).start()


class Previous(Relay):
    previous = None

    def on_joint_state(self, message):
        if self.previous:
            self.publisher.publish(self.previous)
        self.previous = message


class IfConnected(Relay):
    def on_joint_state(self, message):
        if self.publisher.get_subscription_count() > 0:
            self.publisher.publish(message)


class IfCounted(Counts):
    def on_joint_state(self, message):
        if self.node.count_subscribers(WALL):
            self.publisher.publish(message)


class SharedProfile(Relay):
    def __init__(self, node):
        qos = qos_profile_sensor_data
        qos.reliability, qos.durability = ReliabilityPolicy.RELIABLE, DurabilityPolicy.TRANSIENT_LOCAL
        self.publisher = node.create_publisher(JointState, WALL, qos)
        self.subscription = node.create_subscription(JointState, ROBOT, self.on_joint_state, qos_profile_sensor_data)


class OwnNode(Relay):
    def __init__(self, node):
        super().__init__(rclpy.create_node("own"))


class OwnNodeClass(Relay):
    def __init__(self, node):
        super().__init__(Node("own"))


class Echo(Relay):
    def __init__(self, node):
        super().__init__(node)
        node.create_subscription(JointState, WALL, self.on_joint_state, KEPT)


SUBSCRIBED, PUBLISH = "self.on_joint_state, qos_profile_sensor_data", "self.publisher.publish(message)"
NEW = "Your code probably changes the message, creates a new one, or publishes twice"
WRONG = [
    (InTheCallback, ["creates the publisher only in the callback"]),
    (HearsFirst, "Create the subscription last"),
    (OnlyChanges, "skips a message that repeats"),
    *((kind, "immediately, and only in on_joint_state") for kind in (Timed, Once, Again, InAThread)),
    (Previous, "your code publishes the previous message"),
    *((kind, "only while a screen is connected") for kind in (IfConnected, IfCounted)),
    (SharedProfile, "Make a new QoSProfile for the publisher"),
    *((kind, "spins the node that") for kind in (OwnNode, OwnNodeClass)),
    (Echo, "more than once"),
]
WRONG += [
    (edited(reach, edit), cause)
    for edit, cause in [
        ((SUBSCRIBED, "self.on_joint_state, 1"), "your subscription asks for RELIABLE"),
        (("LOCAL)", "LOCAL, lifespan=Duration(seconds=10))"), "Omit lifespan"),
        (('"/wall/joint_state", kept', '"/wall/joint_state", 10'), "your publisher is VOLATILE"),
        (('"/wall/joint_state"', '"/wall/joint_states"'), "publishes on a different topic"),
        (('"/robot/joint_state"', '"/Robot/joint_state"'), "subscribes to a different topic"),
        ((PUBLISH, "self.publisher.publish(JointState(name=message.name, position=message.position))"), NEW),
        ((PUBLISH, "message.header.stamp.sec += 1\nself.publisher.publish(message)"), NEW),
        ((PUBLISH, f"{PUBLISH}\n{PUBLISH}"), NEW),
        ((PUBLISH, f"if message.position[0]:\n    {PUBLISH}"), "treats a value of 0 as missing"),
    ]
]
