"""Fixtures: a context and a node for each test, in a domain of its own, and a helper to spin until."""

import subprocess
import sys
import time
from collections.abc import Callable, Iterator

import pytest
from rclpy.context import Context
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node

PATIENCE = 30.0
"""How long a condition may take to come true [s]: long, for both cores may be busy. Only a failing test waits so."""


@pytest.fixture
def context(domain: int) -> Iterator[Context]:
    """A running context, not the default one."""
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
    """An executor that runs the node's callbacks when the test spins it."""
    with SingleThreadedExecutor(context=context) as executor:
        executor.add_node(node)
        yield executor


@pytest.fixture
def spin_until(executor: SingleThreadedExecutor) -> Callable[[Callable[[], object]], None]:
    """Spin until a condition holds; fails if it never does."""

    def spin_until(condition: Callable[[], object]) -> None:
        deadline = time.monotonic() + PATIENCE
        while not condition():
            assert time.monotonic() < deadline, "waited in vain"
            executor.spin_once(timeout_sec=0.05)

    return spin_until


@pytest.fixture
def start(domain: int) -> Iterator[Callable[..., subprocess.Popen[str]]]:
    """Start a Python program, and its arguments, in a process of its own; what still runs in the end is killed."""
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
