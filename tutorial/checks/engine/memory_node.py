"""A node in memory: the part of rclpy's node that a controller uses, without any middleware."""

import inspect
import sys
from collections.abc import Callable
from copy import copy
from functools import partial
from typing import Any

from rclpy.clock import Clock
from rclpy.expand_topic_name import expand_topic_name
from rclpy.logging import get_logger
from rclpy.qos import QoSProfile

from tutorial.checks.engine.exceptions import AT_ONCE
from tutorial.checks.engine.failure import Failure, Misuse
from tutorial.checks.engine.trial import Trial

IN_STOP = (
    "Your code probably destroys the publisher in stop, so the publisher is missing after a restart. "
    "Destroy it in unconfigure."
)
THE_NODE = "config.node belongs to the whole program. In unconfigure, destroy only the {0}: {1}."
TOO_MANY = (
    "Your code probably creates a {0} each time the simulation starts, or super().configure(config) creates a second "
    "one. Create only one {0}, in configure."
)
LEFT = (
    "unconfigure is probably missing, or lacks {1}. Setting a flag, setting self.{0} to None, or calling "
    "self.{0}.destroy() does not notify the node."
)


class Endpoint:
    """A publisher or a subscription of a `MemoryNode`.

    Attributes:
        kind: the class of its messages.
        topic_name: the topic's full name.
        callback: a subscription's callback; None for a publisher.
        qos: its quality of service.
        depth: how many messages a subscription stores while its thread is busy.
        destroyed: whether the learner has destroyed the endpoint.
    """

    def __init__(self, node: "MemoryNode", kind: type, topic: str, qos: Any, callback: Any = None) -> None:
        self.topic_name = expand_topic_name(topic, "tank", node.namespace)
        self.kind, self.callback, self.destroyed = kind, callback, False
        self.qos = copy(qos) if isinstance(qos, QoSProfile) else QoSProfile(depth=qos)  # an answer may change qos later
        self.depth = self.qos.depth
        self._node = node

    def publish(self, message: Any) -> None:
        """Hand a message to the node."""
        if self.destroyed:
            raise Misuse(f"it publishes on {self.topic_name} with a destroyed publisher", IN_STOP)
        if not isinstance(message, self.kind):
            raise TypeError(f"Expected {self.kind}, got {type(message)}")
        self._node.publish(self, message)

    def destroy(self) -> None:
        """Destroy the endpoint without notifying the node."""
        self.destroyed = True

    def get_subscription_count(self) -> int:
        """Return how many other programs subscribe to the topic."""
        return self._node.subscribers

    def get_publisher_count(self) -> int:
        """Return 1, as if another program published on the topic."""
        return 1


class Timer:
    """A timer of a `MemoryNode`. It fires only if a case calls the callback.

    Args:
        callback: called when the timer fires.
    """

    def __init__(self, callback: Callable[[], object]) -> None:
        self.callback, self._is_canceled = callback, False

    def cancel(self) -> None:
        """Stop the timer."""
        self._is_canceled = True

    def reset(self) -> None:
        """Start the timer again."""
        self._is_canceled = False

    def is_canceled(self) -> bool:
        """Return whether the timer is stopped."""
        return self._is_canceled


