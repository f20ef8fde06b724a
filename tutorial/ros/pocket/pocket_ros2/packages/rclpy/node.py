"""Nodes."""

from __future__ import annotations

import threading
import weakref
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager, suppress
from typing import TYPE_CHECKING, Any, TypeVar

from _rosidl.message import Message
from rcl_interfaces.msg import Log, ParameterEvent
from rclpy import _absent, qos
from rclpy._arguments import Arguments
from rclpy._middleware import TransportError
from rclpy._names import validate_topic_name
from rclpy._node_graph import NodeGraph
from rclpy._node_parameters import NodeParameters
from rclpy._rclpy_pybind11 import InvalidHandle, RCLError
from rclpy._wire import check_message_type
from rclpy.clock import Clock, ROSClock
from rclpy.constants import S_TO_NS
from rclpy.duration import Duration
from rclpy.exceptions import NotInitializedException
from rclpy.guard_condition import GuardCondition
from rclpy.logging import LoggingSeverity, RcutilsLogger, get_logger, listeners
from rclpy.parameter import PARAMETER_SEPARATOR_STRING, Parameter  # noqa: F401  (the first is a re-export)
from rclpy.publisher import Publisher
from rclpy.qos import DurabilityPolicy, QoSProfile, qos_profile_parameter_events, qos_profile_services_default  # noqa: F401
from rclpy.subscription import Subscription
from rclpy.time import Time
from rclpy.timer import Rate, Timer
from rclpy.utilities import get_default_context
from rosgraph_msgs.msg import Clock as ClockMessage

if TYPE_CHECKING:
    from rclpy.context import Context
    from rclpy.executors import SingleThreadedExecutor

Entity = TypeVar("Entity", Publisher, Subscription, Timer, GuardCondition)

HIDDEN_NODE_PREFIX = "_"
ROSOUT_QOS = QoSProfile(depth=1000, durability=DurabilityPolicy.TRANSIENT_LOCAL, lifespan=Duration(seconds=10))
CLOCK_QOS = QoSProfile(depth=1, reliability=qos.ReliabilityPolicy.BEST_EFFORT)


