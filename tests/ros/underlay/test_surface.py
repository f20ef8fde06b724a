"""rclpy's surface, method by method: what it returns and what it raises, beyond what was recorded from a real one."""

from __future__ import annotations

import inspect
import re
from collections.abc import Callable, Iterator
from typing import Any

import pytest
import rclpy
from rclpy import logging, qos
from rclpy.clock import Clock, ROSClock
from rclpy.clock_type import ClockType
from rclpy.context import Context
from rclpy.duration import Duration, Infinite
from rclpy.executors import SingleThreadedExecutor
from rclpy.expand_topic_name import expand_topic_name
from rclpy.node import Node
from rclpy.parameter import Parameter
from rclpy.publisher import Publisher
from rclpy.qos import (
    DurabilityPolicy,
    HistoryPolicy,
    LivelinessPolicy,
    QoSPresetProfiles,
    QoSProfile,
)
from rclpy.task import Future
from rclpy.time import Time
from rclpy.validate_full_topic_name import validate_full_topic_name
from rclpy.validate_namespace import validate_namespace
from rclpy.validate_node_name import validate_node_name
from rclpy.validate_topic_name import validate_topic_name
from sensor_msgs.msg import Joy
from std_msgs.msg import String

import tutorial  # noqa: F401

CLASSES = (
    *(Clock, ClockType, ROSClock, Context, Duration, Joy, Node, Parameter, QoSPresetProfiles, QoSProfile, String, Time),
    *(DurabilityPolicy, HistoryPolicy, LivelinessPolicy, expand_topic_name),
    *(validate_full_topic_name, validate_namespace, validate_node_name, validate_topic_name),
)
IN_RCL = re.compile(r"(, at \S+\.c:\d+)+$")
NAMES: dict[str, Any] = {"Infinite": Infinite, "qos": qos, "logging": logging, "rclpy": rclpy}
NAMES.update((thing.__name__, thing) for thing in CLASSES)


def outcome(code: str, names: dict[str, Any]) -> str:
    """Return what an expression is, as a text, or what it raises: its type and the first line of its text.

    Where rcl says in which of its own lines it was raised, this is left out.
    """
    try:
        return str(eval(code, names))
    except Exception as error:  # noqa: BLE001
        text = str(error).splitlines()[0] if str(error) else ""
        return f"{type(error).__name__}: {IN_RCL.sub('', text)}"


