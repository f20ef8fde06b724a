"""seccomp: the calls are refused that Landlock leaves open, and that lead out of it.

A socket of the system's or the session's services, such as D-Bus, would have them do what one may not do oneself; and
the permissions of files can be changed without opening them. See linux/seccomp.h and linux/bpf_common.h.
"""

from __future__ import annotations

import ctypes
import errno
import platform
import socket
import struct
from contextlib import suppress

from tutorial.commands.checking.system_calls import PR_SET_SECCOMP, prctl

__all__ = ["filter_calls"]

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


def filter_calls() -> bool:
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
        prctl(PR_SET_SECCOMP, _FILTER, struct.pack("HxxxxxxP", len(program), ctypes.addressof(code)))
        return True
    return False
