"""Fixtures: a context and a node in a new domain for each test, and a helper that spins until a condition holds."""

import subprocess
import sys
import time
from collections.abc import Callable, Iterator

import pytest
from rclpy.context import Context
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node

TIMEOUT = 30.0
"""How long a condition may take to come true [s]. Both cores may be busy, and only a failing test waits so long."""


@pytest.fixture
def context(domain: int) -> Iterator[Context]:
    """A running context other than the default one."""
    context = Context()
    context.init(args=[])
    yield context
    context.try_shutdown()


@pytest.fixture
def node(context: Context) -> Iterator[Node]:
    """A node called ``/Tank/tester``."""
    node = Node("tester", context=context, namespace="/Tank")
    yield node
    node.destroy_node()  # in rclpy a shutdown alone leaves it in the graph, where a later test may see it


@pytest.fixture
def executor(context: Context, node: Node) -> Iterator[SingleThreadedExecutor]:
    """An executor for the node; the test spins it."""
    with SingleThreadedExecutor(context=context) as executor:
        executor.add_node(node)
        yield executor


@pytest.fixture
def spin_until(executor: SingleThreadedExecutor) -> Callable[[Callable[[], object]], None]:
    """Spin until a condition holds, and fail if it never does."""

    def spin_until(condition: Callable[[], object]) -> None:
        deadline = time.monotonic() + TIMEOUT
        while not condition():
            assert time.monotonic() < deadline, "timed out waiting for a condition"
            executor.spin_once(timeout_sec=0.05)

    return spin_until


@pytest.fixture
def start(domain: int) -> Iterator[Callable[..., subprocess.Popen[str]]]:
    """Start a Python program with arguments in a new process, and kill what is left of it at the end."""
    processes: list[subprocess.Popen[str]] = []

    def start(code: str, *arguments: str) -> subprocess.Popen[str]:
        process = subprocess.Popen(
            [sys.executable, "-c", f"import pocket_ros2\n{code}", *arguments],
            text=True,
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
        )
        processes.append(process)
        return process

    yield start
    for process in processes:
        process.kill()
        process.communicate()
