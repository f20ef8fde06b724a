"""The tutorial's programs that run on this machine, those that were left behind, and the ports of the 3D view."""

from __future__ import annotations

import os
import sys
import time
from collections.abc import Iterable, Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass
from importlib import import_module
from pathlib import Path
from typing import Any

from tutorial.commands.doctor.finding import Finding

__all__ = ["Listener", "Process", "listeners", "ports", "processes", "running", "title"]

FIRST_PORT, PORTS = 7000, 100  # as tutorial.view.web has them
LONGEST_TITLE = 60
HERE = ("127.0.0.1", "0.0.0.0", "::", "::ffff:127.0.0.1")
INIT = ("systemd", "init", "launchd")


@dataclass(frozen=True)
class Process:
    """A running process.

    Attributes:
        pid: its number.
        user: whose it is.
        is_mine: whether it belongs to the user who asks.
        is_orphan: whether what started it is gone.
        age: how long it has run [s].
        command: its command line.
    """

    pid: int
    user: str
    is_mine: bool
    is_orphan: bool
    age: float
    command: tuple[str, ...]


@dataclass(frozen=True)
class Listener:
    """A port on which somebody listens.

    Attributes:
        port: its number.
        pid: of the process; None for one of another user, whose processes the system does not show.
        name: what that is.
    """

    port: int
    pid: int | None
    name: str


def processes(found: Iterable[Process]) -> Iterator[Finding]:
    """Say which of the tutorial's programs run: an orphan of one's own is a problem, any other is as it should be.

    Args:
        found: all processes of this machine.
    """
    ours = [(process, name) for process in found if (name := title(process.command)) is not None]
    others = len([process for process, _ in ours if not process.is_mine and not process.is_orphan])
    for process, name in ours:
        text = f"{name}: pid {process.pid}, for {_span(process.age)}"
        if process.is_orphan and process.is_mine:
            yield Finding("processes", "problem", f"{text}; what started it is gone", f"kill {process.pid}")
        elif process.is_orphan:
            text = f"{text}, of {process.user}; what started it is gone"
            yield Finding("processes", "note", text, f"ask {process.user} to: kill {process.pid}")
        elif process.is_mine:
            yield Finding("processes", "ok", text)
    if others:
        yield Finding("processes", "ok", f"{others} of the tutorial's belong to other users")
    if not ours:
        yield Finding("processes", "ok", "none of the tutorial's runs, none is left over")


def ports(taken: Iterable[Listener]) -> Iterator[Finding]:
    """Say which ports of the 3D view are in use, and by whom.

    Args:
        taken: where somebody listens.
    """
    inside = sorted((each for each in taken if 0 <= each.port - FIRST_PORT < PORTS), key=lambda each: each.port)
    used = {each.port for each in inside}
    free = next((port for port in range(FIRST_PORT, FIRST_PORT + PORTS) if port not in used), None)
    for each in inside:
        owner = f"{each.name}, pid {each.pid}" if each.pid is not None else "a process of another user"
        yield Finding("ports", "ok", f"{each.port} is taken by {owner}")
    if free is None:
        text = f"all from {FIRST_PORT} to {FIRST_PORT + PORTS - 1} are taken: the 3D view has none by itself"
        yield Finding("ports", "problem", text, "end what is not needed, or tank run --port 8123")
    else:
        yield Finding("ports", "ok", f"the next 3D view of tank run is on {free}")


