"""The walls around a process that runs a stranger's code: what it may use, read, write and reach.

All of them are the kernel's, none needs root, and each stands by itself where another is missing:

- *limits* of memory, time and file size hold on every system;
- *namespaces* (Linux, where unprivileged users may make them): a network that has only its own loopback, processes
  that all end with the first, and a file system that is read-only but for one folder of a bounded size;
- *Landlock* (Linux 5.13; whole from 6.2): of the files only those can be opened that Python, ROS 2 and the tutorial
  consist of, and only the folder can be written to; from 6.7 no TCP;
- *seccomp* (Linux on x86-64 and ARM64): no sockets of the system's services, and nobody's permissions are changed,
  which Landlock leaves open.

They are raised once and cannot be taken down. It has to be done while the process has one thread only.
"""

from __future__ import annotations

import resource
import signal
import sys
from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path

import msgspec

from tutorial.commands.checking.landlock import restrict_files
from tutorial.commands.checking.namespaces import PROCESSES, enter_namespaces, may_enter_namespaces
from tutorial.commands.checking.seccomp import filter_calls
from tutorial.commands.checking.system_calls import (
    PR_SET_CHILD_SUBREAPER,
    PR_SET_NO_NEW_PRIVS,
    PR_SET_PDEATHSIG,
    drop_capabilities,
    prctl,
)

__all__ = ["Walls", "raise_walls"]

MEMORY = 4 << 30  # bytes of address space a process; MuJoCo and DDS map about 1 GB
FILE_SIZE = 16 << 20  # bytes of one file
FILES = 256  # open ones


class Walls(msgspec.Struct, frozen=True):
    """Which walls stand.

    Attributes:
        namespaces: whether it has its own.
        landlock: the version of Landlock that holds it; 0 for none.
        seccomp: whether its system calls are filtered.
    """

    namespaces: bool = False
    landlock: int = 0
    seccomp: bool = False

    def sentences(self) -> Iterator[str]:
        """Say what of the teacher's an answer could reach, and what not."""
        if self.namespaces or (self.landlock >= 3 and self.seccomp):
            yield "Files: an answer could write to nothing but a temporary folder."
        else:
            yield "Files: an answer COULD CHANGE yours."
        if self.landlock:
            yield "Reading: it could open only the files that Python, ROS 2 and the tutorial consist of."
        else:
            yield "Reading: it COULD READ your files."
        if self.namespaces:
            yield "Network: it could reach nothing, not even programs on this machine."
        elif self.landlock >= 4:
            yield "Network: it could make no TCP connection, but it COULD SEND UDP."
        else:
            yield "Network: it COULD REACH it."
        if not self.namespaces:
            yield "Processes: what it has started MAY STILL RUN, if it took pains to hide it."


def raise_walls(folder: Path, seconds: int) -> Walls:
    """Confine this process, and all that will come from it, as far as this system can. The process may be another then.

    Args:
        folder: the one that can be written to.
        seconds: of processor time that each process may take [s].

    Returns:
        What stands.
    """
    _limit(seconds)
    if sys.platform != "linux":
        return Walls()
    prctl(PR_SET_PDEATHSIG, signal.SIGKILL)
    prctl(PR_SET_CHILD_SUBREAPER, 1)  # what loses its parent stays beneath this process, where it is found
    namespaces = may_enter_namespaces(folder)
    if namespaces:
        enter_namespaces(folder)
        resource.setrlimit(resource.RLIMIT_NPROC, (PROCESSES, PROCESSES))  # counted within: elsewhere it hits others
    drop_capabilities()
    prctl(PR_SET_NO_NEW_PRIVS, 1)
    return Walls(namespaces, restrict_files(folder, namespaces), filter_calls())


def _limit(seconds: int) -> None:
    for what, most in (
        (resource.RLIMIT_AS, MEMORY),
        (resource.RLIMIT_CPU, seconds),
        (resource.RLIMIT_FSIZE, FILE_SIZE),
        (resource.RLIMIT_NOFILE, FILES),
        (resource.RLIMIT_CORE, 0),
    ):
        with suppress(ValueError, OSError):  # macOS knows no limit of address space; a lower one may hold already
            resource.setrlimit(what, (most, most))
