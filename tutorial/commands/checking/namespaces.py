"""Namespaces: a file system that is read-only but for one folder, a network of its own, processes that end together.

They are what containers are made of. Some systems keep ordinary users from making them.
"""

from __future__ import annotations

import ctypes
import fcntl
import os
import signal
import socket
import struct
from contextlib import suppress
from pathlib import Path

from tutorial.commands.checking.system_calls import PR_SET_PDEATHSIG, mount, prctl, syscall, unshare

__all__ = ["DOMAINS", "PROCESSES", "SHARED_MEMORY", "enter_namespaces", "may_enter_namespaces"]

FOLDER_SIZE = 64 << 20  # bytes of all files
PROCESSES = 256  # with their threads
SHARED_MEMORY = Path("/dev/shm")
DOMAINS = "ros-domains"  # in the folder, where programs agree on their domains: see tutorial.ros.domains

_NEW = 0x00020000 | 0x08000000 | 0x10000000 | 0x20000000 | 0x40000000  # mount, IPC, user, PID and network namespace
_NOSUID_NODEV, _REC, _PRIVATE = 0x2 | 0x4, 0x4000, 1 << 18
_SYS_MOUNT_SETATTR = 442
_AT_FDCWD, _AT_RECURSIVE, _READ_ONLY = -100, 0x8000, 0x1
_SIOCGIFFLAGS, _SIOCSIFFLAGS, _IFF_UP = 0x8913, 0x8914, 0x1


def may_enter_namespaces(folder: Path) -> bool:
    """Try in another process whether namespaces can be had: who is refused half-way cannot go back."""
    child = os.fork()
    if child == 0:
        with suppress(OSError):
            enter_namespaces(folder)
            os._exit(0)
        os._exit(1)
    return os.waitpid(child, 0)[1] == 0


def enter_namespaces(folder: Path) -> None:
    """Go on in namespaces of its own, as another process, whose end this one waits for and shares.

    Raises:
        OSError: the system refuses.
    """
    user, group = os.getuid(), os.getgid()
    unshare(_NEW)
    Path("/proc/self/setgroups").write_text("deny", encoding="ascii")
    Path("/proc/self/uid_map").write_text(f"{user} {user} 1", encoding="ascii")
    Path("/proc/self/gid_map").write_text(f"{group} {group} 1", encoding="ascii")
    _bring_loopback_up()
    mount("none", "/", None, _REC | _PRIVATE)
    read_only = ctypes.create_string_buffer(struct.pack("QQQQ", _READ_ONLY, 0, 0, 0))
    syscall(_SYS_MOUNT_SETATTR, _AT_FDCWD, b"/", _AT_RECURSIVE, read_only, ctypes.c_size_t(32))
    for each in (folder, *filter(Path.is_dir, [SHARED_MEMORY])):
        mount("tmpfs", str(each), "tmpfs", _NOSUID_NODEV, f"size={FOLDER_SIZE},mode=700")
    (folder / DOMAINS).mkdir()
    child = os.fork()
    if child:
        _, status = os.waitpid(child, 0)
        os._exit(os.waitstatus_to_exitcode(status) & 0xFF)
    prctl(PR_SET_PDEATHSIG, signal.SIGKILL)
    mount("proc", "/proc", "proc", _NOSUID_NODEV)
    Path("/proc/sys/user/max_user_namespaces").write_text("0", encoding="ascii")  # in another one it would be root
    with suppress(OSError):  # since Linux 6.14, and for root, whom RLIMIT_NPROC does not hold
        Path("/proc/sys/kernel/pid_max").write_text(str(2 * PROCESSES), encoding="ascii")
    os.chdir(folder)


def _bring_loopback_up() -> None:
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as any_socket:
        request = struct.pack("16sh14x", b"lo", 0)
        flags = struct.unpack_from("16sh", fcntl.ioctl(any_socket, _SIOCGIFFLAGS, request))[1]
        fcntl.ioctl(any_socket, _SIOCSIFFLAGS, struct.pack("16sh14x", b"lo", flags | _IFF_UP))
