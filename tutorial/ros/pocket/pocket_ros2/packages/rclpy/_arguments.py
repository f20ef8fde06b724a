"""Parse the ROS arguments between ``--ros-args`` and ``--`` on a command line: remappings, parameters, log levels."""

import json
import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, NamedTuple, Self

from _absent import FROM_PYPI
from rclpy._names import NAMESPACE, expand_topic_name, problem
from rclpy._rclpy_pybind11 import RCLError, UnknownROSArgsError
from rclpy.exceptions import NeedsRealROSError
from rclpy.logging import LoggingSeverity, get_logger

REMAP, PARAMETER, LOG_LEVEL, PARAMETER_FILE = "remap rule", "parameter override rule", "log level", "parameter file"
LOG_CONFIGURATION, ENCLAVE, LOG_FILE = "log configuration", "enclave path", "string prefix"
TABLE = json.loads(Path(__file__).with_name("arguments.json").read_text(encoding="utf-8"))
"""Flags that take a value, with the kind of value; flags that take no value; and the words for yes and no."""
FLAGS: dict[str, str] = TABLE["flags"]
RULE = re.compile(r"(?:(?P<node>\w+):(?!//|=))?(?:rostopic://)?(?P<name>.+?):=(?P<value>.+)", re.DOTALL)
READABLE = re.compile(r"([\w/~{}*]+:(?!=))?(rostopic://)?[\w/~{}*]*(:=[\w/~{}*]*)?")
"""Matches as much of the beginning of a remapping as rcl can read."""
TOKEN = r"(?!\w*__)[A-Za-z_]\w*"
TOPIC = rf"(?:~?/)?{TOKEN}(?:/{TOKEN})*"
REMAPPING = re.compile(
    rf"(?:{TOKEN}:)?(?:(?:ros(?:topic|service)://)?{TOPIC}:={TOPIC}|__(?:node|name):={TOKEN}|__ns:=/(?:{TOKEN}(?:/{TOKEN})*)?)",
    re.ASCII,
)
"""A remapping with valid names."""


class Rule(NamedTuple):
    """One rule ``[NODE:]NAME:=VALUE``."""

    node: str
    name: str
    value: Any


@dataclass
class Arguments:
    """The ROS arguments of a process or a node.

    Attributes:
        remappings: the remapping rules in command-line order; the first rule that matches applies.
        parameters: the parameter rules in command-line order; the last rule that matches applies.
        log_levels: severities, keyed by logger name; the key "" holds the default for all loggers.
        disabled_logs: outputs that receive no log lines, such as ``"rosout"`` and ``"stdout"``.
        log_configuration: path of a logging configuration file, which Jazzy cannot read; "" if not given.
        enclave: the security enclave's name.
    """

    remappings: list[Rule] = field(default_factory=list)
    parameters: list[Rule] = field(default_factory=list)
    log_levels: dict[str, LoggingSeverity] = field(default_factory=dict)
    disabled_logs: set[str] = field(default_factory=set)
    log_configuration: str = ""
    enclave: str = "/"

    @classmethod
    def parse(cls, args: Sequence[str]) -> Self:
        """Parse a command line.

        Raises:
            RCLError: a value cannot be parsed.
            UnknownROSArgsError: there is an argument that ROS 2 does not recognize.
        """
        arguments, unknown = cls(), []
        ros_args = iter(split(args)[0])
        for flag in ros_args:
            if flag in FLAGS:
                arguments._add(flag, next(ros_args, None))
            elif flag in TABLE["switches"]:
                arguments._switch_logs(flag)
            else:
                unknown.append(flag)
        if unknown:
            raise UnknownROSArgsError(str(unknown))
        return arguments

    def node_value(self, node: str, name: str) -> str | None:
        """Return the new value of a node's ``__node`` or ``__ns``; None if no rule remaps it."""
        names = (name, "__name") if name == "__node" else (name,)
        return next((rule.value for rule in self.remappings if rule.node in ("", node) and rule.name in names), None)

    def topic(self, full_name: str, node: str, namespace: str) -> str | None:
        """Return a topic's new name, or None if the topic is not remapped.

        Args:
            full_name: the topic's full name.
            node: name of the node that uses the topic.
            namespace: the node's namespace, used to expand relative names in rules.
        """
        for rule in self.remappings:
            meant = rule.node in ("", node) and not rule.name.startswith("__")
            if meant and expand_topic_name(rule.name, node, namespace) == full_name:
                return expand_topic_name(rule.value, node, namespace)
        return None

    def overrides(self, node: str) -> Iterator[tuple[str, Any]]:
        """Return the name and value of each parameter override for a node."""
        return ((rule.name, rule.value) for rule in self.parameters if rule.node in ("", node))

    def check_enclave(self) -> None:
        """Check that the enclave's name is valid; the pocket ROS 2 does nothing else with the name.

        Raises:
            RCLError: the name breaks the naming rules.
        """
        if self.enclave != "/" and (found := problem(NAMESPACE, self.enclave)):
            text, index = found
            text = f"Enclave name is not valid: '{text.replace('namespace', 'context name')}'. Invalid index: {index}"
            raise RCLError(f"failed to initialize rcl: {text}")

    def _switch_logs(self, flag: str) -> None:
        """Apply a flag such as ``--disable-rosout-logs``."""
        change, _, output = flag.removeprefix("--").removesuffix("-logs").partition("-")
        if change == "disable":
            self.disabled_logs.add(output)
        else:
            self.disabled_logs.discard(output)

    def _add(self, flag: str, text: str | None) -> None:
        kind = FLAGS[flag]
        if text is None:
            raise _unreadable(_nothing_after(flag, kind))
        failure = f"{kind}: '{flag} {text}'. Error:"
        if kind in (REMAP, PARAMETER):
            self._add_rule(kind, text, failure)
        elif kind == LOG_LEVEL:
            logger, _, level = text.rpartition(":=")
            if level.upper() not in LoggingSeverity.__members__:
                raise _unreadable(f"{failure} Argument does not use a valid severity level")
            self.log_levels[logger] = LoggingSeverity[level.upper()]
        elif kind == LOG_CONFIGURATION:
            self.log_configuration = text
        elif kind == ENCLAVE:
            self.enclave = text
        elif kind == PARAMETER_FILE:
            raise NeedsRealROSError(flag, FROM_PYPI)

    def _add_rule(self, kind: str, text: str, failure: str) -> None:
        parts, unread = RULE.fullmatch(text), READABLE.sub("", text, count=1)
        if not parts or (unread and kind == REMAP):
            lexeme = 22 if kind == PARAMETER else 1 if parts and parts["name"].startswith("__") else 19
            end = len(text) - len(unread)
            raise _unreadable(f"{failure} Expected lexeme type ({lexeme}) not found, search ended at index {end}")
        node, name, value = parts["node"] or "", parts["name"], parts["value"]
        if kind == REMAP:
            if not REMAPPING.fullmatch(text):
                raise _unreadable(f"{failure} '{name}' cannot be remapped to '{value}': both must be valid names")
            if not name.startswith("rosservice://"):
                self.remappings.append(Rule(node, name, value))
            return
        try:
            self.parameters.append(Rule(node, name, parameter_value(value)))
        except ValueError as error:
            raise _unreadable(f"{failure} {error}") from None


