"""Nodes."""

from __future__ import annotations

import threading
import weakref
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any, Self

from _rosidl.message import Message
from cyclonedds.core import DDSException
from rcl_interfaces.msg import Log, ParameterEvent
from rclpy._arguments import Arguments
from rclpy._node_graph import NodeGraph
from rclpy._node_parameters import NodeParameters
from rclpy._rclpy_pybind11 import InvalidHandle, RCLError
from rclpy._validation import validate_namespace, validate_node_name
from rclpy._wire import check_message_type
from rclpy.clock import Clock, ROSClock
from rclpy.duration import S_TO_NS
from rclpy.exceptions import NeedsRealROSError, NotInitializedException
from rclpy.expand_topic_name import expand_topic_name
from rclpy.logging import LoggingSeverity, RcutilsLogger, get_logger, set_listener
from rclpy.publisher import Publisher
from rclpy.qos import QoSProfile, profile_of, qos_profile_parameter_events, qos_profile_rosout_default
from rclpy.subscription import Subscription
from rclpy.timer import Timer
from rclpy.utilities import get_default_context

if TYPE_CHECKING:
    from rclpy.context import Context
    from rclpy.executors import SingleThreadedExecutor

__all__ = ["Node"]

NEEDS_REAL_ROS = ("create_service", "create_client", "create_guard_condition", "create_rate", "add_waitable")


