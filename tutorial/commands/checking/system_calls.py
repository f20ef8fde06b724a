"""The calls of Linux that Python has no function for."""

from __future__ import annotations

import ctypes
import os
from contextlib import suppress

__all__ = [
    "PR_SET_CHILD_SUBREAPER",
    "PR_SET_NO_NEW_PRIVS",
    "PR_SET_PDEATHSIG",
    "PR_SET_SECCOMP",
    "drop_capabilities",
    "mount",
    "prctl",
    "syscall",
    "unshare",
]

PR_SET_PDEATHSIG, PR_SET_SECCOMP, PR_CAPBSET_DROP, PR_SET_CHILD_SUBREAPER, PR_SET_NO_NEW_PRIVS = 1, 22, 24, 36, 38
_CAPABILITIES = 64  # more than there are
_CAPABILITY_VERSION = 0x20080522

_libc = ctypes.CDLL(None, use_errno=True)


def syscall(number: int, *arguments: object) -> int:
    """Make a call by its number.

    Raises:
        OSError: the system refuses.
    """
    return _checked(_libc.syscall(ctypes.c_long(number), *arguments))


def prctl(option: int, *arguments: int | bytes) -> None:
    """Change a property of this process.

    Raises:
        OSError: the system refuses.
    """
    unused = [0] * (4 - len(arguments))
    _checked(_libc.prctl(option, *(ctypes.c_ulong(a) if isinstance(a, int) else a for a in [*arguments, *unused])))


def unshare(flags: int) -> None:
    """Go on in namespaces of its own.

    Raises:
        OSError: the system refuses.
    """
    _checked(_libc.unshare(flags))


def mount(source: str, target: str, kind: str | None, flags: int, options: str = "") -> None:
    """Mount a file system.

    Raises:
        OSError: the system refuses.
    """
    kind_bytes = kind.encode() if kind else None
    _checked(_libc.mount(source.encode(), os.fsencode(target), kind_bytes, ctypes.c_ulong(flags), options.encode()))


def drop_capabilities() -> None:
    """Give up what root may do, for good: who is root in a namespace could take its walls down."""
    with suppress(OSError):  # at the first that this system does not know, or where there is none to give up
        for capability in range(_CAPABILITIES):
            prctl(PR_CAPBSET_DROP, capability)
    none = (ctypes.c_uint32 * 6)()
    _checked(_libc.capset((ctypes.c_uint32 * 2)(_CAPABILITY_VERSION, 0), none))


def _checked(result: int) -> int:
    if result < 0:
        number = ctypes.get_errno()
        raise OSError(number, os.strerror(number))
    return result
