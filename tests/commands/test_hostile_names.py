"""What ``tank`` prints beside a program whose names would have a terminal obey them."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from contextlib import contextmanager

import pytest
from hostile_peer import BACKWARDS, ESCAPES, FORGED, JOINTS, LONG, NODES, hostile_peer
from programs import until

from tutorial import ros_backend
from tutorial.ros.domains import reserved_domain
from tutorial.ros.topics.names import escape_name, full_name

pytestmark = [
    pytest.mark.process,
    pytest.mark.timeout(300),
    pytest.mark.skipif(not sys.platform.startswith("linux"), reason="the hostile program is made for Linux"),
]

STRING = "std_msgs/msg/String"


@contextmanager
def hostile_domain(*arguments: str) -> Iterator[int]:
    with reserved_domain() as domain, hostile_peer(domain, *arguments):
        yield domain


@pytest.fixture(scope="module")
def hostile_number() -> Iterator[int]:
    """A domain with the hostile program in it."""
    with hostile_domain() as number:
        yield number


@pytest.fixture
def hostile(tank, hostile_number, monkeypatch):
    """Have the test's commands beside the hostile program."""
    monkeypatch.setenv("ROS_DOMAIN_ID", str(hostile_number))


def harmless(text: str) -> None:
    """Nothing is in it that a terminal would obey, but for line breaks; and no traceback."""
    assert text.replace("\n", "").isprintable(), ascii(text)
    assert "Traceback" not in text


LISTED = [escape_name(full_name(*names)) for names in NODES]
COMMANDS = [
    (("topic", "list", "-t"), 0, [r"/type1 [a\n/forged [\u202egpj", f"//x [{STRING}]"]),
    (("topic", "info", "-v", "/1abc"), 0, ["Publisher count: 1", f"Node name: {escape_name(ESCAPES)}"]),
    (("topic", "info", "/type0"), 0, [r"Type: \x1b[2J\x1b]0;mine\x07/msg/X"]),
    (("topic", "echo", "--once", JOINTS), 0, [r"frame_id: <img src=x onerror=window.pwned=1>", f"- {LONG[:128]}..."]),
    (("topic", "echo", "/type0"), 1, [r"The message type '\x1b[2J\x1b]0;mine\x07/msg/X' is invalid"]),
    (("node", "list"), 0, LISTED),
    (("doctor",), None, ["\npackages   ok ", r"\x1b[2J\x1b]0;mine\x07", r"/forged\u2028\x85b"]),
    (
        ("run", "step3", "--headless", "--duration", "3"),
        0,
        [f"unknown {ESCAPES!r}, {BACKWARDS!r}, {FORGED!r} and 3 more"],
    ),
]


def prints(tank, command, status, lines):
    """Run a command, once more where the two had no time to find each other; harmless it is each time."""

    def says_so():
        run = tank("", *command)
        harmless(run.output)
        return status in (None, run.status) and all(line in run.output for line in lines)

    until(says_so, f"the end with {status}, and {lines}")


@pytest.mark.parametrize(("command", "status", "lines"), COMMANDS, ids=lambda value: repr(value)[:60])
def test_a_command_prints_names_and_texts_without_obeying_them(hostile, tank, command, status, lines):
    prints(tank, command, status, lines)


def test_a_name_with_which_a_real_ros_2_lists_no_node_at_all(tank, monkeypatch):
    """That is an error there, with its words. Others go on."""
    is_real = ros_backend() == "rclpy"
    with hostile_domain("nameless") as number:
        monkeypatch.setenv("ROS_DOMAIN_ID", str(number))
        prints(tank, ("node", "list"), is_real, ["empty node name" if is_real else "/\n"])
        prints(tank, ("run", "step3", "--headless", "--duration", "2"), 0, [])