class Node(NodeGraph, NodeParameters):
    """A member of the node graph with a name, publishers, subscriptions and timers. Can be used from any thread.

    While its parameter ``use_sim_time`` is true, its clock and the timers that use this clock follow the messages on
    ``/clock``: the time advances when the callback for a ``/clock`` message runs, on the thread that spins.

    Args:
        node_name: the node's name; a remapping on the command line takes precedence.
        context: the node's context; if None, the default context.
        cli_args: a command line for this node only.
        namespace: prefix of the node's name and its topics' names.
        use_global_arguments: also use the process's command line.
        enable_rosout: also publish the node's log lines on ``/rosout``.
        start_parameter_services: has no effect, because the pocket ROS 2 has no services.
        parameter_overrides: values that take precedence over the values given to :meth:`declare_parameter`.
        allow_undeclared_parameters: allow setting and reading parameters that have not been declared.
        automatically_declare_parameters_from_overrides: declare the parameters in ``parameter_overrides`` and on the
            command line.
        **options: rclpy's other options, which the pocket ROS 2 does not support.

    Raises:
        NotInitializedException: ``rclpy.init()`` has not been called.
        NameValidationException: the name or the namespace breaks the naming rules.
    """

    _clock_subscription: Subscription  # exists while the node uses simulated time

    def __init__(
        self,
        node_name: str,
        *,
        context: Context | None = None,
        cli_args: Sequence[str] | None = None,
        namespace: str | None = None,
        use_global_arguments: bool = True,
        enable_rosout: bool = True,
        start_parameter_services: bool = True,  # noqa: ARG002
        parameter_overrides: Sequence[Parameter] | None = None,
        allow_undeclared_parameters: bool = False,
        automatically_declare_parameters_from_overrides: bool = False,
        **options: Any,
    ) -> None:
        _absent.refuse("Node.__init__", options)
        self._context = context or get_default_context()
        if not self._context.ok():
            raise NotInitializedException("cannot create node")
        arguments = [Arguments.parse(cli_args or ()), *([self._context.arguments] if use_global_arguments else [])]
        self._init_names(node_name, namespace or "/", arguments)
        self._init_parameters(self._name, arguments, parameter_overrides or (), allow_undeclared_parameters)
        self._clock = ROSClock()
        self._logger = get_logger(self._full_name()[1:].replace("/", "."))
        self._executor: weakref.ref[SingleThreadedExecutor] | None = None
        self._entities: tuple[Publisher | Subscription | Timer | GuardCondition, ...] = ()
        self._rosout: Publisher | None = None
        self._lock = threading.RLock()
        self._graph = self._context.graph
        self._entry = self._graph.add_node(self._namespace, self._name)
        self._leave_graph = weakref.finalize(self, self._graph.remove_node, self._entry)
        self._leave_graph.atexit = False
        if enable_rosout and "rosout" not in self._context.arguments.disabled_logs:
            with self._creating("publisher"):
                self._rosout = Publisher(self, Log, "/rosout", ROSOUT_QOS)
            listeners[self._logger.name] = self
        self._parameter_events = self.create_publisher(
            ParameterEvent, "/parameter_events", qos_profile_parameter_events
        )
        try:
            self._declare_first(automatically_declare_parameters_from_overrides)
        except BaseException:
            self.destroy_node()
            raise

    def get_logger(self) -> RcutilsLogger:
        """Return the node's logger."""
        return self._logger

    def get_clock(self) -> ROSClock:
        """Return the node's clock."""
        return self._clock

    @property
    def context(self) -> Context:
        """The node's context."""
        return self._context

    @property
    def executor(self) -> SingleThreadedExecutor | None:
        """The executor that runs the node's callbacks."""
        return self._executor() if self._executor else None

    @executor.setter
    def executor(self, new_executor: SingleThreadedExecutor | None) -> None:
        if (old := self.executor) is new_executor:
            return
        if old is not None:
            old.remove_node(self)
        self._executor = None if new_executor is None else weakref.ref(new_executor)
        if new_executor is not None:
            new_executor.add_node(self)

    @property
    def publishers(self) -> Iterator[Publisher]:
        """The node's publishers."""
        return (entity for entity in self._entities if isinstance(entity, Publisher))

    @property
    def subscriptions(self) -> Iterator[Subscription]:
        """The node's subscriptions."""
        return (entity for entity in self._entities if isinstance(entity, Subscription))

    @property
    def timers(self) -> Iterator[Timer]:
        """The node's timers."""
        return (entity for entity in self._entities if isinstance(entity, Timer))

    @property
    def guards(self) -> Iterator[GuardCondition]:
        """The node's guard conditions."""
        return (entity for entity in self._entities if isinstance(entity, GuardCondition))

    def create_publisher(
        self,
        msg_type: type[Message],
        topic: str,
        qos_profile: QoSProfile | int,
        *,
        publisher_class: type[Publisher] = Publisher,
        **options: Any,
    ) -> Publisher:
        """Create a publisher.

        Args:
            msg_type: class of the messages.
            topic: the topic's name; relative to the node's namespace unless it begins with a slash.
            qos_profile: the QoS, or just the number of messages to keep for slow subscriptions.
            publisher_class: the class to instantiate, such as a subclass of `Publisher` that overrides ``publish``.
            **options: rclpy's other options, which the pocket ROS 2 does not support.

        Raises:
            InvalidTopicNameException: the name breaks the naming rules.
            RCLError: the context has been shut down.
        """
        _absent.refuse("Node.create_publisher", options)
        profile = self._checked(msg_type, topic, qos_profile)
        with self._creating("publisher"):
            return self._add(publisher_class(self, msg_type, topic, profile))

    def create_subscription(
        self,
        msg_type: type[Message],
        topic: str,
        callback: Callable[..., object],
        qos_profile: QoSProfile | int,
        *,
        raw: bool = False,
        **options: Any,
    ) -> Subscription:
        """Create a subscription.

        Args:
            msg_type: class of the messages.
            topic: the topic's name; relative to the node's namespace unless it begins with a slash.
            callback: called on the thread that spins, with each message and, if it requires two arguments, a dict of
                the message's metadata.
            qos_profile: the QoS, or just the number of messages that can wait for the callback.
            raw: pass bytes to the callback instead of messages.
            **options: rclpy's other options, which the pocket ROS 2 does not support.

        Raises:
            InvalidTopicNameException: the name breaks the naming rules.
            RCLError: the context has been shut down.
        """
        _absent.refuse("Node.create_subscription", options)
        _absent.refuse_coroutine(callback)
        profile = self._checked(msg_type, topic, qos_profile)
        with self._creating("subscription"):
            return self._add(Subscription(self, msg_type, topic, callback, profile, raw))

    def create_timer(
        self,
        timer_period_sec: float,
        callback: Callable[[], object],
        callback_group: None = None,
        clock: Clock | None = None,
        autostart: bool = True,
    ) -> Timer:
        """Create a timer.

        Args:
            timer_period_sec: time between calls [s].
            callback: called without arguments, on the thread that spins.
            callback_group: not supported by the pocket ROS 2.
            clock: the timer's clock; if None, the node's clock, which can use simulated time.
            autostart: start immediately.

        Raises:
            RCLError: the period is negative, or the context has been shut down.
        """
        period_ns = int(float(timer_period_sec) * S_TO_NS)
        _absent.refuse("Node.create_timer", {"callback_group": callback_group})
        _absent.refuse_coroutine(callback)
        return self._add(Timer(self, callback, period_ns, clock or self._clock, autostart))

    def create_guard_condition(self, callback: Callable[[], object], callback_group: None = None) -> GuardCondition:
        """Create a guard condition.

        Args:
            callback: called without arguments, on the thread that spins, after any thread has triggered the condition.
            callback_group: not supported by the pocket ROS 2.
        """
        _absent.refuse("Node.create_guard_condition", {"callback_group": callback_group})
        _absent.refuse_coroutine(callback)
        return self._add(GuardCondition(self, callback))

    def create_rate(self, frequency: float, clock: Clock | None = None) -> Rate:
        """Create a rate for a loop that does not run on the executor's thread.

        Args:
            frequency: the number of times that the loop runs per second [Hz].
            clock: the rate's clock; if None, the node's clock.

        Raises:
            ValueError: the frequency is not positive.
        """
        if frequency <= 0:
            raise ValueError("frequency must be > 0")
        return Rate(self.create_timer(1.0 / frequency, lambda: None, clock=clock), context=self._context)

    def destroy_publisher(self, publisher: Publisher) -> bool:
        """Destroy one of the node's publishers; return False if the node has no such publisher."""
        return publisher in self.publishers and self._remove(publisher)

    def destroy_subscription(self, subscription: Subscription) -> bool:
        """Destroy one of the node's subscriptions; return False if the node has no such subscription."""
        return subscription in self.subscriptions and self._remove(subscription)

    def destroy_timer(self, timer: Timer) -> bool:
        """Destroy one of the node's timers; return False if the node has no such timer."""
        return timer in self.timers and self._remove(timer)

    def destroy_guard_condition(self, guard: GuardCondition) -> bool:
        """Destroy one of the node's guard conditions; return False if the node has no such guard condition."""
        return guard in self.guards and self._remove(guard)

    def destroy_rate(self, rate: Rate) -> bool:
        """Destroy one of the node's rates, and wake its sleepers; return False if the node has no such rate."""
        destroyed = self.destroy_timer(rate._timer)
        rate.destroy()
        return destroyed

    def destroy_node(self) -> None:
        """Destroy the node and its entities. Idempotent."""
        with self._lock:
            self._destroyed = True
            entities, self._entities = self._entities, ()
            rosout, self._rosout = self._rosout, None
        if rosout:
            listeners.pop(self._logger.name, None)
            rosout.close()
        for entity in entities:
            entity.close()
        self._leave_graph()
        self.wake_executor()

    def wake_executor(self) -> None:
        """Wake the node's executor so that it notices a change."""
        if executor := self.executor:
            executor.wake()

    def _checked(self, msg_type: Any, topic: str, qos_profile: Any) -> QoSProfile:
        """Check the arguments for a new endpoint, and return its QoS profile.

        Raises:
            ValueError: the depth is negative.
            TypeError: the profile is neither a QoSProfile nor an int.
            InvalidTopicNameException: the topic's name breaks the naming rules.
            AttributeError: the type is not a message type.
        """
        if isinstance(qos_profile, int):
            if qos_profile < 0:
                raise ValueError("history depth must be greater than or equal to zero")
            qos_profile = QoSProfile(depth=qos_profile)
        if not isinstance(qos_profile, QoSProfile):
            raise TypeError(f"Expected QoSProfile or int, but received {type(qos_profile)!r}")
        try:
            self.resolve_topic_name(topic)
        except RCLError:
            validate_topic_name(topic)
            self._expanded(topic)
            raise
        check_message_type(msg_type)
        return qos_profile

    @contextmanager
    def _creating(self, what: str) -> Iterator[None]:
        """Raise rclpy's error if an entity cannot be created, even if the node or context has just been closed."""
        self._require_context(what)
        try:
            yield
        except TransportError as error:
            self._require_context(what)
            raise RCLError(f"Failed to create {what}: {error}") from error

    def _require_context(self, what: str) -> None:
        self._require_handle()
        if not self._context.ok():
            raise RCLError(f"Failed to create {what}: rcl node's context is invalid")

    def _add(self, entity: Entity) -> Entity:
        with self._lock:
            if self._destroyed and not isinstance(
                entity, Timer
            ):  # rclpy lets a destroyed node create timers, and runs them
                entity.close()
                raise InvalidHandle
            self._entities = (*self._entities, entity)
        self._endpoints_changed()
        return entity

    def _remove(self, entity: Any, keep: bool = False) -> bool:
        """Destroy an entity, or return False if the node has no such entity.

        If ``keep`` is true, the node still lists the entity.
        """
        with self._lock:
            if entity not in self._entities or (keep and entity._destroyed):
                return False
            if not keep:
                self._entities = tuple(other for other in self._entities if other is not entity)
            entity.close()
        self._endpoints_changed()
        return True

    def _endpoints_changed(self) -> None:
        with self._lock:  # so that the last announcement is up to date
            there = [entity for entity in (*self._entities, self._rosout) if entity and not entity._destroyed]
            writers = [entity.guid for entity in there if isinstance(entity, Publisher)]
            readers = [entity.guid for entity in there if isinstance(entity, Subscription)]
            self._graph.set_endpoints(self._entry, writers, readers)
        self.wake_executor()

    def _publish_parameter_event(self, event: ParameterEvent) -> None:
        event.node = self.get_fully_qualified_name()
        event.stamp = self._clock.now().to_msg()
        self._parameter_events.publish(event)

    def _use_sim_time(self, enabled: bool) -> None:
        """Make the clock follow ``/clock``, or switch it back to system time."""
        if enabled == self._clock.ros_time_is_active:
            return
        self._clock._jump(enabled, self._clock._simulated_ns)
        if enabled:
            self._clock_subscription = self.create_subscription(ClockMessage, "/clock", self._on_clock, CLOCK_QOS)
        else:
            self.destroy_subscription(self._clock_subscription)

    def _on_clock(self, message: ClockMessage) -> None:
        self._clock.set_ros_time_override(Time.from_msg(message.clock))

    def publish_log(self, severity: LoggingSeverity, name: str, text: str) -> None:
        """Publish a log line on ``/rosout``, unless a shutdown prevents it. Called by the logger."""
        rosout = self._rosout
        if rosout is None or not self._context.ok():
            return
        with suppress(RCLError, InvalidHandle):
            rosout.publish(Log(stamp=Clock().now().to_msg(), level=int(severity), name=name, msg=text))