class MemoryNode:
    """A stand-in for rclpy's node, with only the methods that a controller uses. It sends nothing to other programs.

    Args:
        trial: records whether the answer makes a timer.
        publish: called for each published message, with its publisher and the message.
        namespace: the node's namespace.

    Attributes:
        get_clock, get_logger, get_name, get_namespace, destroy_publisher, destroy_subscription: as in rclpy.
        made: all publishers and subscriptions that were ever made.
        kept: the publishers and subscriptions that the node still has, including those that the learner has
            destroyed without notifying the node.
        timers: all timers that were ever made.
        subscribers: how many subscriptions in other programs each publisher is connected to.
        destroyed: whether the learner has destroyed the node itself.
    """

    def __init__(
        self, trial: Trial, publish: Callable[[Endpoint, Any], object] = lambda *_: None, namespace: str = "/"
    ) -> None:
        self.publish, self.namespace, self.destroyed = publish, namespace, False
        self.made, self.kept, self.timers = list[Endpoint](), list[Endpoint](), list[Timer]()
        self.subscribers = 1
        self.get_clock, self.get_logger = Clock, partial(get_logger, "tank")
        self.destroy_publisher, self.destroy_subscription = partial(self._drop, False), partial(self._drop, True)
        self.get_name, self.get_namespace = (lambda: "tank"), (lambda: namespace)
        self._trial = trial

    def create_publisher(self, msg_type: type, topic: str, qos_profile: Any, **_: Any) -> Endpoint:
        """Make a publisher."""
        return self._keep(Endpoint(self, msg_type, topic, qos_profile))

    def create_subscription(self, msg_type: type, topic: str, callback: Any, qos_profile: Any, **_: Any) -> Endpoint:
        """Make a subscription.

        Raises:
            Misuse: the callback is not callable, or it is a coroutine function.
        """
        _check_callback(callback, msg_type)
        return self._keep(Endpoint(self, msg_type, topic, qos_profile, callback))

    def create_timer(self, timer_period_sec: float, callback: Callable[[], object], **_: Any) -> Timer:  # noqa: ARG002
        """Make a timer that never fires by itself, and note ``"timer"`` in the trial."""
        self._trial.note("timer", sys._getframe())
        self.timers.append(Timer(callback))
        return self.timers[-1]

    def destroy_timer(self, timer: Timer) -> bool:
        """Stop a timer."""
        timer.cancel()
        return timer in self.timers

    def count_subscribers(self, topic_name: str) -> int:  # noqa: ARG002
        """Return how many other programs subscribe to a topic; the number is the same for all topics."""
        return self.subscribers

    @property
    def subscriptions(self) -> list[Endpoint]:
        """The subscriptions that the node still has."""
        return [each for each in self.kept if each.callback]

    def listeners(self, message: Any) -> list[Any]:
        """Return the callbacks of all subscriptions that receive messages of the given message's class."""
        return [each.callback for each in self.subscriptions if each.kind is type(message)]

    def on(self, kind: type, topic: str) -> str:
        """Name the topics that the answer uses for a class of messages.

        If the given topic is one of these topics, name only the given topic.
        """
        made = [each.topic_name for each in self.made if each.kind is kind]
        wanted = expand_topic_name(topic, "tank", self.namespace)
        return f"{kind.__name__} on {wanted if wanted in made else ', '.join(made) or 'no topic'}"

    def check_left(self) -> str:
        """Check that the answer has left nothing behind, and return "nothing is left".

        Raises:
            Failure: a publisher or subscription is left, or the answer has destroyed the node.
        """
        if not self.kept and not self.destroyed:
            return "nothing is left"
        alone = " and was not notified that they were destroyed" * any(each.destroyed for each in self.kept)
        left = f"the node still has {len(self.kept)} of {len(self.made)} topics{alone}"
        cause = TOO_MANY if len(self.kept) < len(self.made) else LEFT
        if self.destroyed:
            left, cause = "it destroys the program's node", THE_NODE
        kind = "subscription" if self.subscriptions else "publisher"
        raise Failure("unconfigure", Misuse(left, cause.format(kind, f"self.node.destroy_{kind}(self.{kind})")))

    def destroy_node(self) -> None:
        """Record that the learner has destroyed the whole node."""
        self.destroyed = True

    def _drop(self, has_callback: bool, endpoint: Endpoint) -> bool:
        is_there = endpoint in self.kept and bool(endpoint.callback) == has_callback
        if is_there:
            self.kept.remove(endpoint)
            endpoint.destroy()
        return is_there

    def _keep(self, endpoint: Endpoint) -> Endpoint:
        self.made.append(endpoint)
        self.kept.append(endpoint)
        return endpoint


def _check_callback(callback: Any, message_type: type) -> None:
    name = "".join(f"_{letter.lower()}" if letter.isupper() else letter for letter in message_type.__name__)
    if not callable(callback):
        text = f"create_subscription gets {callback!r} instead of a function"
        raise Misuse(text, AT_ONCE.format(f"on{name}"))
    if inspect.iscoroutinefunction(callback):
        text = f"{callback.__name__} is a coroutine function (async def), and nobody awaits it"
        raise Misuse(text, "Write def, not async def. In a callback, store the message or post a call, and return.")
