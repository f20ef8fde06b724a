"""The exercise `reach`: connect two incompatible programs.

A robot's program publishes `JointState` on `/robot/joint_state`, with `qos_profile_sensor_data`: best effort and
volatile. A screen on the wall subscribes to `/wall/joint_state` and asks for `RELIABLE` and
`TRANSIENT_LOCAL`, because it often starts late. You can't change these programs. A `QoSProfile(depth=...)` is
`RELIABLE` by default; here, any depth works.

Write the class `Relay`, which connects them. `Relay(node)` creates a subscription and a publisher on the node, which is
already spinning.

- Each of the robot's messages reaches the screen, unchanged, exactly once and in order, even if it repeats the
  previous one.
- `on_joint_state` is the callback. It publishes immediately and creates no publisher or subscription: subscriptions
  take time to discover a publisher.
- The first message can arrive as soon as the subscription exists, so create it last.
- A screen that starts late gets the robot's newest message, however old it is, even if it was sent before any
  screen was running.

Hint 1: Look at the two connections separately. In each connection, the publisher offers a QoS and the subscription asks
for one. What is the most that the relay can ask of the robot, and the least that it has to offer the screen?

Hint 2: The subscription asks for no more than the robot offers: give it the robot's own profile. The publisher offers
everything that the screen asks for: a QoSProfile with a depth of 1, whose reliability is RELIABLE by default, and whose
durability you set. The callback publishes the message that it gets.

Hint 3: kept = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL). In __init__, self.publisher =
node.create_publisher(JointState, "/wall/joint_state", kept), and then self.subscription =
node.create_subscription(JointState, "/robot/joint_state", self.on_joint_state, qos_profile_sensor_data).

Notice that a relay can connect almost any two programs if it asks for little and offers a lot.
"""

from contextlib import suppress
from typing import Any

from rclpy.duration import Duration, Infinite
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy, qos_profile_sensor_data
from sensor_msgs.msg import JointState

from tutorial.checks.engine.cases import Case, Cases, Mistake, Run, both, replace
from tutorial.checks.engine.failure import Misuse
from tutorial.checks.engine.memory_node import Endpoint as Made
from tutorial.checks.engine.memory_node import MemoryNode
from tutorial.checks.engine.real_dds import ros_node, wait
from tutorial.checks.engine.trial import Trial
from tutorial.checks.exercise import Exercise
from tutorial.ros.doctor.facts import Endpoint
from tutorial.ros.doctor.rules import misfits


class Relay:
    """Publish each of the robot's messages for the screen."""

    def __init__(self, node: Any) -> None:
        kept = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
        self.publisher = node.create_publisher(JointState, "/wall/joint_state", kept)
        self.subscription = node.create_subscription(
            JointState, "/robot/joint_state", self.on_joint_state, qos_profile_sensor_data
        )

    def on_joint_state(self, message: JointState) -> None:
        """Publish a message."""
        self.publisher.publish(message)


MISTAKES = [
    Mistake("your subscription asks for RELIABLE, the default. "
            "The robot offers BEST_EFFORT: use qos_profile_sensor_data.",
            replace("self.on_joint_state, qos_profile_sensor_data", "self.on_joint_state, 10")),
    Mistake("your subscription asks for TRANSIENT_LOCAL. The robot offers VOLATILE: use qos_profile_sensor_data.",
            replace("self.on_joint_state, qos_profile_sensor_data",
                    "self.on_joint_state, QoSProfile(depth=1, reliability=ReliabilityPolicy.BEST_EFFORT, "
                    "durability=DurabilityPolicy.TRANSIENT_LOCAL)")),
    Mistake("your subscription requests the screen's QoS. The robot offers less: use qos_profile_sensor_data.",
            replace("self.on_joint_state, qos_profile_sensor_data", "self.on_joint_state, kept")),
    Mistake("your publisher is VOLATILE, and the screen asks for TRANSIENT_LOCAL: set the durability in its profile.",
            replace("durability=DurabilityPolicy.TRANSIENT_LOCAL", "durability=DurabilityPolicy.VOLATILE")),
    Mistake("your publisher is BEST_EFFORT, and the screen asks for RELIABLE: leave the reliability at its default.",
            replace("depth=1, durability", "depth=1, reliability=ReliabilityPolicy.BEST_EFFORT, durability")),
    Mistake("your publisher drops old messages, so a screen that starts late gets none. Omit lifespan.",
            replace("LOCAL)", "LOCAL, lifespan=Duration(seconds=1))")),
    Mistake("your publisher offers only what the robot offers. The screen asks for RELIABLE and TRANSIENT_LOCAL.",
            replace('"/wall/joint_state", kept', '"/wall/joint_state", qos_profile_sensor_data')),
    Mistake("your code subscribes to the screen's topic, and publishes on the robot's: swap the topics.",
            both(replace('"/wall/joint_state"', "ROBOT"), replace('"/robot/joint_state"', "WALL"))),
    Mistake("your code publishes the previous message, so the last one is missing. "
            "Publish the message that the callback gets.",
            replace("self.publisher.publish(message)", "if hasattr(self, 'previous'):\n"
                    "    self.publisher.publish(self.previous)\nself.previous = message")),
]  # fmt: skip
MEANING = ("Compare your code with this: one subscription to /robot/joint_state with qos_profile_sensor_data, one "
           "publisher on /wall/joint_state that is RELIABLE and TRANSIENT_LOCAL, both created in __init__, and a "
           "callback that publishes the message that it gets.")  # fmt: skip

