"""A command beside the kernel: what it says, and that it ends."""

from __future__ import annotations

import asyncio
import shlex
import signal
import sys

import psutil
import pytest
from programs import until as wait_until

from tutorial.errors import TutorialError
from tutorial.notebook.command import Command

PYTHON = shlex.quote(sys.executable)


def python(code):
    return Command(f"{PYTHON} -u -c {shlex.quote(code)}")


def test_it_says_and_ends():
    async def scenario():
        command = python("print('hello'); import sys; print('there', file=sys.stderr); sys.exit(3)")
        await command.says("there")
        assert await command.ends() == 3
        assert command.output == "hello\nthere\n"
        command.close()
        command.close()

    asyncio.run(scenario())


def test_what_it_never_says_is_an_error_with_what_it_did_say():
    async def scenario():
        command = python("print('something else')")
        with pytest.raises(TutorialError, match=r"has ended with status 0\. It said:\nsomething else"):
            await command.says("hello")
        command.close()

    asyncio.run(scenario())


def test_closing_asks_it_to_stop():
    async def scenario():
        command = python(
            "import time\ntry:\n    print('up')\n    while True:\n        time.sleep(0.1)\n"
            "except KeyboardInterrupt:\n    print('asked')"
        )
        await command.says("up")
        command.close()
        assert command.output == "up\nasked\n"
        assert command.status == 0

    asyncio.run(scenario())


def test_one_that_does_not_stop_is_killed(monkeypatch):
    monkeypatch.setattr("tutorial.notebook.command.PATIENCE", 0.5)

    async def scenario():
        ignoring = "import signal; signal.signal(signal.SIGINT, signal.SIG_IGN)"
        command = python(f"{ignoring}\nimport os, time; print(os.getpid(), 'up'); time.sleep(600)")
        await command.says("up")
        pid = int(command.output.split()[0])
        command.close()
        wait_until(lambda: not psutil.pid_exists(pid), "its end")

    asyncio.run(scenario())


def test_one_whose_lifeline_is_killed_is_killed():
    async def scenario():
        command = python("import os, time; print(os.getpid(), 'up'); time.sleep(600)")
        await command.says("up")
        pid = int(command.output.split()[0])
        psutil.Process(pid).parent().kill()
        assert await command.ends() == -signal.SIGKILL
        wait_until(lambda: not psutil.pid_exists(pid), "its end")
        command.close()

    asyncio.run(scenario())


def test_tank_is_found_without_activating_anything(monkeypatch):
    monkeypatch.setenv("PATH", "/usr/bin:/bin")

    async def scenario():
        command = Command("tank --version")
        await command.says("tank, version")
        assert await command.ends() == 0

    asyncio.run(scenario())


@pytest.mark.parametrize("line", ["tnak joy", ""])
def test_a_command_that_there_is_not(line):
    with pytest.raises(TutorialError, match="there is no command"):
        Command(line)


def test_its_text_is_what_was_typed():
    command = Command("tank --version")
    assert repr(command) == "Command('tank --version')"
    command.close()
