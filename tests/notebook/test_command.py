"""A command beside the kernel: its output and its end."""

import shlex
import sys

import psutil
import pytest

from tutorial.errors import TutorialError
from tutorial.notebook import start_command, until

pytestmark = pytest.mark.process

SLEEPS = "import os, time; print(os.getpid(), 'up'); time.sleep(600)"


def python(code):
    return start_command(f"{shlex.quote(sys.executable)} -c {shlex.quote(code)}")


async def process_of(command):
    """Return a command's process, once it has printed its number."""
    await command.says("up")
    return int(command.output.split()[0])


async def test_it_prints_and_ends():
    command = python("print('hello'); import sys; print('there', file=sys.stderr); sys.exit(3)")
    await command.says("there")
    assert await command.ends() == 3
    assert command.output == "hello\nthere\n"
    command.close()
    command.close()
    command = python("print('something else')")
    with pytest.raises(TutorialError, match=r"ended with status 0\. It printed:\nsomething else"):
        await command.says("hello")


async def test_closing_asks_it_to_stop():
    command = python(
        "import time\ntry:\n    print('up')\n    while True:\n        time.sleep(0.1)\n"
        "except KeyboardInterrupt:\n    print('asked')"
    )
    await command.says("up")
    command.close()
    assert command.output == "up\nasked\n"
    assert command.status == 0


async def test_one_that_does_not_stop_is_killed(monkeypatch):
    monkeypatch.setattr("tutorial.notebook.command.TIMEOUT", 0.5)
    command = python(f"import signal; signal.signal(signal.SIGINT, signal.SIG_IGN)\n{SLEEPS}")
    pid = await process_of(command)
    command.close()
    await until(lambda: not psutil.pid_exists(pid))


async def test_tank_is_found_without_activating_an_environment(monkeypatch):
    monkeypatch.setenv("PATH", "/usr/bin:/bin")
    command = start_command("tank --version")
    assert repr(command) == "Command('tank --version')"
    await command.says("tank, version")
    assert await command.ends() == 0


@pytest.mark.parametrize("line", ["tnak joy", ""])
def test_an_unknown_command_is_refused(line):
    with pytest.raises(TutorialError, match="there is no command"):
        start_command(line)
