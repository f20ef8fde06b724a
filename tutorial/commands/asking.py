"""A command's own node: made by ROS 2's arguments, and asked something until there is an answer or Ctrl-C."""

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
from tutorial.system.printing import say

if TYPE_CHECKING:
    from tutorial.ros.node_thread import NodeThread

BROKEN_PIPE = 128 + signal.SIGPIPE  # the exit status that shells expect when nobody reads on


def asks(question: Callable[..., Awaitable[None]]) -> Callable[..., int]:
    """Make a command's function of a question: it is given a node and the command's options, and prints the answer.

    The node is hidden, as that of ``ros2``. The option ``use_sim_time`` is the node's parameter. The exit status is
    that of ``ros2``, too: 1 after an error, whose text is on stderr then; 2 after Ctrl-C. Where ``ros2`` has a text of
    its own, such as "Unknown topic", it is printed unchanged; other errors are raised as TutorialError.
    """

    @click.pass_obj
    @wraps(question)
    def command(ros_args: list[str], /, use_sim_time: bool = False, **options: Any) -> int:
        with clear_ros_errors(), named_node(f"_tank_{os.getpid()}", ros_args, use_sim_time) as thread:
            try:
                return signal.SIGINT if until_asked(question(thread.node, **options)) else 0
            except TutorialError as error:
                say(f"{error}\n", err=True)
                return 1
            except BrokenPipeError:
                os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())  # Python flushes it once more at the end
                return BROKEN_PIPE

    return command


@contextmanager
def named_node(name: str, ros_args: Sequence[str], use_sim_time: bool = False) -> Iterator[NodeThread]:
    """Make a node with a thread of its own, for as long as the context lasts.

    Args:
        name: its name, unless it is remapped.
        ros_args: ROS 2's arguments.
        use_sim_time: the node's parameter, for a clock that follows ``/clock``.

    Raises:
        TutorialError: a name or an argument is wrong.
    """
    from tutorial.ros.node_thread import NodeThread

    given = ["--ros-args", "-p", "use_sim_time:=true"] if use_sim_time else []
    with clear_ros_errors():
        thread = NodeThread(name, [*ros_args, *given])
    with thread:
        yield thread


@contextmanager
def clear_ros_errors() -> Iterator[None]:
    """Turn what rclpy raises about names and arguments into an error without a traceback.

    A real one refuses to list any node or topic while another program has a name that it cannot bear.
    """
    from rclpy._rclpy_pybind11 import UnknownROSArgsError
    from rclpy.exceptions import NameValidationException

    try:
        yield
    except NameValidationException as error:
        raise TutorialError(str(error)) from error
    except UnknownROSArgsError as error:
        raise TutorialError(f"ROS 2 does not know the arguments {error}") from error
    except (RuntimeError, UnicodeDecodeError) as error:
        raise TutorialError(f"ROS 2 says: {error}") from error
