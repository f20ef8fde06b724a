"""Publishers, subscriptions, timers and executors within one process."""

import threading
import time
from collections.abc import Callable
from itertools import pairwise
from typing import Any

import psutil
import pytest
from rclpy._rclpy_pybind11 import InvalidHandle
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node
from rclpy.subscription import Subscription
from rclpy.task import Future
from std_msgs.msg import String


def test_message_info(node, spin_until):
    received: list[dict[str, int]] = []
    node.create_subscription(String, "x", lambda _, info: received.append(info), 10)
    before = time.time_ns()
    node.create_publisher(String, "x", 10).publish(String())
    spin_until(lambda: received)
    assert before <= received[0]["source_timestamp"] <= received[0]["received_timestamp"] <= time.time_ns()
    assert received[0]["publication_sequence_number"] in (None, 1), "only Fast DDS counts"
    assert received[0]["reception_sequence_number"] is None


def test_busy_topic_does_not_starve_a_quiet_one(node, executor):
    order: list[str] = []
    node.create_subscription(String, "busy", lambda _: order.append("busy"), 100)
    node.create_subscription(String, "quiet", lambda _: order.append("quiet"), 100)
    busy, quiet = node.create_publisher(String, "busy", 100), node.create_publisher(String, "quiet", 100)
    for _ in range(100):
        busy.publish(String())
    quiet.publish(String())  # on Fast DDS it may arrive while the first messages are handled
    while "quiet" not in order:
        executor.spin_once(timeout_sec=10.0)
    assert len(order) < 50


@pytest.mark.pocket
def test_topics_without_messages_cost_nothing(node, spin_until, monkeypatch):
    """A node with a hundred subscriptions pays only for those that have a message."""
    received: list[Any] = []
    for i in range(20):
        node.create_subscription(String, f"x{i}", received.append, 10)
    publisher = node.create_publisher(String, "x7", 10)
    looked_at = set()
    execute = Subscription.execute
    monkeypatch.setattr(Subscription, "execute", lambda self: (looked_at.add(self.topic), execute(self))[1])
    for count in range(1, 6):
        publisher.publish(String())
        spin_until(lambda count=count: len(received) == count)
    assert looked_at == {"x7"}


@pytest.mark.pocket
def test_a_malformed_message_is_reported_once_and_later_ones_arrive(node, spin_until, capfd):
    received: list[str] = []
    node.create_subscription(String, "x", lambda message: received.append(message.data), 10)
    publisher = node.create_publisher(String, "x", 10)
    not_utf8 = bytes.fromhex("0001000003000000fffe0000")
    for payload in (not_utf8, not_utf8, String(data="good")):
        publisher.publish(payload)
    spin_until(lambda: received)
    assert received == ["good"]
    assert capfd.readouterr().err.count("A message on topic 'x' was dropped") == 1


CREATE: dict[str, Callable[[Node], Any]] = {
    "subscription": lambda node: node.create_subscription(String, "x", print, 10),
    "publisher": lambda node: node.create_publisher(String, "x", 10),
    "timer": lambda node: node.create_timer(0.001, print),
}
each_kind = pytest.mark.parametrize("kind", CREATE)


def of(node: Node, kind: str) -> list[Any]:
    return [entity for entity in getattr(node, f"{kind}s") if getattr(entity, "topic", "x") == "x"]


@each_kind
def test_an_entity_that_destroys_itself_stays_in_its_nodes_list(node, kind):
    made = CREATE[kind](node)
    destroy = getattr(node, f"destroy_{kind}")
    for _ in range(2):
        made.destroy()
        assert len(of(node, kind)) == 1
        assert made in list(getattr(node, f"{kind}s"))
    deadline = time.monotonic() + 30
    while (node.count_publishers("x"), node.count_subscribers("x")) != (0, 0):  # rclpy's graph lags behind
        assert time.monotonic() < deadline
    assert [destroy(made), destroy(made), made.destroy()] == [True, False, None]
    assert of(node, kind) == []
    CREATE[kind](node).destroy()
    node.destroy_node()
    assert of(node, kind) == []


