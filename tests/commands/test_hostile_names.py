"""Every command of ``tank`` at a terminal, beside a program whose names would have that terminal obey them."""

from __future__ import annotations

import json
import os
import pty
import re
import signal
import subprocess
import sys
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import click
import pytest
from domains import reserved_domain
from hostile_peer import BACKWARDS, ESCAPES, FORGED, JOINTS, LONG, NODES, SAID, hostile_peer
from programs import PATIENCE, TANK, until

from tutorial import ros_backend
from tutorial.commands.tank import tank
from tutorial.ros.topics.names import full_name, shown

pytestmark = [
    pytest.mark.timeout(300),
    pytest.mark.skipif(not sys.platform.startswith("linux"), reason="the hostile program is made for Linux"),
]

LAYOUT = re.compile(r"\n")
WITH_TABS = re.compile(r"[\n\t]")
WITH_A_BAR = re.compile(r"\n|\r|\x1b\[A|\x1b\[[\d;]*m")
"""What ``tank`` sends by itself: a progress bar, and colours."""
STRING = "std_msgs/msg/String"
ANSWER = """def match_by_name(joint_names, message):
    return dict(zip(joint_names, message.position))
"""
CELL = {"cell_type": "code", "id": "answer", "metadata": {}, "outputs": [], "execution_count": None}
NOTEBOOK = {
    "cells": [{**CELL, "source": ANSWER}],
    "metadata": {},
    "nbformat": 4,
    "nbformat_minor": 5,
}


class Terminal:
    """A command at a terminal of its own."""

    def __init__(self, domain: int, *arguments: str, here: Path | None = None, **variables: str) -> None:
        master, slave = pty.openpty()
        how = {
            "env": {**os.environ, "ROS_DOMAIN_ID": str(domain), "COLUMNS": "200", **variables},
            "cwd": here,
            "start_new_session": True,
        }
        self.process = subprocess.Popen([TANK, *arguments], stdin=slave, stdout=slave, stderr=slave, **how)
        os.close(slave)
        self._master = master
        self._bytes = b""
        self._reader = threading.Thread(target=self._read, daemon=True)
        self._reader.start()

    @property
    def text(self) -> str:
        """What has been printed so far, with the line ends that the command has printed."""
        return self._bytes.decode(errors="surrogateescape").replace("\r\n", "\n")

    def ends(self) -> int:
        """Wait for its end; return its exit status."""
        try:
            return self.process.wait(2 * PATIENCE)
        finally:
            self.process.kill()
            self.process.wait()
            self._reader.join()
            os.close(self._master)

    def _read(self) -> None:
        try:
            while part := os.read(self._master, 65536):
                self._bytes += part
        except OSError:  # Linux's way to say that nobody has the other end
            pass


@contextmanager
def hostile_domain(*arguments: str) -> Iterator[int]:
    with reserved_domain() as domain, hostile_peer(domain, *arguments):
        yield domain


@pytest.fixture(scope="module")
def hostile() -> Iterator[int]:
    """A domain with the hostile program in it."""
    with hostile_domain() as domain:
        yield domain


def harmless(text: str, own: re.Pattern[str] = LAYOUT) -> None:
    """Nothing is in it that a terminal would obey, but for what is the command's own; and no traceback."""
    assert own.sub("", text).isprintable(), ascii(text)
    assert "Traceback" not in text


LISTED = [shown(full_name(*names)) for names in NODES]
COMMANDS = [
    (
        ("topic", "list", "-t"),
        0,
        [rf"/\x1b[31mb [{STRING}]", r"/type1 [a\n/forged [\u202egpj", f"//x [{STRING}]"],
    ),
    (("topic", "list", "-v"), 0, [rf" * /a\r\nforge [{STRING}] 1 publisher", f" * / [{STRING}] 1 publisher"]),
    (("topic", "info", "-v", "/1abc"), 0, ["Publisher count: 1", f"Node name: {shown(ESCAPES)}"]),
    (("topic", "info", "/type0"), 0, [r"Type: \x1b[2J\x1b]0;mine\x07/msg/X"]),
    (("topic", "info", ESCAPES), 1, [f"Unknown topic '{shown(ESCAPES)}'"]),
    (("topic", "type", "/type0"), 0, [r"\x1b[2J\x1b]0;mine\x07/msg/X"]),
    (("topic", "find", STRING), 0, [r"/\u202egpj", "/1abc\n"]),
    (("topic", "echo", "--timeout", "1", SAID), 0, [r'data: "\e[2J\e]0;mine\a"', r'data: "\u202egpj.exe"']),
    (("topic", "echo", "--timeout", "1", "--csv", SAID), 0, [shown(ESCAPES), shown(FORGED), shown(BACKWARDS)]),
    (("topic", "echo", "--timeout", "1", "--field", "data", SAID), 0, [shown(ESCAPES), r"/forged\u2028\x85b"]),
    (("topic", "echo", "--once", JOINTS), 0, [r"frame_id: <img src=x onerror=window.pwned=1>", f"- {LONG[:128]}..."]),
    (("topic", "echo", "/type0"), 1, [r"The message type '\x1b[2J\x1b]0;mine\x07/msg/X' is invalid"]),
    (("topic", "echo", "/type3"), 1, ["The message type 'antigravity/msg/X' is invalid"]),
    (("topic", "echo", "/1abc"), 1, ["topic name token must not start with a number"]),
    (("topic", "pub", "--once", "-w", "0", SAID, STRING, f"data: {BACKWARDS}"), 0, [r"(data='\u202egpj.exe')"]),
    (("node", "list"), 0, LISTED),
    (("node", "info", f"/{ESCAPES}"), None, [shown(f"/{ESCAPES}")]),
    (("node", "info", "//x/a/b"), None, ["//x/a/b"]),
    (("doctor",), None, [r"\x1b[2J\x1b]0;mine\x07", r"/forged\u2028\x85b"]),
    (("joy", "--drive", "tour", "--duration", "0.5"), 0, ["scripted drive: tour.yaml"]),
    (("chaos", "-f", "shuffle", "--from", JOINTS, "/chaos", "--duration", "1"), 0, ["messages hit: "]),
    (
        ("run", "step3", "--headless", "--duration", "3"),
        0,
        [f"unknown {ESCAPES!r}, {BACKWARDS!r}, {FORGED!r} and 3 more"],
    ),
    (("demo", "--headless", "--duration", "3"), 0, [f"unknown {ESCAPES!r}, {BACKWARDS!r}, {FORGED!r} and 3 more"]),
    (("launch", "step2", "--headless", "--duration", "3"), 0, ["    - JointStatePublisher"]),
    (("urdf", "tank"), 0, ['<robot name="Tank">']),
    (("package", "own"), 0, ["colcon build"]),
    (("progress",), 0, ["fire"]),
    (("check", "learners.ipynb"), 1, ["matched by their place"]),
]
COLOURFUL = ("chaos", "check", "demo", "joy", "launch", "run")