def split(args: Sequence[str]) -> tuple[list[str], list[str]]:
    """Split a command line into ROS arguments and other arguments."""
    ros_args, others = list[str](), list[str]()
    target = others
    for arg in args:
        if arg == "--ros-args":
            target = ros_args
        elif arg == "--" and target is ros_args:
            target = others
        else:
            target.append(arg)
    return ros_args, others


def parameter_value(text: str) -> Any:
    """Parse a parameter's value. As in rcl's YAML, ``1e3`` is a number and ``y`` is a boolean.

    Raises:
        ValueError: the text is neither a scalar nor a list of scalars of one type.
    """
    import yaml  # noqa: PLC0415  (rarely needed)

    try:
        node = yaml.compose(text, Loader=yaml.SafeLoader)
    except yaml.YAMLError as error:
        raise ValueError(f"it is not valid YAML: {error}") from None
    if isinstance(node, yaml.SequenceNode) and all(isinstance(item, yaml.ScalarNode) for item in node.value):
        values = [_scalar(item.value, item.style) for item in node.value]
        if len({type(value) for value in values}) > 1:
            raise ValueError("Sequence should be of same type")
        return values
    if not isinstance(node, yaml.ScalarNode):
        raise ValueError("it is neither a scalar nor a list of scalars")
    return _scalar(node.value, node.style)


def _scalar(text: str, style: str | None) -> Any:
    if style:  # quoted
        return text
    if text in (*TABLE["yes"], *TABLE["no"]):
        return text in TABLE["yes"]
    if re.fullmatch(r"[+-]?([0-9]+|0[xX][0-9a-fA-F]+)", text):
        return int(text, 16 if "x" in text.lower() else 10)
    try:
        return float(re.sub(r"\.(?=(inf|nan)\Z)", "", text, flags=re.IGNORECASE).replace("_", "no number"))
    except ValueError:
        return text


def _nothing_after(flag: str, kind: str) -> str:
    """Return rcl's error message for a flag without a value."""
    if kind == LOG_LEVEL:
        return f"trailing log level flag: '{flag}'. No log level provided."
    if kind in (REMAP, PARAMETER):
        return f"trailing {flag} flag. No {kind} found."
    wanted = kind if kind in (ENCLAVE, LOG_FILE) else "file path"
    return f"trailing {flag} flag. No {wanted} provided."


def _unreadable(text: str) -> RCLError:
    get_logger("rcl").error("Failed to parse global arguments")
    return RCLError(f"failed to initialize rcl: Couldn't parse {text}")
