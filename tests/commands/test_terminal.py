"""How commands end: the first Ctrl-C or SIGTERM asks, the second ends all at once, whatever the main thread does."""

from __future__ import annotations

import io
import logging
import os
import signal
import sys

import pytest
from programs import until

from tutorial.commands import terminal
from tutorial.commands.terminal import prepare_output, progress_bar
from tutorial.printing import say

INT, TERM, HUP = signal.SIGINT, signal.SIGTERM, signal.SIGHUP
IN_C = (
    "    def configure(self, config):\n"
    "        import mujoco\n"
    "        model = mujoco.MjModel.from_xml_string('<mujoco/>')\n"
    "        print('stuck', flush=True)\n"
    "        mujoco.mj_step(model, mujoco.MjData(model), nstep=2**31 - 1)\n"
)


def test_what_the_terminal_has_no_characters_for_is_an_escape(monkeypatch):
    written = io.BytesIO()
    monkeypatch.setattr(sys, "stdout", io.TextIOWrapper(written, "latin-1"))
    prepare_output()
    say("戦車 é\x1b\n")
    assert written.getvalue() == b"\\u6226\\u8eca \xe9\\x1b\n"


def test_a_log_line_is_printed_as_everything_else(capsys, monkeypatch):
    monkeypatch.setattr(logging.root, "handlers", [])
    monkeypatch.setattr(logging.root, "level", logging.root.level)
    prepare_output()
    logging.getLogger("x").warning("%s", "a\x1b[2J\u202e")
    logging.getLogger("x").info("as well")
    logging.getLogger("OpenGL").info("what it does without, which nobody asked for")
    assert capsys.readouterr().err == "[WARNING] a\\x1b[2J\\u202e\n[INFO] as well\n"


@pytest.mark.parametrize(("duration", "at_a_terminal"), [(4.0, True), (4.0, False), (None, True)])
def test_a_bar_is_full_at_the_end_and_stands_on_a_terminal_only(capsys, monkeypatch, duration, at_a_terminal):
    monkeypatch.setattr(sys.stderr, "isatty", lambda: at_a_terminal, raising=False)
    with progress_bar(duration) as progress:
        for seconds in (3.0, 5.0):
            progress(seconds)
    bar = f"100% |{'=' * 40}| 4 of 4 s"
    assert (bar in capsys.readouterr().err) == (duration is not None and at_a_terminal)


@pytest.mark.parametrize(("heard", "status"), [([9, INT, TERM], 143), ([TERM, 9, INT], 130)])
def test_the_first_signal_asks_and_the_second_ends_it_at_once(monkeypatch, heard, status):
    happened = []

    def fail(what):
        happened.append(what)
        raise RuntimeError(what)

    monkeypatch.setattr(os, "_exit", happened.append)
    with pytest.raises(RuntimeError, match="at once"):
        terminal._end(iter(heard).__next__, lambda: fail("asked"), lambda: fail("at once"))
    assert happened == ["asked", "at once", status]


@pytest.mark.parametrize(("before", "heeded"), [(signal.SIG_DFL, [INT, TERM, HUP]), (signal.SIG_IGN, [INT, TERM])])
def test_a_closed_terminal_asks_unless_nohup_was_there_before(monkeypatch, before, heeded):
    monkeypatch.setattr(signal, "getsignal", lambda _: before)
    assert terminal._heeded() == heeded


@pytest.mark.process
def test_the_second_signal_ends_a_run_whose_main_thread_is_stuck(program, tmp_path):
    path = tmp_path / "mine.py"
    base = "from tutorial.controller import SimpleController\nclass JointStateSubscriber(SimpleController):\n"
    path.write_text(base + IN_C)
    running = program("run", "step3", "--headless", "--controller", path)
    running.says("stuck")
    for number in (TERM, INT):
        assert running.process.poll() is None
        running.process.send_signal(number)
        until(lambda number=number: not pending(running.process.pid, number), "its delivery")
    assert running.ends() == 128 + INT
    running.leaves_nothing()


def pending(pid, number):
    """Whether a process has been sent a signal that it has not got yet; Linux tells."""
    try:
        with open(f"/proc/{pid}/status") as status:  # noqa: PTH123
            masks = [int(line.split()[1], 16) for line in status if line.startswith(("SigPnd", "ShdPnd"))]
    except FileNotFoundError:
        return False
    return any(mask >> (number - 1) & 1 for mask in masks)