PLAIN = {
    # Time and Duration
    "Time(seconds=1) + Duration(seconds=2)": "Time(nanoseconds=3000000000, clock_type=SYSTEM_TIME)",
    "Duration(seconds=2) + Time(seconds=1)": "Time(nanoseconds=3000000000, clock_type=SYSTEM_TIME)",
    "Time(seconds=3) - Time(seconds=1)": "2000000000 nanoseconds",
    "Time(seconds=1) - Time(seconds=3)": "-2000000000 nanoseconds",
    "Time(seconds=3) - Duration(seconds=1)": "Time(nanoseconds=2000000000, clock_type=SYSTEM_TIME)",
    "Time(seconds=1) - Duration(seconds=3)": "ValueError: Subtraction leads to negative time.",
    "Time(nanoseconds=2**63 - 1) + Duration(nanoseconds=1)": "OverflowError: Addition leads to overflow in C storage.",
    "Time(nanoseconds=2**63)": "OverflowError: Total nanoseconds value is too large to store in C time point.",
    "Time(nanoseconds=-1)": "ValueError: Nanoseconds value must not be negative",
    "Time(clock_type='x')": "TypeError: Clock type must be a ClockType enum",
    "Time() == Time(clock_type=ClockType.ROS_TIME)": "TypeError: Can't compare times with different clock types",
    "Time() < Time(clock_type=ClockType.STEADY_TIME)": "TypeError: Can't compare times with different clock types",
    "Time() - Time(clock_type=ClockType.ROS_TIME)": "TypeError: Can't subtract times with different clock types",
    "Time() == 0, Time() != None": "(False, True)",
    "Time() < 1": "TypeError: '<' not supported between instances of 'Time' and 'int'",
    "hash(Time())": "TypeError: unhashable type: 'Time'",
    "hash(Duration())": "TypeError: unhashable type: 'Duration'",
    "Time.from_msg(Time(seconds=1).to_msg()).clock_type.name": "ROS_TIME",
    "Time.from_msg(Duration().to_msg())": "TypeError: Must pass a builtin_interfaces.msg.Time object",
    "Duration.from_msg(Time().to_msg())": "TypeError: Must pass a builtin_interfaces.msg.Duration object",
    "Duration(nanoseconds=2**63)": "OverflowError: Total nanoseconds value is too large to store in C duration.",
    "Duration(nanoseconds=-2**63).nanoseconds": "-9223372036854775808",
    "Duration(seconds=-1.5).to_msg()": "builtin_interfaces.msg.Duration(sec=-2, nanosec=500000000)",
    "str(Infinite), repr(Duration(seconds=1))": "('Infinite', 'Duration(nanoseconds=1000000000)')",
    "Duration() == 0, Duration() >= Duration()": "(False, True)",
    "Duration() < 1": "TypeError: '<' not supported between instances of 'Duration' and 'int'",
    "Duration(1)": "TypeError: Duration.__init__() takes 1 positional argument but 2 were given",
    # clocks
    "Clock(), Clock().clock_type.name": "(Clock(clock_type=SYSTEM_TIME), 'SYSTEM_TIME')",
    "type(Clock(clock_type=ClockType.ROS_TIME)).__name__": "ROSClock",
    "ROSClock(), ROSClock().ros_time_is_active": "(Clock(clock_type=ROS_TIME), False)",
    "Clock(clock_type=1)": "TypeError: Clock type must be a ClockType enum",
    "Clock(clock_type=ClockType.STEADY_TIME).now().clock_type.name": "STEADY_TIME",
    "Clock().clock_type, Clock().now().clock_type": "(<ClockType.SYSTEM_TIME: 2>, <ClockType.SYSTEM_TIME: 2>)",
    "str(ROSClock().clock_type), str(ROSClock().now().clock_type)": "('1', 'ClockType.ROS_TIME')",
    "Time().clock_type == ClockType.SYSTEM_TIME, 2 in (Time().clock_type, 0)": "(True, True)",
    "Time(clock_type=Time().clock_type)": "Time(nanoseconds=0, clock_type=SYSTEM_TIME)",
    "ROSClock() and Clock(clock_type=ROSClock().now().clock_type)": "Clock(clock_type=ROS_TIME)",
    # quality of service
    "QoSProfile(depth=1)": "QoSProfile(history=1, depth=1, reliability=1, durability=2, lifespan=0 nanoseconds, "
    "deadline=0 nanoseconds, liveliness=0, liveliness_lease_duration=0 nanoseconds, "
    "avoid_ros_namespace_conventions=False)",
    "QoSProfile(history=HistoryPolicy.KEEP_LAST)": "InvalidQoSProfileException: ('Invalid QoSProfile', "
    "'History set to KEEP_LAST without a depth setting.')",
    "QoSProfile(history=HistoryPolicy.KEEP_ALL).depth": "10",
    "QoSProfile(depth='1')": "AssertionError: ",
    "QoSProfile(depth=1, reliability='best')": "AssertionError: ",
    "QoSProfile(depth=1, deadline=1.0)": "AssertionError: ",
    "QoSProfile(depth=1, reliability=9)": "ValueError: 9 is not a valid ReliabilityPolicy",
    "QoSProfile(depth=1, reliability=2).reliability.name": "BEST_EFFORT",
    "QoSProfile(depth=1, deepness=1)": "AssertionError: Invalid arguments passed to constructor: "
    "dict_keys(['depth', 'deepness'])",
    "setattr(QoSProfile(depth=1), 'nothing', 1)": "AttributeError: 'QoSProfile' object has no attribute 'nothing'",
    "setattr(QoSProfile(depth=1), 'durability', None)": "AssertionError: ",
    "hash(QoSProfile(depth=1))": "TypeError: unhashable type: 'QoSProfile'",
    "QoSProfile(depth=1) == 1, QoSProfile(depth=1) != QoSProfile(depth=1)": "(False, False)",
    "[QoSPresetProfiles[name].value.depth for name in ('DEFAULT', 'SENSOR_DATA', 'SYSTEM_DEFAULT', 'PARAMETERS')]": (
        "[10, 5, 0, 1000]"
    ),
    "QoSPresetProfiles.SENSOR_DATA.value is qos.qos_profile_sensor_data": "True",
    "qos.qos_profile_best_available.reliability.name, qos.qos_profile_unknown.history.name": (
        "('BEST_AVAILABLE', 'UNKNOWN')"
    ),
    "HistoryPolicy.short_keys()": "['system_default', 'keep_last', 'keep_all', 'unknown']",
    "DurabilityPolicy.get_from_short_key('Volatile')": "2",
    "LivelinessPolicy.MANUAL_BY_TOPIC.short_key": "manual_by_topic",
    # parameters
    "Parameter('a', value=1).type_": "Type.INTEGER",
    "[Parameter('a', value=value).type_.name for value in (True, 1.0, 'x', [], [True], [1], [1.0], ['x'], None)]": (
        "['BOOL', 'DOUBLE', 'STRING', 'BYTE_ARRAY', 'BOOL_ARRAY', 'INTEGER_ARRAY', 'DOUBLE_ARRAY', 'STRING_ARRAY', "
        "'NOT_SET']"
    ),
    "Parameter('a', value=object)": "TypeError: The given value is not one of the allowed types '<class 'object'>'.",
    "Parameter('a', value=[1, 'x'])": "TypeError: The given value is not a list of one of the allowed "
    "types '[1, 'x']'.",
    "Parameter('a', Parameter.Type.STRING, 1)": "ValueError: Type 'Type.STRING' and value '1' do not agree",
    "Parameter('a', 2, 1)": "TypeError: type must be an instance of '<enum 'Type'>'",
    "Parameter('a', value=1) == Parameter('a', value=1)": "False",
    # names
    "validate_node_name('1a')": "InvalidNodeNameException: Invalid node name: node name must not start with a number:",
    "validate_node_name('a' * 256)": "InvalidNodeNameException: Invalid node name: node name length should not exceed "
    "'255':",
    "validate_namespace('/'), validate_namespace('/a/b')": "(True, True)",
    "validate_namespace('a')": "InvalidNamespaceException: Invalid namespace: namespace must be absolute, it must lead "
    "with a '/':",
    "validate_namespace('/a/')": "InvalidNamespaceException: Invalid namespace: namespace must not end with a '/', "
    "unless only a '/':",
    "validate_topic_name('~/a'), validate_topic_name('a/{node}')": "(True, True)",
    "validate_topic_name('~a')": "True",  # no name of a topic, but so it is in rcl
    "validate_topic_name('/a/')": "InvalidTopicNameException: Invalid topic name: topic name must not end with a "
    "forward slash:",
    "validate_topic_name('a~')": "InvalidTopicNameException: Invalid topic name: topic name must not have tilde '~' "
    "unless it is the first character:",
    "validate_topic_name('~ab')": "InvalidTopicNameException: Invalid topic name: topic name must not have a tilde '~' "
    "that is not followed by a forward slash '/':",
    "validate_topic_name('a/1')": "InvalidTopicNameException: Invalid topic name: topic name token must not start with "
    "a number:",
    "validate_topic_name('{a')": "InvalidTopicNameException: Invalid topic name: topic name must not have unmatched "
    "(unbalanced) curly braces '{}':",
    "validate_topic_name('a}')": "InvalidTopicNameException: Invalid topic name: topic name must not have unmatched "
    "(unbalanced) curly braces '{}':",
    "validate_topic_name('{a/b}')": "InvalidTopicNameException: Invalid topic name: substitution name must not contain "
    "characters other than alphanumerics or '_':",
    "validate_topic_name('{1a}')": "InvalidTopicNameException: Invalid topic name: substitution name must not start "
    "with a number:",
    "validate_full_topic_name('/a//b')": "InvalidTopicNameException: Invalid topic name: topic name must not contain "
    "repeated '/':",
    "expand_topic_name('~/a', 'n', '/'), expand_topic_name('{ns}/{node}', 'n', '/s')": "('/n/a', '/s/n')",
    "expand_topic_name('a', 'n', '/s'), expand_topic_name('/a', 'n', '/s')": "('/s/a', '/a')",
    "expand_topic_name('a b', 'n', '/')": "ValueError: topic name 'a b' is invalid: topic name must not contain "
    "characters other than alphanumerics, '_', '~', '{', or '}'",
    # logging
    "logging.get_logger('')": "ValueError: Logger name must not be empty.",
    "logging.get_logger('a').get_child('')": "ValueError: Child logger name must not be empty.",
    "logging.get_logger('a') is logging.get_logger('a')": "False",
    "logging.get_logger('a').info('x', often=True)": 'TypeError: parameter "often" is not one of the recognized '
    "logging options \"['throttle_duration_sec', 'throttle_time_source_type', 'skip_first', 'once']\"",
    "logging.get_logger('a').log('x', 7)": "ValueError: 7 is not a valid LoggingSeverity",
    "logging.get_logger('a').is_enabled_for(logging.LoggingSeverity.DEBUG)": "False",
    "logging.get_logger_level('never.set').name": "UNSET",
    "logging.get_logger('never.set').get_effective_level().name": "INFO",
    # contexts
    "Context().get_domain_id()": "RuntimeError: Context must be initialized before it can have a domain id",
    "Context().shutdown()": "RuntimeError: Context must be initialized before it can be shutdown",
    "Context().try_shutdown(), Context().ok()": "(None, False)",
    "Context().init(args=[], domain_id=-1)": "RuntimeError: Domain id (-1) should not be lower than zero.",
}


