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

import ctypes
import errno
import fcntl
import os
import platform
import resource
import signal
import socket
import struct
import sys
from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path

import msgspec

from tutorial.paths import PACKAGE

__all__ = ["DOMAINS", "Walls", "raise_walls"]

MEMORY = 4 << 30  # bytes of address space a process; MuJoCo and DDS map about 1 GB
FILE_SIZE = 16 << 20  # bytes of one file
FOLDER_SIZE = 64 << 20  # bytes of all files, where there are namespaces
PROCESSES = 256  # with their threads, where there are namespaces
FILES = 256  # open ones
SHARED_MEMORY = Path("/dev/shm")
DOMAINS = "ros-domains"  # in the folder, a link to where programs agree on their domains: see tutorial.ros.domains

_NEW = 0x00020000 | 0x08000000 | 0x10000000 | 0x20000000 | 0x40000000  # mount, IPC, user, PID and network namespace
_NOSUID_NODEV, _REC, _PRIVATE = 0x2 | 0x4, 0x4000, 1 << 18
_AT_FDCWD, _AT_RECURSIVE, _READ_ONLY = -100, 0x8000, 0x1
_PR_SET_PDEATHSIG, _PR_SET_SECCOMP, _PR_SET_CHILD_SUBREAPER, _PR_SET_NO_NEW_PRIVS = 1, 22, 36, 38
_SYS_MOUNT_SETATTR, _SYS_CREATE_RULESET, _SYS_ADD_RULE, _SYS_RESTRICT_SELF = 442, 444, 445, 446
_SIOCGIFFLAGS, _SIOCSIFFLAGS, _IFF_UP = 0x8913, 0x8914, 0x1


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
    _prctl(_PR_SET_PDEATHSIG, signal.SIGKILL)
    _prctl(_PR_SET_CHILD_SUBREAPER, 1)  # what loses its parent stays beneath this process, where it is found
    namespaces = _succeeds(folder)
    if namespaces:
        _enter_namespaces(folder)
        resource.setrlimit(resource.RLIMIT_NPROC, (PROCESSES, PROCESSES))  # counted within: elsewhere it hits others
    _prctl(_PR_SET_NO_NEW_PRIVS, 1)
    return Walls(namespaces, _restrict_files(folder, namespaces), _filter_calls())


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


# --- the system calls that Python has no function for ---

_libc = ctypes.CDLL(None, use_errno=True)


def _checked(result: int) -> int:
    if result < 0:
        number = ctypes.get_errno()
        raise OSError(number, os.strerror(number))
    return result


def _syscall(number: int, *arguments: object) -> int:
    return _checked(_libc.syscall(ctypes.c_long(number), *arguments))


def _prctl(option: int, *arguments: object) -> None:
    unused = [0] * (4 - len(arguments))
    _checked(_libc.prctl(option, *(ctypes.c_ulong(a) if isinstance(a, int) else a for a in [*arguments, *unused])))


def _mount(source: str, target: str, kind: str | None, flags: int, options: str = "") -> None:
    kind_bytes = kind.encode() if kind else None
    _checked(_libc.mount(source.encode(), os.fsencode(target), kind_bytes, ctypes.c_ulong(flags), options.encode()))


# --- namespaces ---


def _succeeds(folder: Path) -> bool:
    """Try in another process whether namespaces can be had: who is refused half-way cannot go back."""
    child = os.fork()
    if child == 0:
        with suppress(OSError):
            _enter_namespaces(folder)
            os._exit(0)
        os._exit(1)
    return os.waitpid(child, 0)[1] == 0


