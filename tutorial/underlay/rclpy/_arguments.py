"""What stands between ``--ros-args`` and ``--`` on a command line: remappings, parameters, log levels."""

from __future__ import annotations

import sys
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from typing import Any, Self

from rclpy._rclpy_pybind11 import RCLError, UnknownROSArgsError
from rclpy.expand_topic_name import expand_topic_name
from rclpy.logging import get_logger

__all__ = ["Arguments", "Remapping", "split"]

REMAP = ("-r", "--remap")
PARAMETER = ("-p", "--param")
LOG_LEVEL = "--log-level"
IGNORED_WITH_VALUE = ("--params-file", "-e", "--enclave", "--log-config-file", "--log-file-name")
IGNORED = tuple(
    f"--{switch}-{what}"
    for switch in ("enable", "disable")
    for what in ("rosout-logs", "stdout-logs", "external-lib-logs")
)


@dataclass(frozen=True)
class Remapping:
    """One rule ``[NODE:]FROM:=TO``."""

    node: str
    source: str
    target: str

    @classmethod
    def parse(cls, rule: str) -> Self:
        """Read a rule.

        Raises:
            RCLError: it has no ``:=``, or nothing on one side of it.
        """
        source, separator, target = rule.partition(":=")
        if not (separator and source and target):
            get_logger("rcl").error("Failed to parse global arguments")
            raise RCLError(
                f"failed to initialize rcl: Couldn't parse remap rule: '-r {rule}'. "
                f"Error: Expected lexeme type (19) not found, search ended at index {len(source)}"
            )
        scheme, found, rest = source.partition("://")
        node, _, name = (rest if found and scheme == "rostopic" else source).rpartition(":")
        return cls(node, name, target)


@dataclass
class Arguments:
    """The ROS arguments of a process or a node.

    Attributes:
        remappings: in the order in which they were given; the first that fits applies.
        parameters: values by name.
        log_levels: severities by logger name; "" is the default of all.
    """

    remappings: list[Remapping] = field(default_factory=list)
    parameters: dict[str, Any] = field(default_factory=dict)
    log_levels: dict[str, str] = field(default_factory=dict)

    @classmethod
    def parse(cls, args: Sequence[str] | None) -> Self:
        """Read a command line.

        Args:
            args: of the process; None takes ``sys.argv``.

        Raises:
            RCLError: a value cannot be read.
            UnknownROSArgsError: there are others than ROS 2 knows.
        """
        arguments = cls()
        ros_args = iter(split(sys.argv if args is None else args)[0])
        unknown = [arg for arg in ros_args if not arguments._accept(arg, ros_args)]
        if unknown:
            raise UnknownROSArgsError(str(unknown))
        return arguments

    def node_value(self, node: str, source: str) -> str | None:
        """Return what ``__node`` or ``__ns`` of a node is remapped to, if it is."""
        names = (source, "__name") if source == "__node" else (source,)
        return next((rule.target for rule in self._rules_for(node) if rule.source in names), None)

    def topic(self, full_name: str, node: str, namespace: str) -> str:
        """Return what a topic is remapped to, or its own name.

        Args:
            full_name: of the topic.
            node: that uses it.
            namespace: of that node; relative names in rules are meant in it.
        """
        for rule in self._rules_for(node):
            if not rule.source.startswith("__") and expand_topic_name(rule.source, node, namespace) == full_name:
                return expand_topic_name(rule.target, node, namespace)
        return full_name

    def _rules_for(self, node: str) -> Iterator[Remapping]:
        return (rule for rule in self.remappings if rule.node in ("", node))

    def _accept(self, arg: str, rest: Iterator[str]) -> bool:
        """Take in one argument and its value; False if it is unknown."""
        if arg in REMAP:
            self.remappings.append(Remapping.parse(_value_of(arg, rest)))
        elif arg in PARAMETER:
            name, _, value = _value_of(arg, rest).partition(":=")
            self.parameters[name.rpartition(":")[2]] = _yaml(value)
        elif arg == LOG_LEVEL:
            logger, _, level = _value_of(arg, rest).rpartition(":=")
            self.log_levels[logger] = level
        elif arg in IGNORED_WITH_VALUE:
            _value_of(arg, rest)
        else:
            return arg in IGNORED
        return True


def split(args: Sequence[str]) -> tuple[list[str], list[str]]:
    """Separate a command line into (ROS arguments, the others)."""
    ros_args: list[str] = []
    others: list[str] = []
    target = others
    for arg in args:
        if arg == "--ros-args":
            target = ros_args
        elif arg == "--" and target is ros_args:
            target = others
        else:
            target.append(arg)
    return ros_args, others


def _value_of(flag: str, rest: Iterator[str]) -> str:
    value = next(rest, None)
    if value is None:
        raise RCLError(f"failed to initialize rcl: Couldn't parse trailing {flag} flag. No value found.")
    return value


def _yaml(text: str) -> Any:
    import yaml  # noqa: PLC0415  (rarely needed)

    return yaml.safe_load(text)