class Node(NodeGraph, NodeParameters):
    """A member of the node graph: has a name, publishes, subscribes, keeps time. May be used from any thread.

    Args:
        node_name: its name; a remapping on the command line wins.
        context: None takes the default one.
        cli_args: ROS arguments for this node alone.
        namespace: put before its name and its topics' names.
        use_global_arguments: heed the process's command line.
        enable_rosout: publish what it logs on ``/rosout``.

    Raises:
        NotInitializedException: ``rclpy.init()`` has not been called.
        NameValidationException: the name or the namespace breaks the rules.
    """

    def __init__(
        self,
        node_name: str,
        *,
        context: Context | None = None,
        cli_args: Sequence[str] | None = None,
        namespace: str | None = None,
        use_global_arguments: bool = True,
        enable_rosout: bool = True,
        **_: Any,
    ) -> None:
        self._context = context or get_default_context()
        if not self._context.ok():
            raise NotInitializedException("cannot create node")
        self._arguments = (
            [Arguments.parse(["--ros-args", *cli_args] if "--ros-args" not in cli_args else cli_args)]
            if cli_args
            else []
        )
        self._arguments += [self._context.arguments] if use_global_arguments else []
        self._name, self._namespace = self._names(node_name, namespace or "/")
        self._init_parameters(self._arguments)
        self._clock = ROSClock()
        self._logger = get_logger(self.get_fully_qualified_name()[1:].replace("/", "."))
        self._executor: weakref.ref[SingleThreadedExecutor] | None = None
        self._entities: tuple[Publisher | Subscription | Timer, ...] = ()
        self._rosout: Publisher | None = None
        self._destroyed = False
        self._lock = threading.RLock()
        self._graph = self._context.graph
        self._entry = self._graph.add_node(self._namespace, self._name)
        if enable_rosout:
            self._rosout = self._make_publisher(Log, "/rosout", qos_profile_rosout_default)
            set_listener(self._logger.name, self._publish_log)
        self.create_publisher(ParameterEvent, "/parameter_events", qos_profile_parameter_events)

    def get_name(self) -> str:
        """Return its name."""
        return self._name

    def get_namespace(self) -> str:
        """Return its namespace, which begins with a slash."""
        return self._namespace

    def get_fully_qualified_name(self) -> str:
        """Return namespace and name."""
        return f"{self._namespace.rstrip('/')}/{self._name}"

    def get_logger(self) -> RcutilsLogger:
        """Return its logger."""
        return self._logger

    def get_clock(self) -> Clock:
        """Return its clock."""
        return self._clock

    @property
    def context(self) -> Context:
        """The context that it belongs to."""
        return self._context

    @property
    def executor(self) -> SingleThreadedExecutor | None:
        """The executor that runs its callbacks."""
        return self._executor() if self._executor else None

    @executor.setter
    def executor(self, new: SingleThreadedExecutor | None) -> None:
        old = self.executor
        if old is new:
            return
        if old is not None:
            old.remove_node(self)
        self._executor = None if new is None else weakref.ref(new)
        if new is not None:
            new.add_node(self)

    @property
    def publishers(self) -> Iterator[Publisher]:
        """Its publishers."""
        return (entity for entity in self._entities if isinstance(entity, Publisher))

    @property
    def subscriptions(self) -> Iterator[Subscription]:
        """Its subscriptions."""
        return (entity for entity in self._entities if isinstance(entity, Subscription))

    @property
    def timers(self) -> Iterator[Timer]:
        """Its timers."""
        return (entity for entity in self._entities if isinstance(entity, Timer))

    def create_publisher(
        self, msg_type: type[Message], topic: str, qos_profile: QoSProfile | int, **_: Any
    ) -> Publisher:
        """Make a publisher.

        Args:
            msg_type: class of the messages.
            topic: where to; relative to the node's namespace unless it begins with a slash.
            qos_profile: how hard to try; an int is the number of messages kept for those who are slow.

        Raises:
            InvalidTopicNameException: the name breaks the rules.
            RCLError: the context has been shut down.
        """
        qos_profile = profile_of(qos_profile)
        publisher = self._make_publisher(msg_type, topic, qos_profile)
        self._add(publisher)
        return publisher

    def create_subscription(
        self,
        msg_type: type[Message],
        topic: str,
        callback: Callable[..., object],
        qos_profile: QoSProfile | int,
        *,
        raw: bool = False,
        **_: Any,
    ) -> Subscription:
        """Make a subscription.

        Args:
            msg_type: class of the messages.
            topic: where from; relative to the node's namespace unless it begins with a slash.
            callback: called with each message, or with the message and a dict about it, on the thread that spins.
            qos_profile: how hard to try; an int is the number of messages that wait for the callback.
            raw: give the callback bytes instead of messages.

        Raises:
            InvalidTopicNameException: the name breaks the rules.
            RCLError: the context has been shut down.
        """
        qos_profile = profile_of(qos_profile)
        check_message_type(msg_type)
        topic_name = self.resolve_topic_name(topic)
        with self._creating("subscription"):
            subscription = Subscription(self, msg_type, topic, topic_name, callback, qos_profile, raw)
        self._add(subscription)
        return subscription

    def create_timer(
        self,
        timer_period_sec: float,
        callback: Callable[[], object],
        callback_group: None = None,  # noqa: ARG002  (rclpy's signature)
        clock: Clock | None = None,
        autostart: bool = True,
    ) -> Timer:
        """Make a timer.

        Args:
            timer_period_sec: time between calls [s].
            callback: called without arguments, on the thread that spins.
            callback_group: not in the underlay.
            clock: which clock; all keep the same pace here.
            autostart: start at once.

        Raises:
            RCLError: the period is negative.
        """
        timer = Timer(self, callback, int(float(timer_period_sec) * S_TO_NS), clock or self._clock, autostart)
        self._add(timer)
        return timer

    def destroy_publisher(self, publisher: Publisher) -> bool:
        """Destroy a publisher of this node; False if it has none such any more."""
        return self._remove(publisher)

    def destroy_subscription(self, subscription: Subscription) -> bool:
        """Destroy a subscription of this node; False if it has none such any more."""
        return self._remove(subscription)

    def destroy_timer(self, timer: Timer) -> bool:
        """Destroy a timer of this node; False if it has none such any more."""
        return self._remove(timer)

    def destroy_node(self) -> None:
        """Destroy the node with all that belongs to it; may be called again."""
        with self._lock:
            if self._destroyed:
                return
            self._destroyed = True
            entities, self._entities = self._entities, ()
            rosout, self._rosout = self._rosout, None
        set_listener(self._logger.name, None)
        self.executor = None
        for entity in (*entities, *([rosout] if rosout else [])):
            entity.close()
        self._graph.remove_node(self._entry)

    def resolve_topic_name(self, topic: str, *, only_expand: bool = False) -> str:
        """Return a topic's full name, remapped unless only to be expanded."""
        name = expand_topic_name(topic, self._name, self._namespace)
        for arguments in () if only_expand else self._arguments:
            if (remapped := arguments.topic(name, self._name, self._namespace)) != name:
                return remapped
        return name

    def wake_executor(self) -> None:
        """Make the executor look around, because something has been added or removed."""
        if executor := self.executor:
            executor.wake()

    def _names(self, name: str, namespace: str) -> tuple[str, str]:
        """Apply remappings to the node's own name and namespace, and check both."""
        given = name
        namespace = namespace if namespace.startswith("/") else f"/{namespace}"
        for arguments in reversed(self._arguments):
            name = arguments.node_value(given, "__node") or name
            namespace = arguments.node_value(given, "__ns") or namespace
        validate_node_name(name)
        validate_namespace(namespace)
        return name, namespace

    def _make_publisher(self, msg_type: type[Message], topic: str, qos_profile: QoSProfile) -> Publisher:
        check_message_type(msg_type)
        topic_name = self.resolve_topic_name(topic)
        with self._creating("publisher"):
            return Publisher(self, msg_type, topic, topic_name, qos_profile)

    @contextmanager
    def _creating(self, what: str) -> Iterator[None]:
        """Say in rclpy's words why something cannot be made, also if the node goes at this very moment."""
        self._require_alive(what)
        try:
            yield
        except DDSException as error:
            self._require_alive(what)
            raise RCLError(f"Failed to create {what}: {error}") from error

    def _require_alive(self, what: str) -> None:
        if self._destroyed:
            raise InvalidHandle
        if not self._context.ok():
            raise RCLError(f"Failed to create {what}: rcl node's context is invalid")

    def _add(self, entity: Publisher | Subscription | Timer) -> None:
        with self._lock:
            if self._destroyed:
                entity.close()
                raise InvalidHandle
            self._entities = (*self._entities, entity)
        self._endpoints_changed()

    def _remove(self, entity: Publisher | Subscription | Timer) -> bool:
        with self._lock:
            if entity not in self._entities:
                return False
            self._entities = tuple(other for other in self._entities if other is not entity)
        entity.close()
        self._endpoints_changed()
        return True

    def _endpoints_changed(self) -> None:
        writers = [publisher.guid for publisher in (*self.publishers, *([self._rosout] if self._rosout else []))]
        self._graph.set_endpoints(self._entry, writers, [subscription.guid for subscription in self.subscriptions])
        self.wake_executor()

    def _publish_log(self, severity: LoggingSeverity, name: str, text: str) -> None:
        rosout = self._rosout
        if rosout is not None and self._context.ok():
            rosout.publish(Log(stamp=self._clock.now().to_msg(), level=int(severity), name=name, msg=text))

    def __getattr__(self, name: str) -> Any:
        if name in NEEDS_REAL_ROS:
            raise NeedsRealROSError(f"Node.{name}()")
        raise AttributeError(f"{type(self).__name__!r} object has no attribute {name!r}")

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.destroy_node()