def _enter_namespaces(folder: Path) -> None:
    """Go on in namespaces of its own, as another process, whose end this one waits for and shares.

    Raises:
        OSError: the system refuses.
    """
    user, group = os.getuid(), os.getgid()
    _checked(_libc.unshare(_NEW))
    Path("/proc/self/setgroups").write_text("deny", encoding="ascii")
    Path("/proc/self/uid_map").write_text(f"{user} {user} 1", encoding="ascii")
    Path("/proc/self/gid_map").write_text(f"{group} {group} 1", encoding="ascii")
    _bring_loopback_up()
    _mount("none", "/", None, _REC | _PRIVATE)
    read_only = ctypes.create_string_buffer(struct.pack("QQQQ", _READ_ONLY, 0, 0, 0))
    _syscall(_SYS_MOUNT_SETATTR, _AT_FDCWD, b"/", _AT_RECURSIVE, read_only, ctypes.c_size_t(32))
    for each in (folder, *filter(Path.is_dir, [SHARED_MEMORY])):
        _mount("tmpfs", str(each), "tmpfs", _NOSUID_NODEV, f"size={FOLDER_SIZE},mode=700")
    (folder / DOMAINS).mkdir()
    child = os.fork()
    if child:
        _, status = os.waitpid(child, 0)
        os._exit(os.waitstatus_to_exitcode(status) & 0xFF)
    _prctl(_PR_SET_PDEATHSIG, signal.SIGKILL)
    _mount("proc", "/proc", "proc", _NOSUID_NODEV)
    with suppress(OSError):  # since Linux 6.14, and for root, whom RLIMIT_NPROC does not hold
        Path("/proc/sys/kernel/pid_max").write_text(str(2 * PROCESSES), encoding="ascii")
    os.chdir(folder)


def _bring_loopback_up() -> None:
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as any_socket:
        request = struct.pack("16sh14x", b"lo", 0)
        flags = struct.unpack_from("16sh", fcntl.ioctl(any_socket, _SIOCGIFFLAGS, request))[1]
        fcntl.ioctl(any_socket, _SIOCSIFFLAGS, struct.pack("16sh14x", b"lo", flags | _IFF_UP))


# --- Landlock: see linux/landlock.h ---

_EXECUTE, _WRITE, _READ, _LIST, _TRUNCATE, _DEVICE = 1 << 0, 1 << 1, 1 << 2, 1 << 3, 1 << 14, 1 << 15
_MAKE = 1 << 8  # regular files
_OF_FILES = _EXECUTE | _WRITE | _READ | _TRUNCATE | _DEVICE
_KNOWN = {1: 13, 2: 14, 3: 15, 4: 15}  # by version, how many rights there are; from 5 on
_RIGHTS = 16
_CREATE_RULESET_VERSION = 1
_RULE_PATH_BENEATH = 1
_TCP = 0b11  # bind, connect
_SCOPES = 0b11  # abstract Unix sockets, signals


def _restrict_files(folder: Path, namespaces: bool) -> int:
    """Have Landlock refuse all other files; return its version."""
    try:
        version = _syscall(_SYS_CREATE_RULESET, None, ctypes.c_size_t(0), _CREATE_RULESET_VERSION)
        handled = (1 << _KNOWN.get(version, _RIGHTS)) - 1
        fields = [handled, _TCP, _SCOPES][: 1 + (version >= 4) + (version >= 6)]
        attributes = struct.pack(f"{len(fields)}Q", *fields)
        ruleset = _syscall(_SYS_CREATE_RULESET, attributes, ctypes.c_size_t(len(attributes)), 0)
        for path, rights in _open_to(folder, namespaces):
            _allow(ruleset, path, rights & handled)
        _syscall(_SYS_RESTRICT_SELF, ruleset, 0)
        os.close(ruleset)
    except OSError as error:
        if error.errno in (errno.ENOSYS, errno.EOPNOTSUPP, errno.EPERM):  # not built in, not switched on, filtered
            return 0
        raise
    return version