def title(command: Sequence[str]) -> str | None:
    """Say which of the tutorial's programs a command line is, for instance ``"tank run step2"``; None for others."""
    words = _without_python(command)
    if len(words) < 2:
        return None
    first, *rest = words
    if first.endswith("tutorial/commands/lifeline.py"):
        return _shortened("lifeline of", Path((*rest, "")[1]).name, *rest[2:])
    if first == "-m" and rest[0] == "tutorial.checks._child":
        return "the check of an exercise"
    if first == "-m" and rest[0] == "ipykernel_launcher" and Path(command[0]).parent == Path(sys.executable).parent:
        return "a notebook's kernel"
    if first == "-m" and rest[0] == "tutorial.commands.lab_server" and any("0_setup.ipynb" in word for word in rest):
        return "tank lab"
    if first == "-m" and rest[0] == "tutorial":
        first, *rest = "tank", *rest[1:]
    is_tank = Path(first).name == "tank" and rest and not rest[0].startswith("-") and rest[0] != "doctor"
    return _shortened("tank", *rest) if is_tank else None


def running() -> list[Process]:
    """Look at all processes of this machine that can be looked at."""
    psutil = _psutil()
    found = []
    for process in psutil.process_iter():
        with suppress(psutil.Error), process.oneshot():  # it has ended, or may not be looked at
            found.append(_seen(process))
    return found


def listeners() -> list[Listener]:
    """Look at all ports of this machine on which somebody listens for connections.

    Where only root may ask for all of them, they are those of the processes that may be asked.
    """
    psutil = _psutil()
    try:
        connections = [(each, each.pid) for each in psutil.net_connections("tcp")]
    except psutil.AccessDenied:
        connections = list(_connections_one_by_one())
    listening = [(each.laddr, pid) for each, pid in connections if each.status == psutil.CONN_LISTEN]
    pids = {address.port: pid for address, pid in listening if address.ip in HERE}
    return [Listener(port, pid, _name(pid)) for port, pid in pids.items()]


def is_orphan(parent: int, name: str, terminal: str | None) -> bool:
    """Whether a process has been handed on to the process that collects orphans.

    Args:
        parent: the number of its parent.
        name: of its parent.
        terminal: of its parent. A shell that is a container's first process has one, and its children are no orphans.
    """
    return (parent == 1 or name in INIT) and terminal is None


def _connections_one_by_one() -> Iterator[tuple[Any, int]]:
    psutil = _psutil()
    for process in psutil.process_iter():
        with suppress(psutil.Error):
            yield from ((connection, process.pid) for connection in process.net_connections("tcp"))


def _seen(process: Any) -> Process:
    """Take down what is of interest about a process. Where its parent is not shown, its number still is."""
    parent = process.parent()
    return Process(
        process.pid,
        process.username(),
        process.uids().real == os.getuid(),
        is_orphan(parent.pid, parent.name(), parent.terminal()) if parent is not None else process.ppid() == 1,
        time.time() - process.create_time(),
        tuple(process.cmdline()),
    )


def _name(pid: int | None) -> str:
    """What a process is called: as one of the tutorial's, or as the system has it."""
    if pid is None:
        return ""
    psutil = _psutil()
    try:
        process = psutil.Process(pid)
        return title(process.cmdline()) or _shortened(process.name())
    except psutil.Error:
        return "a process that may not be looked at"


def _without_python(command: Sequence[str]) -> list[str]:
    """Leave out the interpreter and its options."""
    words = list(command)
    if words and Path(words[0]).name.lower().startswith("python"):
        del words[0]
        while words and words[0].startswith("-") and words[0] != "-m":
            del words[: 2 if words[0] in ("-X", "-W") else 1]
    return words


def _psutil() -> Any:
    """Import it only now: where it is missing, everything else can still be looked at."""
    return import_module("psutil")


def _shortened(*words: str) -> str:
    """Put words on a line, whatever characters somebody else's process has in its name."""
    text = "".join(letter if letter.isascii() and letter.isprintable() else "?" for letter in " ".join(words))
    return text if len(text) <= LONGEST_TITLE else f"{text[: LONGEST_TITLE - 3]}..."


def _span(seconds: float) -> str:
    """Say how long, in the unit that fits."""
    for size, unit in ((86400, "days"), (3600, "h"), (60, "min")):
        if seconds >= 2 * size:
            return f"{seconds / size:.0f} {unit}"
    return f"{seconds:.0f} s"
