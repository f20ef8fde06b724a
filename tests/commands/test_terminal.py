"""How commands end: the first Ctrl-C or SIGTERM asks, the second ends all at once, whatever the main thread does."""

import io
import logging
import os
import signal
import sys

import pytest

from tutorial.commands import terminal
from tutorial.commands.terminal import prepare_output
from tutorial.system.printing import say

INT, TERM, HUP = signal.SIGINT, signal.SIGTERM, signal.SIGHUP
STUCK = """import mujoco
from tutorial.controller import SimpleController
class JointStateSubscriber(SimpleController):
    def configure(self, config):
        model = mujoco.MjModel.from_xml_string('<mujoco/>')
        print('stuck', flush=True)
        mujoco.mj_step(model, mujoco.MjData(model), nstep=2**31 - 1)
"""
"""In C."""


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
    path.write_text(STUCK)
    running = program("run", "step3", "--headless", "--controller", path)
    running.says("stuck")
    for number in (TERM, INT):
        running.process.send_signal(number)
    assert running.ends() in (128 + INT, 128 + TERM)  # whichever is heard last
    running.leaves_nothing()