def _open_to(folder: Path, namespaces: bool) -> Iterator[tuple[str, int]]:
    """Yield what may be opened, and what may be done with it."""
    everything, usual = (1 << _RIGHTS) - 1, _EXECUTE | _READ | _LIST
    yield str(folder), everything
    if (folder / DOMAINS).is_symlink():
        yield str((folder / DOMAINS).resolve()), _READ | _LIST | _WRITE | _MAKE
    if namespaces:
        yield str(SHARED_MEMORY), everything
        yield "/proc", usual
    for general in ("cpuinfo", "filesystems", "meminfo", "stat", "sys"):  # not what is there of other processes
        yield f"/proc/{general}", usual
    yield "/dev/null", _READ | _WRITE
    for device in ("/dev/zero", "/dev/random", "/dev/urandom"):
        yield device, _READ
    for system in ("/usr", "/bin", "/sbin", "/lib", "/lib32", "/lib64", "/etc", "/opt", "/sys"):
        yield system, usual
    yield str(PACKAGE.parent), _LIST  # for the import; what lies beside the package stays closed
    for own in (PACKAGE, PACKAGE.parent / "project", Path(sys.prefix), Path(sys.base_prefix)):
        yield str(own), usual
    named = (os.environ.get(name, "") for name in ("AMENT_PREFIX_PATH", "LD_LIBRARY_PATH"))
    for entry in {*sys.path, *(entry for entries in named for entry in entries.split(os.pathsep))}:
        if entry and Path(entry).resolve() != PACKAGE.parent:
            yield entry, usual


def _allow(ruleset: int, path: str, rights: int) -> None:
    try:
        fd = os.open(path, os.O_PATH | os.O_CLOEXEC)
    except OSError:
        return
    if not Path(path).is_dir():
        rights &= _OF_FILES
    if rights:
        _syscall(_SYS_ADD_RULE, ruleset, _RULE_PATH_BENEATH, struct.pack("=Qi", rights, fd), 0)
    os.close(fd)


# --- seccomp: see linux/seccomp.h, linux/bpf_common.h ---

_FILTER = 2
_LOAD, _EQUAL, _RETURN = 0x20, 0x15, 0x06
_ALLOW, _KILL, _REFUSE = 0x7FFF0000, 0x80000000, 0x00050000 | errno.EPERM
_CALL, _ARCHITECTURE, _FIRST_ARGUMENT = 0, 4, 16  # where they are in what a filter is given
_INTERNET = (socket.AF_INET, socket.AF_INET6, 16)  # 16: netlink, which lists the network's interfaces
_X86_64, _ARM64 = 0xC000003E, 0xC00000B7
_EVERYWHERE = (425, 452, 463, 466, 469)  # io_uring_setup, fchmodat2, setxattrat, removexattrat, file_setattr
_REFUSED = {  # machine: its number, that of socket, and chmod, chown, setxattr and removexattr by path
    "x86_64": (_X86_64, 41, (90, 92, 94, 188, 189, 197, 198, 260, 268)),
    "aarch64": (_ARM64, 198, (5, 6, 14, 15, 53, 54)),
}
_X32 = 0x40000000  # x86-64's calls under other numbers


def _filter_calls() -> bool:
    """Have seccomp refuse what Landlock leaves open; return whether it does."""
    if platform.machine() not in _REFUSED:
        return False
    architecture, socket_call, by_path = _REFUSED[platform.machine()]
    program = [
        (_LOAD, 0, 0, _ARCHITECTURE),
        (_EQUAL, 1, 0, architecture),
        (_RETURN, 0, 0, _KILL),
        (_LOAD, 0, 0, _CALL),
        (0x35, 0, 1, _X32),  # greater or equal
        (_RETURN, 0, 0, _REFUSE),
    ]
    for number in (*by_path, *_EVERYWHERE):
        program += [(_EQUAL, 0, 1, number), (_RETURN, 0, 0, _REFUSE)]
    program += [(_EQUAL, 1, 0, socket_call), (_RETURN, 0, 0, _ALLOW), (_LOAD, 0, 0, _FIRST_ARGUMENT)]
    for family in _INTERNET:
        program += [(_EQUAL, 0, 1, family), (_RETURN, 0, 0, _ALLOW)]
    program += [(_RETURN, 0, 0, _REFUSE)]
    code = ctypes.create_string_buffer(b"".join(struct.pack("HBBI", *each) for each in program))
    with suppress(OSError):
        _prctl(_PR_SET_SECCOMP, _FILTER, struct.pack("HxxxxxxP", len(program), ctypes.addressof(code)))
        return True
    return False