@pytest.mark.parametrize("code", PLAIN)
def test_without_a_node(code: str) -> None:
    assert outcome(code, dict(NAMES)) == PLAIN[code]


WITH_A_NODE = {
    "node.create_publisher(String, 'x', 'ten')": "TypeError: Expected QoSProfile or int, but received <class 'str'>",
    "node.create_subscription(String, 'x', print, -1)": "ValueError: history depth must be greater than or equal to "
    "zero",
    "node.create_subscription(String, 'x', lambda: None, 1)": "RuntimeError: Subscription.__init__(): callback should "
    "be either be callable with one argument(to get only the message) or two (to get message and message info)",
    "node.create_publisher(String, '{foo}', 1)": "ValueError: topic name '{foo}' is invalid: unknown substitution: "
    "{foo}",
    "node.create_publisher(String, 'x', 1).publish(Joy())": "TypeError: Expected <class "
    "'std_msgs.msg._string.String'>, got <class 'sensor_msgs.msg._joy.Joy'>",
    "node.count_publishers('a b')": "ValueError: topic name 'a b' is invalid: topic name must not contain characters "
    "other than alphanumerics, '_', '~', '{', or '}'",
    "node.resolve_topic_name('joy'), node.resolve_topic_name('~/joy')": "('/Tank/joy', '/Tank/tester/joy')",
    "node.resolve_topic_name('a b')": "RCLError: failed to resolve name: topic name must not contain characters other "
    "than alphanumerics, '_', '~', '{', or '}'",
    "node.resolve_topic_name('{foo}')": "RCLError: failed to resolve name: unknown substitution: {foo}",
    "node.resolve_topic_name('a//b')": "RCLError: failed to resolve name: topic name must not contain repeated '/'",
    "node.create_publisher(String, 'p', 1).topic_name": "/Tank/p",
    "node.create_timer(1, print).timer_period_ns": "1000000000",
    "node.create_timer(1, print, clock=Clock()).clock": "Clock(clock_type=SYSTEM_TIME)",
    "node.create_timer(1, print, autostart=False).time_until_next_call()": "None",
    "node.create_timer(1, print, autostart=False).is_canceled()": "True",
    "node.create_timer(0, print).is_ready()": "True",
    "node.create_timer(1, print).is_ready()": "False",
    "0 < node.create_timer(1, print).time_until_next_call() <= 10**9": "True",
    "0 <= node.create_timer(1, print).time_since_last_call() < 10**9": "True",
    "node.get_clock(), node.get_clock().now().clock_type.name": "(Clock(clock_type=ROS_TIME), 'ROS_TIME')",
    "node.get_logger().name, node.get_logger() is node.get_logger()": "('Tank.tester', True)",
    "node.nothing": "AttributeError: 'Node' object has no attribute 'nothing'",
    # parameters
    "node.declare_parameter('a', 1).value, node.get_parameter('a').value": "(1, 1)",
    "node.declare_parameter('')": "InvalidParameterException: Invalid parameter name: ",
    "node.declare_parameter('use_sim_time', True)": "ParameterAlreadyDeclaredException: Parameter(s) already declared: "
    "['use_sim_time']",
    "node.declare_parameter('a', Parameter.Type.INTEGER).value, node.has_parameter('a')": "(None, True)",
    "node.declare_parameter('a', Parameter.Type.INTEGER) and node.get_parameter('a')": "ParameterUninitializedException"
    ": The parameter 'a' is not initialized: a",
    "node.declare_parameter('a', Parameter.Type.INTEGER) and node.get_parameter_or('a').type_.name": "NOT_SET",
    "node.declare_parameter('a', Parameter.Type.NOT_SET)": "ValueError: Cannot declare parameter {a} as statically "
    "typed of type NOT_SET",
    "node.declare_parameter('a', 1, 'descriptor')": "TypeError: Third element descriptor at index 0 in parameters list "
    "is not a ParameterDescriptor.",
    "node.declare_parameter('a', {})": "TypeError: The given value is not one of the allowed types '{}'.",
    "node.declare_parameter('a', 1) and node.set_parameters([Parameter('a', value='x')])[0].reason": "Wrong parameter "
    "type, expected 'Type.INTEGER' got 'Type.STRING'",
    "node.declare_parameter('a', 1) and node.set_parameters([Parameter('a')])[0].reason": "Static parameter cannot be "
    "undeclared",
    "node.declare_parameter('a', 1, read_only) and node.set_parameters([Parameter('a', value=2)])[0].reason": "Trying "
    "to set a read-only parameter: a.",
    "node.declare_parameter('a', 1, dynamic) and node.set_parameters([Parameter('a', value='x')])[0].successful": (
        "True"
    ),
    "node.declare_parameter('a', 1, dynamic) and node.set_parameters([Parameter('a')]) and node.has_parameter('a')": (
        "False"
    ),
    "node.declare_parameter('a', 20, to_ten)": "InvalidParameterValueException: Invalid parameter value (20) for "
    "parameter. Reason: Parameter a out of range. Min: 0, Max: 10, value: 20: a",
    "node.declare_parameter('a', 3, to_ten)": "InvalidParameterValueException: Invalid parameter value (3) for "
    "parameter. Reason: The parameter value for a is not a valid step. Min: 0, max: 10, value: 3, step: 2: a",
    "[node.declare_parameter(f'a{value}', value, to_ten).value for value in (0, 4, 10)]": "[0, 4, 10]",
    "node.set_parameters(['a'])": "TypeError: parameter must be instance of type '<class 'rclpy.parameter.Parameter'>'",
    "[node.declare_parameter(f'given{n}', default).value for n, default in enumerate((0, 0.0, '', False, [0], ''))]": (
        "[7, 1000.0, 'yes', True, [1, 2], 'seven: 7']"
    ),
    "node.declare_parameter('given0', 1, ignore_override=True).value": "1",
    "node.declare_parameter('given0', 'x')": "InvalidParameterTypeException: Trying to set parameter 'given0' to '7' "
    "of type 'INTEGER', expecting type 'STRING': given0",
}

