"""rclpy's surface where it takes several steps: warnings, futures, logging, executors, contexts, remapping."""

from __future__ import annotations

import json
import threading
import time
from collections.abc import Callable
from typing import Any

import pytest
import rclpy
from domains import reserved_domain
from rclpy import logging
from rclpy.context import Context
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node
from rclpy.parameter import Parameter
from rclpy.qos import QoSProfile
from rclpy.task import Future
from sensor_msgs.msg import Joy
from std_msgs.msg import String

import tutorial  # noqa: F401


def test_zero_depth_is_warned_of() -> None:
    with pytest.warns(UserWarning, match="A zero depth with KEEP_LAST doesn't make sense"):
        QoSProfile(depth=0)


def test_a_name_alone_is_warned_of(node: Node) -> None:
    with pytest.warns(UserWarning, match="declaring a parameter only providing its name is deprecated"):
        parameter = node.declare_parameter("a")
    assert parameter.type_ == Parameter.Type.NOT_SET
    assert node.get_parameter("a").value is None


def test_future(capsys: pytest.CaptureFixture[str]) -> None:
    calls: list[Future] = []
    future = Future()
    future.add_done_callback(calls.append)
    assert (future.done(), future.cancelled(), future.result(), future.exception()) == (False, False, None, None)
    future.cancel()
    assert (future.done(), future.cancelled(), calls) == (False, True, [future])
    future.set_result(1)
    assert (future.done(), future.cancelled(), future.result(), len(calls)) == (True, False, 1, 1)
    future.cancel()
    assert not future.cancelled()
    future.add_done_callback(calls.append)
    assert len(calls) == 2
    future.set_exception(ValueError("mine"))
    with pytest.raises(ValueError, match="mine"):
        future.result()
    assert str(future.exception()) == "mine"
    lost = Future()
    lost.set_exception(ValueError("lost"))
    del lost
    assert capsys.readouterr().err == "The following exception was never retrieved: lost\n"


def test_a_failing_done_callback_does_not_keep_the_others() -> None:
    calls: list[Future] = []
    future = Future()
    future.add_done_callback(lambda _: 1 / 0)
    future.add_done_callback(calls.append)
    with pytest.warns(UserWarning, match="Unhandled exception in done callback: division by zero"):
        future.set_result(None)
    assert calls == [future]


def lines_of(capfd: pytest.CaptureFixture[str]) -> list[str]:
    """Return the texts that have been logged."""
    return [line.partition("]: ")[2] for line in capfd.readouterr().err.splitlines()]


def test_log_filters(capfd: pytest.CaptureFixture[str]) -> None:
    logger = logging.get_logger("filters")
    returned = []
    for number in range(3):
        returned.append(logger.info(f"once {number}", once=True))
        returned.append(logger.info(f"skip {number}", skip_first=True))
        returned.append(logger.info(f"throttle {number}", throttle_duration_sec=1000.0))
        returned.append(logger.debug("below"))
    assert lines_of(capfd) == ["once 0", "throttle 0", "skip 1", "skip 2"]
    assert returned == [True, False, True, False, False, True, False, False, False, True, False, False]


def test_a_line_may_not_change_how_it_logs(capfd: pytest.CaptureFixture[str]) -> None:
    logger = logging.get_logger("changes")

    def log(severity: int, **options: Any) -> bool:
        return logger.log("x", severity, **options)

    log(20)
    with pytest.raises(ValueError, match="Logger severity cannot be changed"):
        log(30)
    with pytest.raises(ValueError, match="Logger name cannot be changed"):
        log(20, name="other")
    with pytest.raises(ValueError, match="Requested logging filters cannot be changed"):
        log(20, once=True)


def test_log_levels_are_inherited(capfd: pytest.CaptureFixture[str]) -> None:
    parent, child = logging.get_logger("levels"), logging.get_logger("levels").get_child("child")
    parent.set_level(logging.LoggingSeverity.ERROR)
    assert child.get_effective_level() == logging.LoggingSeverity.ERROR
    child.set_level(10)
    assert child.debug("shown")
    assert not parent.warn("not shown")
    child.set_level(logging.LoggingSeverity.UNSET)
    assert not child.is_enabled_for(logging.LoggingSeverity.WARN)
    assert lines_of(capfd) == ["shown"]