ELSEWHERE = "Publish each message immediately, and only in on_joint_state."
SHARED = "Your subscription uses this profile, too. Make a new QoSProfile for the publisher."
ROBOT, WALL = "/robot/joint_state", "/wall/joint_state"
OFFERED = QoSProfile(depth=5, reliability=ReliabilityPolicy.BEST_EFFORT)  # an answer can change rclpy's own profile
ASKED = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)


def described(kind: type, qos: QoSProfile) -> Endpoint:
    """Describe one side of a connection for the doctor's rules."""
    return Endpoint(
        type=kind.__name__,
        reliable=qos.reliability != ReliabilityPolicy.BEST_EFFORT,
        transient_local=qos.durability == DurabilityPolicy.TRANSIENT_LOCAL,
    )


class Wiring:
    """The robot and the screen, with the answer's relay between them.

    Messages get through even if DDS would not connect the two sides, so that each case observes only one thing.

    Attributes:
        node: the relay's node.
        is_profile_changed: whether the answer has changed `qos_profile_sensor_data` itself.
    """

    def __init__(self, trial: Trial, kind: type[MemoryNode] = MemoryNode, screens: int = 1) -> None:
        self._trial = trial
        self._published: list[tuple[str, JointState]] = []
        self.node = kind(trial, lambda made, message: self._published.append((made.topic_name, message)))
        self.node.subscribers = screens
        self._relay = trial.call(trial.answer, self.node)
        own = getattr(trial.answer.__init__, "__globals__", {}).get("qos_profile_sensor_data", qos_profile_sensor_data)
        self.is_profile_changed = any(_asked(each) != _asked(OFFERED) for each in (qos_profile_sensor_data, own))
        qos_profile_sensor_data.reliability, qos_profile_sensor_data.durability = _asked(OFFERED)  # for the solution

    def send(self, message: JointState) -> None:
        """Have the robot publish a message."""
        subscriptions = self.node.subscriptions
        for each in [each for each in subscriptions if each.topic_name == ROBOT] or subscriptions:
            self._trial.call(each.callback, message)

    def check_elsewhere(self) -> None:
        """Check that only the callback publishes, not a timer or a thread.

        Raises:
            Misuse: a timer publishes, or a thread is running.
        """
        count = len(self._published)
        for each in self.node.timers:
            if not each.is_canceled():
                self._trial.call(each.callback)
        if len(self._published) > count:
            raise Misuse("it publishes from a timer", ELSEWHERE)
        if "thread" in self._trial.noted:
            raise Misuse("it starts a thread", ELSEWHERE)

    @property
    def shown(self) -> list[JointState]:
        """The messages that the screen has received; if it has received none, the messages on other topics."""
        on_wall = [message for topic, message in self._published if topic == WALL]
        return on_wall or [message for _, message in self._published]

    def heard(self, made: Made) -> str:
        """Describe the connection from the robot to one of the relay's subscriptions."""
        return _connection(made, ROBOT, misfits(described(JointState, OFFERED), described(made.kind, made.qos)))

    def seen(self, made: Made) -> str:
        """Describe the connection from one of the relay's publishers to the screen."""
        problems = misfits(described(made.kind, made.qos), described(JointState, ASKED))
        is_limited = made.qos.lifespan not in (Duration(), Infinite)
        return _connection(made, WALL, [*problems, "lifespan"] if is_limited else problems)


class HastyNode(MemoryNode):
    """A node whose subscriptions receive a message as soon as they exist."""

    def create_subscription(self, *given: Any, **named: Any) -> Made:
        """Create a subscription, and call its callback."""
        made = super().create_subscription(*given, **named)
        with suppress(AttributeError):  # the publisher may be missing; other cases detect all other mistakes
            made.callback(message_of(0.5))
        return made