GIVEN = ["given0:=7", "given1:=1e3", "given2:='yes'", "given3:=y", "given4:=[1, 2]"]


@pytest.fixture
def names(domain: int) -> Iterator[dict[str, Any]]:
    """What the expressions use: a node, and descriptors of parameters."""
    from rcl_interfaces.msg import IntegerRange, ParameterDescriptor

    context = Context()
    context.init(args=["--ros-args", *(word for given in GIVEN for word in ("-p", given))])
    node = Node(
        "tester",
        namespace="/Tank",
        context=context,
        parameter_overrides=[Parameter("given5", value="seven: 7")],
    )
    yield NAMES | {
        "node": node,
        "read_only": ParameterDescriptor(read_only=True),
        "dynamic": ParameterDescriptor(dynamic_typing=True),
        "to_ten": ParameterDescriptor(integer_range=[IntegerRange(from_value=0, to_value=10, step=2)]),
    }
    context.try_shutdown()


@pytest.mark.parametrize("code", WITH_A_NODE)
def test_of_a_node(code: str, names: dict[str, Any]) -> None:
    assert outcome(code, names) == WITH_A_NODE[code]


GONE = "InvalidHandle: cannot use Destroyable because destruction was requested"
AFTER_DESTRUCTION = {
    "node.get_name()": GONE,
    "node.get_namespace()": GONE,
    "node.get_fully_qualified_name()": GONE,
    "node.resolve_topic_name('x')": GONE,
    "node.get_node_names()": GONE,
    "node.get_topic_names_and_types()": GONE,
    "node.count_publishers('x')": GONE,
    "node.get_publishers_info_by_topic('x')": GONE,
    "node.create_publisher(String, 'x', 1)": GONE,
    "node.create_subscription(String, 'x', print, 1)": GONE,
    "publisher.publish('nothing')": GONE,
    "publisher.get_subscription_count()": GONE,
    "publisher.topic_name": GONE,
    "subscription.topic_name": GONE,
    "subscription.get_publisher_count()": GONE,
    "timer.cancel()": GONE,
    "timer.reset()": GONE,
    "timer.is_ready()": GONE,
    "timer.is_canceled()": GONE,
    "timer.time_until_next_call()": GONE,
    "timer.time_since_last_call()": GONE,
    "node.get_logger().name, node.get_clock()": "('Tank.tester', Clock(clock_type=ROS_TIME))",
    "node.has_parameter('use_sim_time'), list(node.publishers), list(node.timers)": "(True, [], [])",
    "node.destroy_publisher(publisher), node.destroy_timer(timer), node.destroy_node()": "(False, False, None)",
    "publisher.destroy(), subscription.destroy(), timer.destroy()": "(None, None, None)",
}


