"""Create nodes from a command's ROS 2 arguments, and commands that query ROS 2 through such a node."""

# ruff: noqa: PLC0415 - rclpy is slow to import, and help must be fast

from __future__ import annotations

import os
import signal
import sys
from collections.abc import Awaitable, Callable, Iterator, Sequence
from contextlib import contextmanager
from functools import wraps
from typing import TYPE_CHECKING, Any

import click

from tutorial.commands.terminal import until_asked
from tutorial.errors import TutorialError
from tutorial.system.printing import print_text

if TYPE_CHECKING:
    from tutorial.ros.node_thread import NodeThread

BROKEN_PIPE = 128 + signal.SIGPIPE  # the exit status that shells expect when a pipe's reader has exited


def query(question: Callable[..., Awaitable[None]]) -> Callable[..., int]:
    """Make a command's function from a coroutine function that queries a node and prints the answer.

    The node is hidden, like the node of ``ros2``. The option ``use_sim_time`` sets the node's parameter of the same
    name. The exit status is that of ``ros2``: 1 after an error, whose text is printed to stderr, and 2 after Ctrl-C. A
    TutorialError is printed unchanged, because some of these errors reuse the text of a ``ros2`` error, such as
    "Unknown topic".
    """

    @click.pass_obj
    @wraps(question)
    def command(ros_args: list[str], /, use_sim_time: bool = False, **options: Any) -> int:
        with clear_ros_errors(), named_node(f"_tank_{os.getpid()}", ros_args, use_sim_time) as thread:
            try:
                return signal.SIGINT if until_asked(question(thread.node, **options)) else 0
            except TutorialError as error:
                print_text(f"{error}\n", err=True)
                return 1
            except BrokenPipeError:
                os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())  # Python flushes stdout again at exit
                return BROKEN_PIPE

    return command


@contextmanager
def named_node(name: str, ros_args: Sequence[str], use_sim_time: bool = False) -> Iterator[NodeThread]:
    """Make a node with its own thread, for the duration of the context.

    Args:
        name: the node's name, unless it is remapped.
        ros_args: ROS 2's arguments.
        use_sim_time: the value of the node's parameter of the same name; if it is true, the node's clock follows
            ``/clock``.

    Raises:
        TutorialError: a name or an argument is invalid.
    """
    from tutorial.ros.node_thread import NodeThread

    given = ["--ros-args", "-p", "use_sim_time:=true"] if use_sim_time else []
    with clear_ros_errors():
        thread = NodeThread(name, [*ros_args, *given])
    with thread:
        yield thread


@contextmanager
def clear_ros_errors() -> Iterator[None]:
    """Convert rclpy's exceptions about names and arguments to errors without a traceback.

    While another program uses a name that the real rclpy cannot handle, rclpy lists no nodes or topics at all.
    """
    from rclpy._rclpy_pybind11 import UnknownROSArgsError
    from rclpy.exceptions import NameValidationException

    try:
        yield
    except NameValidationException as error:
        raise TutorialError(str(error)) from error
    except UnknownROSArgsError as error:
        raise TutorialError(f"ROS 2 does not recognize the arguments {error}") from error
    except (RuntimeError, UnicodeDecodeError) as error:
        raise TutorialError(f"ROS 2 reports: {error}") from error