def _asked(qos: QoSProfile) -> tuple[ReliabilityPolicy, DurabilityPolicy]:
    return qos.reliability, qos.durability


def _connection(made: Made, topic: str, problems: list[str]) -> str:
    if made.topic_name != topic:
        return f"on {made.topic_name}"
    return f"incompatible: {', '.join(problems)}" if problems else "connected"


def from_robot(trial: Trial) -> str:
    """Observe the connection from the robot to the relay.

    Raises:
        Misuse: there is no connection, because the answer has changed the profile that its subscription uses.
    """
    wiring = Wiring(trial)
    heard = ", ".join(map(wiring.heard, wiring.node.subscriptions)) or "no subscription"
    if wiring.is_profile_changed and heard != "connected":
        raise Misuse("it changes qos_profile_sensor_data itself", SHARED)
    return heard


def to_screen(trial: Trial) -> str:
    """Observe the connection from the relay to the screen."""
    wiring = Wiring(trial)
    return ", ".join(wiring.seen(each) for each in wiring.node.kept if not each.callback) or "no publisher"


def message_of(angle: float) -> JointState:
    """Make one of the robot's messages."""
    message = JointState(name=["TURRET_Y"], position=[angle], velocity=[0.5], effort=[0.25])
    message.header.frame_id = "Tank"
    message.header.stamp.sec = 7
    return message


def shown(*angles: float, relays: int = 1, screens: int = 1) -> Run:
    """Observe the messages that the screen shows: each message's angle, and whether the message has changed."""

    def run(trial: Trial) -> list[str]:
        wirings = [Wiring(trial, screens=screens) for _ in range(relays)]
        found = []
        for wiring in wirings:
            for angle in angles:
                wiring.send(message_of(angle))
            wiring.check_elsewhere()
            unchanged = [message_of(angle) for angle in angles]
            found += [f"{each.position.tolist()}{'' if each in unchanged else ' changed'}" for each in wiring.shown]
        return found

    return run


def at_once(trial: Trial) -> str:
    """Observe what the screen shows if a message arrives before `Relay(node)` has returned."""
    return ", ".join(str(each.position.tolist()) for each in Wiring(trial, HastyNode).shown)


def on_ros(trial: Trial) -> str:
    """Try the relay with actual rclpy nodes and a screen that starts late."""
    early, late = list[JointState](), list[JointState]()
    with ros_node() as node, ros_node() as others:
        trial.call(trial.answer, node)
        robot = others.create_publisher(JointState, ROBOT, OFFERED)
        wait(robot.get_subscription_count, "the robot's messages do not reach the relay. Check its subscription.")
        others.create_subscription(JointState, WALL, early.append, ASKED)
        wait(lambda: early or robot.publish(message_of(0.5)), "no message reaches the screen. Check the QoS.")
        others.create_subscription(JointState, WALL, late.append, ASKED)
        wait(lambda: late, "a screen that starts late gets no message. Check the durability.")
    return f"a late screen shows {late[0].position.tolist()}"


CASES = [
    Case("from the robot to the relay", from_robot,
         "Your code probably subscribes to a different topic, with a different type, outside of __init__, or more than "
         "once."),
    Case("from the relay to the screen", to_screen,
         "Your code probably publishes on a different topic, publishes a different type, or creates the publisher only "
         "in the callback."),
    Case("a message", shown(0.5),
         "Your code probably changes the message, creates a new one, or publishes twice. "
         "Publish the received message once."),
    Case("a message while no screen is connected", shown(0.3, screens=0),
         "Your code probably publishes only while a screen is connected. "
         "Publish every message: a screen that starts late needs the newest one."),
    Case("five messages", shown(0.1, 0.2, 0.3, 0.2, 0.1),
         "Your code probably drops messages or changes their order. Publish each message in the callback."),
    Case("the same message three times", shown(0.5, 0.5, 0.5),
         "Your code probably skips a message that repeats the previous one. Publish each one."),
    Case("messages of 0", shown(0.0, 0.0), "Your code probably treats a value of 0 as missing. Publish each message."),
    Case("a message that arrives as soon as the relay subscribes", at_once,
         "Your code probably subscribes before the publisher exists. Create the subscription last."),
    Case("two relays", shown(0.5, relays=2),
         "Your code probably stores something in a class attribute, which all relays share. "
         "Store it on self, in __init__."),
]  # fmt: skip
IMPORTS = ("from rclpy.qos import DurabilityPolicy, QoSProfile, qos_profile_sensor_data",)
reach = Exercise("reach", __doc__, Cases(Relay, CASES, MISTAKES, MEANING, on_ros=on_ros), imports=IMPORTS)