@pytest.mark.parametrize("code", AFTER_DESTRUCTION)
def test_after_destruction(code: str, names: dict[str, Any]) -> None:
    node = names["node"]
    names["publisher"] = node.create_publisher(String, "x", 1)
    names["subscription"] = node.create_subscription(String, "x", print, 1)
    names["timer"] = node.create_timer(1.0, print)
    node.destroy_node()
    assert outcome(code, names) == AFTER_DESTRUCTION[code]


SIGNATURES = {
    rclpy.init: "args=None, context=None, domain_id=None, signal_handler_options=None",
    rclpy.spin: "node, executor=None",
    rclpy.spin_once: "node, executor=None, timeout_sec=None",
    rclpy.spin_until_future_complete: "node, future, executor=None, timeout_sec=None",
    rclpy.shutdown: "context=None, uninstall_handlers=None",
    Context.init: "self, args=None, initialize_logging=True, domain_id=None",
    Node.create_timer: "self, timer_period_sec, callback, callback_group=None, clock=None, autostart=True",
    Node.declare_parameter: "self, name, value=None, descriptor=None, ignore_override=False",
    Node.get_parameter_or: "self, name, alternative_value=None",
    Node.resolve_topic_name: "self, topic, only_expand=False",
    Node.get_topic_names_and_types: "self, no_demangle=False",
    Node.get_publishers_info_by_topic: "self, topic_name, no_mangle=False",
    SingleThreadedExecutor.spin_once: "self, timeout_sec=None",
    SingleThreadedExecutor.shutdown: "self, timeout_sec=None",
    Time.__init__: "self, seconds=0, nanoseconds=0",
    Time.from_msg: "msg",
    Duration.__init__: "self, seconds=0, nanoseconds=0",
    Parameter.__init__: "self, name, type_=None, value=None",
    Future.add_done_callback: "self, callback",
}