@pytest.mark.parametrize("kind", ["subscription", "publisher"])
def test_spinning_after_destroy_raises_or_logs_once(node, kind, executor, backend, capfd):
    made, other = CREATE[kind](node), CREATE[kind](node)
    executor.spin_once(timeout_sec=0)
    made.destroy()
    made.destroy()
    other.destroy()
    for _ in range(2):
        if backend == "rclpy":
            with pytest.raises(InvalidHandle):
                executor.spin_once(timeout_sec=0.01)
        else:
            executor.spin_once(timeout_sec=0.01)
    said = capfd.readouterr().err
    assert said.count(f"Call node.destroy_{kind}({kind}) instead") == (backend != "rclpy")
    assert all(getattr(node, f"destroy_{kind}")(each) for each in (made, other))
    executor.spin_once(timeout_sec=0.01)


def test_destroying_after_shutdown_logs_nothing(context, node, capfd):
    made = {kind: create(node) for kind, create in CREATE.items()}
    context.shutdown()
    for kind, entity in made.items():
        entity.destroy()
        assert of(node, kind) == [entity]
    assert capfd.readouterr().err == ""


@pytest.mark.pocket
def test_creating_and_destroying_leaks_no_memory(node):
    memory = [psutil.Process().memory_info().rss]
    for _ in range(5):
        for _ in range(200):
            node.destroy_subscription(node.create_subscription(String, "x", print, 10))
            node.destroy_publisher(node.create_publisher(String, "x", 10))
        memory.append(psutil.Process().memory_info().rss)
    assert min(after - before for before, after in pairwise(memory)) < 200 * 1500  # it once leaked 3,800 bytes a time


@pytest.mark.pocket
def test_waiting_repeatedly_for_a_future_keeps_nothing(node, executor):
    future, called = Future(), []
    future.add_done_callback(called.append)
    node.create_timer(0.001, lambda: 1 / 0)
    for _ in range(20):
        with pytest.raises(ZeroDivisionError):
            executor.spin_until_future_complete(future, timeout_sec=30)
    assert len(future._callbacks) == 1
    future.set_result(None)
    assert called == [future]


@pytest.mark.pocket  # rclpy 7.1.3 lets a callback spin; later versions refuse it
def test_a_callback_may_not_spin(node, executor, spin_until):
    errors: list[str] = []

    def spin_again():
        try:
            executor.spin_once(timeout_sec=0)
        except RuntimeError as error:
            errors.append(str(error))

    node.create_timer(0.01, spin_again)
    spin_until(lambda: errors)
    assert errors[0] == "Executor is already spinning"


@pytest.mark.pocket  # in rclpy the DDS side of a subscription outlives its context; here the whole process leaves DDS
def test_a_subscription_cannot_count_after_shutdown(context, node):
    subscription = node.create_subscription(String, "x", print, 10)
    context.shutdown()
    with pytest.raises(RuntimeError, match="publisher count: subscription's context is invalid"):
        subscription.get_publisher_count()


@pytest.mark.pocket
def test_deleted_executors_are_forgotten(context):
    for _ in range(20):
        SingleThreadedExecutor(context=context).shutdown()
    assert len(context._executors) <= 2


def test_logging_during_shutdown_raises_nothing(context, node):
    logger = node.get_logger()
    ok = context.ok
    context.ok = lambda: ok() or context.__dict__.pop("ok")  # type: ignore[method-assign, func-returns-value]
    context.try_shutdown()
    logger.info("it is shut down between the question whether it runs and the line")


def test_endpoints_created_on_several_threads_are_announced(node, spin_until):
    def make(number):
        for i in range(5):
            node.create_publisher(String, f"topic_{number}_{i}", 1)

    threads = [threading.Thread(target=make, args=(number,)) for number in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    topics = [f"/Tank/topic_{number}_{i}" for number in range(4) for i in range(5)]

    def owners():
        return [info.node_name for topic in topics for info in node.get_publishers_info_by_topic(topic)]

    spin_until(lambda: owners() == 20 * ["tester"])  # in rclpy a node takes a moment to see itself
