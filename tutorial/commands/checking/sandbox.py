"""The sandbox around a process that runs a stranger's code: bubblewrap's, as Flatpak's are.

In it are the files that Python, ROS 2 and the tutorial consist of, to be read; one empty folder of a bounded size, to
be written to; a network that has only its own loopback; and processes that all end with the first. It needs Linux, the
program ``bwrap``, the library libseccomp, and a system that lets ordinary users make namespaces.
"""

import ctypes
import os
import resource
import shutil
import subprocess
import sys
from collections.abc import Iterator
from contextlib import suppress
from ctypes.util import find_library
from pathlib import Path

from tutorial.errors import TutorialError
from tutorial.system.paths import COURSE, PACKAGE, is_course

FOLDER_SIZE = 64 << 20  # bytes of all files
SYSTEM = ("/usr", "/bin", "/sbin", "/lib", "/lib32", "/lib64", "/etc", "/opt", "/sys")
LIMITS = {
    resource.RLIMIT_AS: 4 << 30,  # bytes of address space a process; MuJoCo and DDS map about 1 GB
    resource.RLIMIT_FSIZE: 16 << 20,  # bytes of one file
    resource.RLIMIT_NOFILE: 256,  # open files
    resource.RLIMIT_CORE: 0,
}
PROCESSES = 256  # with their threads
FIRST_TO_GO = 'echo 1000 > /proc/self/oom_score_adj; exec "$@"'  # where memory runs out, the kernel ends these first
SECCOMP = "libseccomp.so.2"
# The calls that are refused: on keys, which namespaces don't part; for memory that no process need have mapped; and on
# the mode of what is not the sandbox's alone, such as /dev/null.
REFUSED = b"add_key request_key keyctl memfd_create shmget chmod fchmod fchmodat fchmodat2".split()
SCMP_ACT_ALLOW, SCMP_ACT_EPERM = 0x7FFF0000, 0x00050001  # of its seccomp.h
NO_SANDBOX = (
    "an answer is a stranger's program, and there is no sandbox for it here: {}. On Debian and Ubuntu, sudo apt-get "
    "install bubblewrap libseccomp2 installs one. If you trust the answers, or in a virtual machine, give --no-sandbox."
)


def sandbox(folder: str) -> list[str]:
    """Return the words that run a command in a sandbox, when they stand before it.

    Args:
        folder: the one that can be written to; what is written there is seen by nobody outside.
    """
    readable = [word for path in _readable() for word in ("--ro-bind-try", path, path)]
    shown = COURSE if is_course(PACKAGE.parent) else ()  # it is known for a checkout by them, and they stay closed
    course = [word for part in shown for word in ("--dir", str(PACKAGE.parent / part))]
    bounded = [word for path in ("/dev/shm", folder) for word in ("--size", str(FOLDER_SIZE), "--tmpfs", path)]
    closed = [word for path in ("/proc", "/dev", "/") for word in ("--remount-ro", path)]  # root could set the kernel's
    return [
        *("sh", "-c", FIRST_TO_GO, "sh", "bwrap", "--as-pid-1"),  # so no process in it lacks the limits
        *("--unshare-all", "--unshare-user", "--disable-userns", "--die-with-parent", "--cap-drop", "ALL"),
        *(*readable, *course, "--proc", "/proc", "--dev", "/dev", *bounded, *closed, "--chdir", folder, "--"),
    ]


def need_sandbox() -> None:
    """Check that there is a sandbox.

    Raises:
        TutorialError: there is none; the text says why, and the mend.
    """
    for what, found in (("the program bwrap", shutil.which("bwrap")), (SECCOMP, find_library("seccomp"))):
        if found is None:
            raise TutorialError(NO_SANDBOX.format(f"{what} is not found"))
    done = subprocess.run([*sandbox("/tmp"), "true"], capture_output=True, text=True, check=False)
    if done.returncode:
        raise TutorialError(NO_SANDBOX.format(done.stderr.strip() or "bwrap fails"))


def limit(seconds: int, is_sandboxed: bool) -> None:
    """Bound what this process, and all that will come from it, may use.

    Args:
        seconds: of processor time that each process may take [s].
        is_sandboxed: whether processes are counted in the sandbox alone, and some calls are refused.
    """
    processes = {resource.RLIMIT_NPROC: PROCESSES} if is_sandboxed else {}
    for what, most in {**LIMITS, **processes, resource.RLIMIT_CPU: seconds}.items():
        with suppress(ValueError, OSError):  # macOS knows no limit of address space; a lower one may hold already
            resource.setrlimit(what, (most, most))
    if is_sandboxed:
        _refuse()


def _refuse() -> None:
    """Have the kernel refuse this process, and all that will come from it, some calls."""
    library = ctypes.CDLL(SECCOMP)
    library.seccomp_init.restype = ctypes.c_void_p
    rules = ctypes.c_void_p(library.seccomp_init(SCMP_ACT_ALLOW))
    for call in REFUSED:
        library.seccomp_rule_add(rules, SCMP_ACT_EPERM, library.seccomp_syscall_resolve_name(call), 0)
    if library.seccomp_load(rules):
        raise OSError("the kernel takes no filter of calls")


def _readable() -> Iterator[str]:
    """Yield what can be read in the sandbox."""
    yield from SYSTEM
    named = (os.environ.get(name, "") for name in ("PYTHONPATH", "AMENT_PREFIX_PATH", "LD_LIBRARY_PATH"))
    entries = [*sys.path, *(entry for entries in named for entry in entries.split(os.pathsep))]
    known = {os.path.abspath(entry) for entry in entries if entry}  # noqa: PTH100 - where a link leads is not its name
    yield from sorted(known - {str(PACKAGE.parent), str(Path.cwd())})  # what is beside the package, or here, is closed
    for own in (sys.prefix, sys.base_prefix, PACKAGE, PACKAGE.parent / "project"):
        yield str(own)