@pytest.mark.parametrize("function", SIGNATURES, ids=lambda function: function.__qualname__)
def test_signature(function: Callable[..., Any]) -> None:
    parameters = inspect.signature(function).parameters.values()
    written = [
        p.name if p.default is p.empty else f"{p.name}={p.default}" for p in parameters if p.name != "clock_type"
    ]
    assert ", ".join(written) == SIGNATURES[function]


@pytest.mark.embedded
@pytest.mark.parametrize(
    "code",
    [
        "from rclpy.action import ActionClient",
        "import rclpy.lifecycle",
        "from rclpy.callback_groups import ReentrantCallbackGroup",
        "from rclpy.parameter_client import AsyncParameterClient",
        "from rclpy.executors import MultiThreadedExecutor",
        "from rclpy.timer import Rate",
        "from rclpy.task import Task",
        "node.create_service(None, 'x', print)",
        "node.create_client(None, 'x')",
        "node.create_rate(1)",
        "node.list_parameters([], 0)",
        "node.create_timer(1, print, callback_group=object())",
        "node.create_publisher(None, 'x', 1, event_callbacks=object())",
        "rclpy.create_node('x', allow_undeclared_parameters=True)",
        "node.get_clock().create_jump_callback(None)",
        "import rclpy.time_source",
        "node.get_clock().sleep_for(Duration())",
        "executor.create_task(print)",
        "Context().init(args=['--ros-args', '--params-file', 'x'])",
    ],
)
def test_what_is_not_there_says_what_to_do(code: str, names: dict[str, Any]) -> None:
    executor = SingleThreadedExecutor(context=names["node"].context)
    with pytest.raises((ImportError, AttributeError), match="A real ROS 2 Jazzy has: see https"):
        exec(code.replace("create_node('x'", "create_node('x', context=node.context"), names | {"executor": executor})
    executor.shutdown()
    assert not hasattr(names["node"], "create_service")


