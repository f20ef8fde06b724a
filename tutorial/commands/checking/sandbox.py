"""The sandbox for processes that run untrusted code. It uses bubblewrap, as Flatpak does.

It contains the files of Python, ROS 2 and the tutorial, read-only; one empty, writable folder of limited size; and a
network with only a loopback interface. When its first process ends, all its other processes are killed. It needs Linux,
the program ``bwrap``, the library libseccomp, and a system that lets ordinary users create namespaces.
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

FOLDER_SIZE = 64 << 20  # maximum total size of the files in a writable folder [bytes]
SYSTEM = ("/usr", "/bin", "/sbin", "/lib", "/lib32", "/lib64", "/etc", "/opt", "/sys")
LIMITS = {
    resource.RLIMIT_AS: 4 << 30,  # bytes of address space per process; MuJoCo and DDS map about 1 GB
    resource.RLIMIT_FSIZE: 16 << 20,  # bytes per file
    resource.RLIMIT_NOFILE: 256,  # open files
    resource.RLIMIT_CORE: 0,
}
PROCESSES = 256  # including threads
# If memory runs out, the kernel kills the sandbox's processes first.
FIRST_TO_GO = 'echo 1000 > /proc/self/oom_score_adj; exec "$@"'
SECCOMP = "libseccomp.so.2"
# The refused calls concern the kernel's keyrings, which namespaces don't isolate; memory that can exist without being
# mapped; and modes of files outside the sandbox, such as /dev/null.
REFUSED = b"add_key request_key keyctl memfd_create shmget chmod fchmod fchmodat fchmodat2".split()
SCMP_ACT_ALLOW, SCMP_ACT_EPERM = 0x7FFF0000, 0x00050001  # from seccomp.h
NO_SANDBOX = (
    "other people's programs cannot run in a sandbox here: {}. On Debian and Ubuntu, sudo apt-get install bubblewrap "
    "libseccomp2 installs the sandbox. If you trust the programs or use a virtual machine, {}."
)


def sandbox(folder: str, file: Path | None = None) -> list[str]:
    """Return the arguments that, put before a command, make it run in a sandbox.

    Args:
        folder: the writable folder. Files written there are invisible outside the sandbox.
        file: another readable file, for a program that communicates with programs outside the sandbox and therefore
            shares their network; or None.
    """
    shared = () if file is None else ("--share-net", "--ro-bind", str(file), str(file))
    readable = [word for path in _readable() for word in ("--ro-bind-try", path, path)]
    shown = COURSE if is_course(PACKAGE.parent) else ()  # empty folders that mark a checkout
    course = [word for part in shown for word in ("--dir", str(PACKAGE.parent / part))]
    writable = ("/dev/shm", folder) if file is None else (folder,)  # Fast DDS must not find memory that it can't share
    bounded = [word for path in writable for word in ("--size", str(FOLDER_SIZE), "--tmpfs", path)]
    closed = [word for path in ("/proc", "/dev", "/") for word in ("--remount-ro", path)]  # root could write there
    return [
        *("sh", "-c", FIRST_TO_GO, "sh", "bwrap", "--as-pid-1"),  # so that the limits apply to every process
        *("--unshare-all", "--unshare-user", "--disable-userns", "--die-with-parent", "--cap-drop", "ALL"),
        *(*readable, *shared, *course, "--proc", "/proc", "--dev", "/dev", *bounded, *closed, "--chdir", folder, "--"),
    ]


def need_sandbox(otherwise: str = "give --no-sandbox") -> None:
    """Check that the sandbox works.

    Args:
        otherwise: the error message's advice on how to proceed without a sandbox.

    Raises:
        TutorialError: the sandbox does not work; the error gives the reason and a fix.
    """
    for what, found in (("the program bwrap", shutil.which("bwrap")), (SECCOMP, find_library("seccomp"))):
        if found is None:
            raise TutorialError(NO_SANDBOX.format(f"{what} is not found", otherwise))
    done = subprocess.run([*sandbox("/tmp"), "true"], capture_output=True, text=True, check=False)
    if done.returncode:
        raise TutorialError(NO_SANDBOX.format(done.stderr.strip() or "bwrap fails", otherwise))


def limit(seconds: int, is_sandboxed: bool) -> None:
    """Limit the resources of this process and its children.

    Args:
        seconds: the CPU time limit per process [s].
        is_sandboxed: whether this process is in a sandbox; if so, also limit the number of processes, and reject some
            system calls.
    """
    processes = {resource.RLIMIT_NPROC: PROCESSES} if is_sandboxed else {}
    for what, most in {**LIMITS, **processes, resource.RLIMIT_CPU: seconds}.items():
        with suppress(ValueError, OSError):  # macOS cannot limit the address space; a lower limit may already be set
            resource.setrlimit(what, (most, most))
    if is_sandboxed:
        _refuse()


def _refuse() -> None:
    """Make the kernel reject certain system calls from this process and its children."""
    library = ctypes.CDLL(SECCOMP)
    library.seccomp_init.restype = ctypes.c_void_p
    rules = ctypes.c_void_p(library.seccomp_init(SCMP_ACT_ALLOW))
    for call in REFUSED:
        library.seccomp_rule_add(rules, SCMP_ACT_EPERM, library.seccomp_syscall_resolve_name(call), 0)
    if library.seccomp_load(rules):
        raise OSError("the kernel does not accept the system call filter")


def _readable() -> Iterator[str]:
    """Yield the paths that are readable in the sandbox."""
    yield from SYSTEM
    named = (os.environ.get(name, "") for name in ("PYTHONPATH", "AMENT_PREFIX_PATH", "LD_LIBRARY_PATH"))
    entries = [*sys.path, *(entry for entries in named for entry in entries.split(os.pathsep))]
    known = {os.path.abspath(entry) for entry in entries if entry}  # noqa: PTH100 - keep a link's own name
    yield from sorted(known - {str(PACKAGE.parent), str(Path.cwd())})  # except for the course and the current folder
    for own in (sys.prefix, sys.base_prefix, PACKAGE, PACKAGE.parent / "project"):
        yield str(own)
