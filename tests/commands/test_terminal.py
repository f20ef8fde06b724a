"""How commands end: the first Ctrl-C or SIGTERM asks them to stop; the second kills them at once, even if they hang."""

import io
import logging
import os
import signal
import sys

import pytest

from tutorial.commands import terminal
from tutorial.commands.terminal import prepare_output
from tutorial.system.printing import print_text

INT, TERM, HUP = signal.SIGINT, signal.SIGTERM, signal.SIGHUP
STUCK = """import mujoco
from tutorial.controller import SimpleController
class JointStateSubscriber(SimpleController):
    def configure(self, config):
        model = mujoco.MjModel.from_xml_string('<mujoco/>')
        print('stuck', flush=True)
        mujoco.mj_step(model, mujoco.MjData(model), nstep=2**31 - 1)
"""
"""Blocks in C code."""


def test_unsupported_characters_are_escaped(monkeypatch):
    written = io.BytesIO()
    monkeypatch.setattr(sys, "stdout", io.TextIOWrapper(written, "latin-1"))
    prepare_output()
    print_text("戦車 é\x1b\n")
    assert written.getvalue() == b"\\u6226\\u8eca \xe9\\x1b\n"


def test_a_log_line_is_escaped_like_all_output(capsys, monkeypatch):
    monkeypatch.setattr(logging.root, "handlers", [])
    monkeypatch.setattr(logging.root, "level", logging.root.level)
    prepare_output()
    logging.getLogger("x").warning("%s", "a\x1b[2J\u202e")
    logging.getLogger("x").info("as well")
    logging.getLogger("OpenGL").info("what it does without, which nobody asked for")
    assert capsys.readouterr().err == "[WARNING] a\\x1b[2J\\u202e\n[INFO] as well\n"


@pytest.mark.parametrize(("heard", "status"), [([9, INT, TERM], 143), ([TERM, 9, INT], 130)])
def test_the_first_signal_asks_and_the_second_ends(monkeypatch, heard, status):
    happened = []

    def fail(what):
        happened.append(what)
        raise RuntimeError(what)

    monkeypatch.setattr(os, "_exit", happened.append)
    with pytest.raises(RuntimeError, match="at once"):
        terminal._end(iter(heard).__next__, lambda: fail("asked"), lambda: fail("at once"))
    assert happened == ["asked", "at once", status]


@pytest.mark.parametrize(("before", "heeded"), [(signal.SIG_DFL, [INT, TERM, HUP]), (signal.SIG_IGN, [INT, TERM])])
def test_a_closed_terminal_asks_unless_nohup_is_set(monkeypatch, before, heeded):
    monkeypatch.setattr(signal, "getsignal", lambda _: before)
    assert terminal._heeded() == heeded


@pytest.mark.process
def test_a_second_signal_ends_a_stuck_run(program, tmp_path):
    path = tmp_path / "mine.py"
    path.write_text(STUCK)
    running = program("run", "step3", "--headless", "--controller", path)
    running.says("stuck")
    for number in (TERM, INT):
        running.process.send_signal(number)
    assert running.ends() in (128 + INT, 128 + TERM)  # whichever arrives last
    running.leaves_nothing()