def test_unknown_options_are_type_errors(names: dict[str, Any]) -> None:
    for code in ("node.create_publisher(String, 'x', 1, nothing=1)", "Node('x', context=node.context, nothing=1)"):
        with pytest.raises(TypeError, match="unexpected keyword argument 'nothing'"):
            eval(code, names)


class Counting(Publisher):
    """A program's own publisher, as a real rclpy takes it, too."""

    def __init__(self, *args: Any, **kwargs: Any) -> None:
        self.count = 0
        super().__init__(*args, **kwargs)

    def publish(self, msg: Any) -> None:
        super().publish(msg)
        self.count += 1


def test_a_publisher_may_be_of_a_class_of_the_programs_own(names: dict[str, Any]) -> None:
    node = names["node"]
    publisher = node.create_publisher(String, "x", 1, publisher_class=Counting)
    publisher.publish(String())
    assert type(publisher) is Counting
    assert publisher.count == 1
    assert publisher in node.publishers
    assert node.destroy_publisher(publisher)
    with pytest.raises(TypeError, match="unexpected keyword argument 'publisher_class'"):
        node.create_subscription(String, "x", print, 1, publisher_class=Counting)


@pytest.mark.embedded
def test_what_is_said_of_a_publisher_does_not_depend_on_its_class(
    names: dict[str, Any], capfd: pytest.CaptureFixture[str]
) -> None:
    names["node"].create_publisher(String, "x", 1, publisher_class=Counting).destroy()
    assert "publisher.destroy() does not tell the node" in capfd.readouterr().err
