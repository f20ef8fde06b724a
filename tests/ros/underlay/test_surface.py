"""rclpy's surface beyond what was recorded from a real one: signatures, and what the embedded one has not."""

from __future__ import annotations

import inspect

import pytest
import rclpy
from rclpy.context import Context
from rclpy.duration import Duration
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node
from rclpy.parameter import Parameter
from rclpy.publisher import Publisher
from rclpy.task import Future
from rclpy.time import Time
from std_msgs.msg import String

import tutorial  # noqa: F401

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
def test_signature(function):
    parameters = inspect.signature(function).parameters.values()
    written = [
        p.name if p.default is p.empty else f"{p.name}={p.default}" for p in parameters if p.name != "clock_type"
    ]
    assert ", ".join(written) == SIGNATURES[function]


@pytest.mark.embedded
@pytest.mark.parametrize(
    "code",
    [
        "from rclpy.executors import MultiThreadedExecutor",
        "node.create_service(None, 'x', print)",
        "node.create_timer(1, print, callback_group=object())",
        "node.create_publisher(None, 'x', 1, event_callbacks=object())",
        "rclpy.create_node('x', context=node.context, allow_undeclared_parameters=True)",
        "Context().init(args=['--ros-args', '--params-file', 'x'])",
    ],
)
def test_what_is_not_there_says_what_to_do(code, node):
    with pytest.raises((ImportError, AttributeError), match="A real ROS 2 Jazzy has: see https"):
        exec(code, globals() | {"node": node})
    assert not hasattr(node, "create_service")


@pytest.mark.embedded
def test_what_is_said_of_a_publisher_does_not_depend_on_its_class(node, capfd):
    own = type("Own", (Publisher,), {})
    node.create_publisher(String, "x", 1, publisher_class=own).destroy()
    assert "publisher.destroy() does not tell the node" in capfd.readouterr().err
