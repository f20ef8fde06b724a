"""Landlock: of all files only those can be opened that are needed, and only one folder can be written to.

Any process may confine itself so. See linux/landlock.h, and https://docs.kernel.org/userspace-api/landlock.html.
"""

from __future__ import annotations

import ctypes
import errno
import os
import struct
import sys
from collections.abc import Iterator
from pathlib import Path

from tutorial.commands.checking.namespaces import DOMAINS, SHARED_MEMORY
from tutorial.commands.checking.system_calls import syscall
from tutorial.paths import PACKAGE

__all__ = ["restrict_files"]

_SYS_CREATE_RULESET, _SYS_ADD_RULE, _SYS_RESTRICT_SELF = 444, 445, 446
_EXECUTE, _WRITE, _READ, _LIST, _TRUNCATE, _DEVICE = 1 << 0, 1 << 1, 1 << 2, 1 << 3, 1 << 14, 1 << 15
_MAKE = 1 << 8  # regular files
_OF_FILES = _EXECUTE | _WRITE | _READ | _TRUNCATE | _DEVICE
_KNOWN = {1: 13, 2: 14, 3: 15, 4: 15}  # by version, how many rights there are; from 5 on
_RIGHTS = 16
_CREATE_RULESET_VERSION = 1
_RULE_PATH_BENEATH = 1
_TCP = 0b11  # bind, connect
_SCOPES = 0b11  # abstract Unix sockets, signals


def restrict_files(folder: Path, namespaces: bool) -> int:
    """Have Landlock refuse all other files; return its version."""
    try:
        version = syscall(_SYS_CREATE_RULESET, None, ctypes.c_size_t(0), _CREATE_RULESET_VERSION)
        handled = (1 << _KNOWN.get(version, _RIGHTS)) - 1
        fields = [handled, _TCP, _SCOPES][: 1 + (version >= 4) + (version >= 6)]
        attributes = struct.pack(f"{len(fields)}Q", *fields)
        ruleset = syscall(_SYS_CREATE_RULESET, attributes, ctypes.c_size_t(len(attributes)), 0)
        for path, rights in _open_to(folder, namespaces):
            _allow(ruleset, path, rights & handled)
        syscall(_SYS_RESTRICT_SELF, ruleset, 0)
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
        syscall(_SYS_ADD_RULE, ruleset, _RULE_PATH_BENEATH, struct.pack("=Qi", rights, fd), 0)
    os.close(fd)