def test_executor_and_its_nodes(context: Context, node: Node) -> None:
    executor, other = SingleThreadedExecutor(context=context), SingleThreadedExecutor(context=context)
    assert (executor.add_node(node), executor.add_node(node)) == (True, False)
    assert executor.get_nodes() == [node]
    assert other.add_node(node)
    assert (executor.get_nodes(), node.executor) == ([], other)
    executor.remove_node(node)
    node.executor = executor
    assert (other.get_nodes(), executor.get_nodes()) == ([], [node])
    assert (executor.shutdown(), executor.shutdown(timeout_sec=0)) == (True, True)
    assert executor.get_nodes() == []
    executor.spin_once()
    executor.spin()
    other.shutdown()


def test_spin_once_waits_as_long_as_it_is_told(executor: SingleThreadedExecutor, node: Node) -> None:
    calls: list[int] = []
    began = time.monotonic()
    executor.spin_once(timeout_sec=0)
    assert time.monotonic() - began < 10
    seldom = node.create_timer(1000.0, lambda: calls.append(0))
    executor.spin_once(timeout_sec=0)
    executor.spin_once(timeout_sec=0.05)
    assert calls == []
    node.destroy_timer(seldom)
    node.create_timer(0.2, lambda: calls.append(1))
    executor.spin_once()
    executor.spin_once(timeout_sec=-1)
    assert calls == [1, 1]


@pytest.mark.filterwarnings("ignore:Exception ignored in:pytest.PytestUnraisableExceptionWarning")
# in rclpy an executor that could not be made says so once more when it is deleted
def test_spin_once_after_shutdown(context: Context, executor: SingleThreadedExecutor) -> None:
    context.shutdown()
    executor.spin()
    with pytest.raises(RuntimeError, match="failed to initialize wait set: the given context is not valid"):
        executor.spin_once(timeout_sec=0)
    with pytest.raises(RuntimeError, match="the given context is not valid"):
        SingleThreadedExecutor(context=context)


def test_executor_shutdown_does_not_wait_for_a_callback(context: Context, node: Node) -> None:
    executor = SingleThreadedExecutor(context=context)
    executor.add_node(node)
    running, may_end = threading.Event(), threading.Event()
    node.create_timer(0.0, lambda: (running.set(), may_end.wait(60)))
    thread = threading.Thread(target=executor.spin)
    thread.start()
    assert running.wait(30)
    assert executor.shutdown(timeout_sec=0.01)
    assert thread.is_alive()
    may_end.set()
    thread.join(30)
    assert not thread.is_alive()


@pytest.mark.embedded  # rclpy 7.1.3 waits on, for a result that nobody will give
def test_cancelled_future_ends_the_spin(executor: SingleThreadedExecutor) -> None:
    future = Future()
    threading.Timer(0.1, future.cancel).start()
    began = time.monotonic()
    executor.spin_until_future_complete(future, timeout_sec=60)
    assert time.monotonic() - began < 50
    assert not future.done()


def test_context_starts_once(domain: int) -> None:
    context = Context()
    with context:
        with pytest.raises(RuntimeError, match=r"Context.init\(\) must only be called once"):
            context.init(args=[])
        assert context.get_domain_id() == domain
    assert not context.ok()
    with pytest.raises(RuntimeError, match=r"Context.init\(\) must only be called once"):
        context.init(args=[])
    with pytest.raises(RuntimeError, match="rcl_shutdown already called on the given context"):
        context.shutdown()


class Caller:
    """Has a method to be called back."""

    def __init__(self, calls: list[str], name: str) -> None:
        self.calls, self.name = calls, name

    def call(self) -> None:
        self.calls.append(self.name)


