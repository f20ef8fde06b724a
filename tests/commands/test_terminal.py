"""How commands end: the first Ctrl-C or SIGTERM asks, the second ends all at once, whatever the main thread does."""

from __future__ import annotations

import fcntl
import logging
import os
import signal
import struct
import subprocess
import sys
import termios

import pytest
from pictures import need_pictures
from programs import PATIENCE, TANK, until

from tutorial.commands.terminal import prepare_output, status_line

INT, TERM = signal.SIGINT, signal.SIGTERM
STUCK = "        import time\n        while True: print('stuck', flush=True); time.sleep(0.01)\n"
ENDLESS = {
    "configure": f"    def configure(self, config):\n{STUCK}",
    "a posted call": (
        f"    def configure(self, config):\n        config.call_later(self.work)\n    def work(self):\n{STUCK}"
    ),
    "unconfigure": f"    def unconfigure(self):\n{STUCK}",
    "one call in C": (
        "    def configure(self, config):\n"
        "        import mujoco\n"
        "        model = mujoco.MjModel.from_xml_string('<mujoco/>')\n"
        "        print('stuck\\nstuck\\nstuck', flush=True)\n"
        "        mujoco.mj_step(model, mujoco.MjData(model), nstep=2**31 - 1)\n"
    ),
}


def test_what_the_terminal_has_no_characters_for_is_an_escape():
    code = "from tutorial.commands.terminal import *; prepare_output(); say('戦車 é\\x1b\\n')"
    environment = {**os.environ, "PYTHONIOENCODING": "latin-1", "PYTHONUTF8": "0"}
    run = subprocess.run([sys.executable, "-c", code], env=environment, capture_output=True, check=True)
    assert run.stdout == b"\\u6226\\u8eca \xe9\\x1b\n"


def test_a_log_line_is_printed_as_everything_else(capsys, monkeypatch):
    monkeypatch.setattr(logging.root, "handlers", [])
    monkeypatch.setattr(logging.root, "level", logging.root.level)
    prepare_output()
    logging.getLogger("x").warning("%s", "a\x1b[2J\u202e")
    assert capsys.readouterr().err == "[WARNING] a\\x1b[2J\\u202e\n"


def test_a_library_that_is_at_ease_is_not_heard(program):
    """With MUJOCO_GL set, MuJoCo imports PyOpenGL with itself, and that says what it does without."""
    need_pictures()
    running = program("run", "step1", "--headless", "--duration", "0.1", environment={"MUJOCO_GL": "egl"})
    assert running.ends() == 0
    assert "+ World" in running.output
    assert "OpenGL" not in running.output


@pytest.fixture
def controller(tmp_path):
    """Write a controller that takes the place of the viewer's."""

    def write(methods):
        path = tmp_path / "mine.py"
        base = "from tutorial.controller import SimpleController\nclass JointStateSubscriber(SimpleController):\n"
        path.write_text(base + methods)
        return path

    return write


def stuck(running):
    """Wait until its main thread is stuck, and has had time to hear what it was sent."""
    heard = len(running.lines) + 3
    until(lambda: running.output.count("stuck") >= 3 and len(running.lines) >= heard, "the loop")


@pytest.mark.parametrize("terminal", [True, False])
def test_how_far_it_is_stands_on_a_terminal_only(capsys, monkeypatch, terminal):
    monkeypatch.setattr(sys.stderr, "isatty", lambda: terminal, raising=False)
    with status_line() as status:
        status("12 messages")
    assert ("12 messages" in capsys.readouterr().err) == terminal


@pytest.mark.parametrize(
    ("where", "first", "second"),
    [("configure", INT, INT), ("a posted call", INT, TERM), ("a posted call", TERM, TERM)],
)
def test_the_second_signal_ends_a_run_that_is_in_a_loop(program, controller, where, first, second):
    running = program("run", "step3", "--headless", "--controller", controller(ENDLESS[where]))
    stuck(running)
    running.process.send_signal(first)
    stuck(running)
    assert running.process.poll() is None
    running.process.send_signal(second)
    assert running.ends() == 128 + second
    running.leaves_nothing()


def test_it_ends_a_run_whose_controller_does_not_leave(program, controller):
    running = program("run", "step3", "--headless", "--controller", controller(ENDLESS["unconfigure"]))
    running.says("JointStateSubscriber")
    running.asks_to_stop()
    stuck(running)
    running.asks_to_stop()
    assert running.ends() == 128 + INT


def test_it_ends_a_run_that_is_in_a_call_that_python_does_not_interrupt(program, controller):
    running = program("run", "step3", "--headless", "--controller", controller(ENDLESS["one call in C"]))
    running.says("stuck")
    for number in (INT, TERM):
        running.process.send_signal(number)
        until(lambda number=number: not pending(running.process.pid, number), "its delivery")
    assert running.ends() == 128 + TERM


def pending(pid, number):
    """Whether a process has been sent a signal that it has not got yet; Linux tells."""
    try:
        with open(f"/proc/{pid}/status") as status:  # noqa: PTH123
            masks = [int(line.split()[1], 16) for line in status if line.startswith(("SigPnd", "ShdPnd"))]
    except FileNotFoundError:
        return False
    return any(mask >> (number - 1) & 1 for mask in masks)


def test_it_ends_an_echo_that_nobody_reads(program):
    program("topic", "pub", "-r", 10, "/long", "std_msgs/msg/String", f"data: {'x' * 120_000}")
    command = [TANK, "topic", "echo", "-f", "/long", "std_msgs/msg/String"]
    with subprocess.Popen(command, stdout=subprocess.PIPE) as running:

        def unread():
            return struct.unpack("i", fcntl.ioctl(running.stdout, termios.FIONREAD, bytes(4)))[0]

        until(lambda: unread() > 0, "its first line, of more than there is room for")
        running.send_signal(INT)
        until(lambda: not pending(running.pid, INT), "its delivery")
        running.send_signal(INT)
        assert running.wait(PATIENCE) == 128 + INT


@pytest.mark.parametrize(
    ("command", "said"),
    [
        ("run step3 --headless", "JointStateSubscriber"),
        ("joy --drive tour", "scripted drive"),
        ("launch step3 --headless", "viewer     | "),
        ("demo --headless --duration 300", "viewer     | "),
        ("topic echo /nothing std_msgs/msg/String", ""),
    ],
)
def test_two_at_once_end_every_command_with_all_that_comes_from_it(program, command, said):
    running = program(*command.split())
    running.says(said)
    if not said:
        until(lambda: "/nothing" in subprocess.check_output([TANK, "topic", "list"], text=True), "the subscription")
    running.asks_to_stop()
    running.asks_to_stop()
    assert running.ends() in (0, 2, 128 + INT, -INT)
    running.leaves_nothing()
