"""The sandbox around a process that runs a stranger's code: bubblewrap's, as Flatpak's are.

In it are the files that Python, ROS 2 and the tutorial consist of, to be read; one empty folder of a bounded size, to
be written to; a network that has only its own loopback; and processes that all end with the first. It needs Linux, the
program ``bwrap``, and a system that lets ordinary users make namespaces.
"""

from __future__ import annotations

import os
import resource
import shutil
import subprocess
import sys
from collections.abc import Iterator
from contextlib import suppress
from functools import cache

from tutorial.errors import TutorialError
from tutorial.paths import COURSE, PACKAGE, is_course

__all__ = ["limit", "need_sandbox", "sandbox"]

FOLDER_SIZE = 64 << 20  # bytes of all files
SYSTEM = ("/usr", "/bin", "/sbin", "/lib", "/lib32", "/lib64", "/etc", "/opt", "/sys")
LIMITS = {
    resource.RLIMIT_AS: 4 << 30,  # bytes of address space a process; MuJoCo and DDS map about 1 GB
    resource.RLIMIT_FSIZE: 16 << 20,  # bytes of one file
    resource.RLIMIT_NOFILE: 256,  # open files
    resource.RLIMIT_CORE: 0,
}
PROCESSES = 256  # with their threads
NO_SANDBOX = (
    "an answer is a stranger's program, and there is no sandbox for it here: {}. On Debian and Ubuntu, sudo apt-get "
    "install bubblewrap brings one. Where you trust the answers, or in a virtual machine, give --no-sandbox."
)


def sandbox(folder: str) -> list[str]:
    """Return the words that run a command in a sandbox, when they stand before it.

    Args:
        folder: the one that can be written to; what is written there is seen by nobody outside.
    """
    readable = [word for path in _readable() for word in ("--ro-bind-try", path, path)]
    course = [word for path in _course() for word in ("--dir", path)]
    bounded = [word for path in ("/dev/shm", folder) for word in ("--size", str(FOLDER_SIZE), "--tmpfs", path)]
    closed = [word for path in ("/proc", "/dev", "/") for word in ("--remount-ro", path)]  # root could set the kernel's
    return [
        *_keyring(),
        *("bwrap", "--unshare-all", "--unshare-user", "--disable-userns", "--die-with-parent", "--cap-drop", "ALL"),
        *(*readable, *course, "--proc", "/proc", "--dev", "/dev", *bounded, *closed, "--chdir", folder, "--"),
    ]


def need_sandbox() -> None:
    """Check that there is a sandbox.

    Raises:
        TutorialError: there is none; the text says why, and the mend.
    """
    if shutil.which("bwrap") is None:
        raise TutorialError(NO_SANDBOX.format("the program bwrap is not found"))
    done = subprocess.run([*sandbox("/tmp"), "true"], capture_output=True, text=True, check=False)
    if done.returncode:
        raise TutorialError(NO_SANDBOX.format(done.stderr.strip() or "bwrap fails"))


def limit(seconds: int, is_sandboxed: bool) -> None:
    """Bound what this process, and all that will come from it, may use.

    Args:
        seconds: of processor time that each process may take [s].
        is_sandboxed: whether processes are counted in the sandbox alone.
    """
    processes = {resource.RLIMIT_NPROC: PROCESSES} if is_sandboxed else {}
    for what, most in {**LIMITS, **processes, resource.RLIMIT_CPU: seconds}.items():
        with suppress(ValueError, OSError):  # macOS knows no limit of address space; a lower one may hold already
            resource.setrlimit(what, (most, most))


@cache
def _keyring() -> tuple[str, ...]:
    """Return the words that give a command a session keyring of its own, where that can be: bubblewrap leaves mine."""
    words = ("keyctl", "session", "-")
    works = (
        shutil.which("keyctl") and subprocess.run([*words, "true"], capture_output=True, check=False).returncode == 0
    )
    return words if works else ()


def _readable() -> Iterator[str]:
    """Yield what can be read in the sandbox."""
    yield from SYSTEM
    named = (os.environ.get(name, "") for name in ("PYTHONPATH", "AMENT_PREFIX_PATH", "LD_LIBRARY_PATH"))
    entries = {*sys.path, *(entry for entries in named for entry in entries.split(os.pathsep))} - {""}
    for entry in sorted(entries - {str(PACKAGE.parent)}):  # what lies beside the package stays closed
        yield os.path.abspath(entry)  # noqa: PTH100 - where a link leads is not its name
    for own in (sys.prefix, sys.base_prefix, PACKAGE, PACKAGE.parent / "project"):
        yield str(own)


def _course() -> Iterator[str]:
    """Yield the folders by which a checkout is known for one; what is in them stays closed, but for the project."""
    if is_course(PACKAGE.parent):
        yield from (str(PACKAGE.parent / part) for part in COURSE)