def test_a_context_calls_back_at_its_shutdown(domain: int) -> None:
    calls: list[str] = []
    context, kept = Context(), Caller(calls, "a method")
    with pytest.raises(TypeError, match="callback should be a callable"):
        context.on_shutdown(3)  # type: ignore[arg-type]
    context.on_shutdown(kept.call)
    context.try_shutdown()
    context.init(args=[])
    context.on_shutdown(lambda: calls.append("a function"))
    context.on_shutdown(Caller(calls, "a method of what is gone").call)
    assert calls == []
    context.shutdown()
    assert calls == ["a method", "a function"]
    context.try_shutdown()
    context.on_shutdown(kept.call)
    assert calls == ["a method", "a function", "a method"]


def test_a_failing_callback_is_an_error_of_the_shutdown(domain: int) -> None:
    context = Context()
    context.init(args=[])
    context.on_shutdown(lambda: 1 / 0)
    with pytest.raises(ZeroDivisionError):
        context.shutdown()
    assert not context.ok()


def test_a_timer_of_another_period_keeps_its_next_call(node: Node) -> None:
    timer = node.create_timer(1000.0, print)
    timer.timer_period_ns = 10**9
    assert timer.timer_period_ns == 10**9
    assert timer.time_until_next_call() > 990 * 10**9
    timer.reset()
    assert 0 < timer.time_until_next_call() <= 10**9


def test_default_context_starts_again(domain: int) -> None:
    for _ in range(2):
        rclpy.init(args=[])
        with pytest.raises(RuntimeError, match=r"Context.init\(\) must only be called once"):
            rclpy.init(args=[])
        assert rclpy.get_default_context().get_domain_id() == domain
        rclpy.shutdown()
    with pytest.raises(RuntimeError, match="Context must be initialized before it can be shutdown"):
        rclpy.shutdown()


def test_remapping_and_parameters_of_one_node(domain: int) -> None:
    rules = {"-r": ["one:__node:=first", "two:x:=y", "two/x:=/z"], "-p": ["one:a:=1", "b:=2"]}
    given = [word for flag, those in rules.items() for rule in those for word in (flag, rule)]
    with reserved_domain() as other:
        context = Context()
        context.init(args=["--ros-args", *given, "--", "not", "ros"], domain_id=other)
        one, two = Node("one", context=context), Node("two", context=context)
        own = Node("own", context=context, cli_args=["--ros-args", "-r", "__ns:=/o", "-r", "x:=w"])
        deaf = Node("one", context=context, use_global_arguments=False)
        assert [node.get_name() for node in (one, two, own, deaf)] == ["first", "two", "own", "one"]
        resolved = [node.resolve_topic_name("x") for node in (one, two, own, deaf)]
        assert resolved == ["/x", "/y", "/o/w", "/x"]
        assert two.resolve_topic_name("two/x") == "/z"
        assert two.resolve_topic_name("x", only_expand=True) == "/x"
        assert [node.declare_parameter("b", 0).value for node in (one, two, deaf)] == [2, 2, 0]
        assert two.declare_parameter("a", 0).value == 0
        context.shutdown()


def test_another_type_on_a_topic_is_said_once_and_others_go_on(
    node: Node,
    executor: SingleThreadedExecutor,
    spin_until: Callable[[Callable[[], object]], None],
    capfd: pytest.CaptureFixture[str],
    backend: str,
) -> None:
    received: list[str] = []
    joy = node.create_publisher(Joy, "x", 10)
    if rclpy.get_rmw_implementation_identifier() == "rmw_fastrtps_cpp":  # where a process gives a topic one type only
        with pytest.raises(RuntimeError, match="Failed to create subscription"):
            node.create_subscription(String, "x", print, 10)
        return
    node.create_subscription(String, "x", lambda message: received.append(message.data), 10)
    text = node.create_publisher(String, "x", 10)
    for _ in range(5):
        joy.publish(Joy())
    text.publish(String(data="text"))
    spin_until(lambda: received)
    for _ in range(5):
        executor.spin_once(timeout_sec=0.02)
    assert received == ["text"]
    said = [line for line in lines_of(capfd) if "Incompatible type on topic 'x'" in line]
    assert len(said) == 2 or backend == "rclpy"  # on either side once
    assert json.dumps(said).count("no messages will be sent to it") == len(said)