def test_a_command_that_goes_on(hostile):
    terminal = Terminal(hostile, "topic", "hz", SAID)
    try:
        until(lambda: "std dev" in terminal.text, "a rate")
    finally:
        terminal.process.send_signal(signal.SIGINT)
        assert terminal.ends() == 2, terminal.text
    harmless(terminal.text, WITH_TABS)


@pytest.mark.parametrize(("command", "status", "lines"), COMMANDS, ids=lambda value: repr(value)[:60])
def test_a_command_prints_names_and_texts_without_obeying_them(hostile, tmp_path, command, status, lines):
    (tmp_path / "learners.ipynb").write_text(json.dumps(NOTEBOOK), encoding="utf-8")

    def says_so():
        """Once more where the two had no time to find each other; harmless it is each time."""
        terminal = Terminal(hostile, *command, here=tmp_path)
        ended = terminal.ends()
        print(f"it ended with {ended}, and said:\n{terminal.text}")
        harmless(terminal.text, WITH_A_BAR if command[0] in COLOURFUL else LAYOUT)
        return status in (None, ended) and all(line in terminal.text for line in lines)

    until(says_so, f"the end with {status}, and {lines}")


def test_the_notebooks_server(hostile, own_folders):
    """It is beside them, too, and hears nothing of them."""
    terminal = Terminal(hostile, "lab", "--", "--no-browser", "--ServerApp.port=0", **own_folders)
    try:
        until(lambda: "Ctrl-C ends it." in terminal.text, "the server listens")
    finally:
        terminal.process.send_signal(signal.SIGINT)
        assert terminal.ends() == 0, terminal.text
    harmless(terminal.text, WITH_A_BAR)


def test_a_bag_of_what_they_say(hostile, tmp_path):
    """It is recorded, looked at and played, and what cannot be recorded is named."""
    record = Terminal(hostile, "bag", "record", "-a", "--duration", "3", "-o", str(tmp_path / "bag"))
    assert record.ends() == 0, record.text
    harmless(record.text, WITH_A_BAR)
    assert "topic //x is not recorded: its name breaks the rules of ROS 2" in record.text
    assert r"is not recorded: The message type '\x1b[2J\x1b]0;mine\x07/msg/X' is invalid" in record.text
    info = Terminal(hostile, "bag", "info", str(tmp_path / "bag"))
    assert info.ends() == 0, info.text
    harmless(info.text)
    assert f"Topic: {SAID} | Type: {STRING} | Count: " in info.text
    with reserved_domain() as domain:
        play = Terminal(domain, "bag", "play", str(tmp_path / "bag"), "--rate", "10")
        assert play.ends() == 0, play.text
    harmless(play.text, WITH_A_BAR)


def test_a_node_without_a_name_and_a_topic_whose_name_is_no_text():
    """With which a real ROS 2 lists nothing at all: that is an error, with its words. Others go on."""
    with hostile_domain("nameless", "no_text") as domain:
        nodes = Terminal(domain, "node", "list")
        topics = Terminal(domain, "topic", "list")
        viewer = Terminal(domain, "run", "step3", "--headless", "--duration", "2")
        statuses = [terminal.ends() for terminal in (nodes, topics, viewer)]
    harmless(nodes.text)
    harmless(topics.text)
    harmless(viewer.text, WITH_A_BAR)
    if ros_backend() == "rclpy":
        assert (statuses, "empty node name" in nodes.text, "can't decode" in topics.text) == ([1, 1, 0], True, True)
    else:
        assert (statuses, "/" in nodes.text.splitlines()) == ([0, 0, 0], True)
        assert "/\N{REPLACEMENT CHARACTER}\N{REPLACEMENT CHARACTER}" in topics.text.splitlines()


def test_the_list_of_commands_is_complete():
    asked = {" ".join(command[: 2 if command[0] in ("node", "topic") else 1]) for command, *_ in COMMANDS}

    def names(group: click.Group, before: str = "") -> Iterator[str]:
        for name, command in group.commands.items():
            yield from names(command, f"{name} ") if isinstance(command, click.Group) else [before + name]

    alone = {"bag record", "bag info", "bag play", "lab", "topic hz"}  # in tests of their own
    assert set(names(tank)) == asked | alone
