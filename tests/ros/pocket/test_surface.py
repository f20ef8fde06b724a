"""Parts of rclpy's API for which there are no recordings."""

import threading
import time

import pytest
import rclpy
from rclpy.executors import SingleThreadedExecutor
from rclpy.publisher import Publisher
from rclpy.task import Future
from sensor_msgs.msg import Joy
from std_msgs.msg import String


@pytest.mark.pocket
@pytest.mark.parametrize(
    "code",
    [
        "node.create_timer(1, print, callback_group=object())",
        "node.create_publisher(None, 'x', 1, event_callbacks=object())",
        "rclpy.create_node('x', context=node.context, enable_logger_service=True)",
        "rclpy.Context().init(args=['--ros-args', '--params-file', 'x'])",
    ],
)
def test_a_missing_argument_is_explained(code, node):
    with pytest.raises(ImportError, match=r"Install a real ROS 2 Jazzy \(see https"):
        exec(code, globals() | {"node": node})


@pytest.mark.pocket
def test_a_publishers_warning_does_not_depend_on_its_class(node, capfd):
    own = type("Own", (Publisher,), {})
    node.create_publisher(String, "x", 1, publisher_class=own).destroy()
    assert "publisher.destroy() does not notify the node" in capfd.readouterr().err


def test_an_unread_exception_is_reported(capsys):
    lost = Future()
    lost.set_exception(ValueError("lost"))
    del lost
    assert capsys.readouterr().err == "The following exception was never retrieved: lost\n"


def test_executor_shutdown_does_not_wait_for_a_callback(context, node):
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


@pytest.mark.pocket  # rclpy 7.1.3 keeps waiting for a result that never comes
def test_cancelled_future_ends_the_spin(executor):
    future = Future()
    threading.Timer(0.1, future.cancel).start()
    began = time.monotonic()
    executor.spin_until_future_complete(future, timeout_sec=60)
    assert time.monotonic() - began < 50
    assert not future.done()


def test_a_second_type_on_a_topic_is_reported_once(node, executor, spin_until, capfd, backend):
    received: list[str] = []
    joy = node.create_publisher(Joy, "x", 10)
    if rclpy.get_rmw_implementation_identifier() == "rmw_fastrtps_cpp":  # one type per topic and process
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
    said = capfd.readouterr().err.count("Incompatible type on topic 'x', no messages will be sent to it.")
    assert said == 2 or backend == "rclpy"  # once on either side
