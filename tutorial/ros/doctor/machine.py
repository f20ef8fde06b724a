"""Examine this program and its machine, without joining a domain and without using ROS 2.

The ROS 2 ports in use show which domains are used on this machine. The environment variables of other programs show why
those programs cannot be seen.
"""

from __future__ import annotations

import os
import shlex
import socket
from collections.abc import Iterable, Mapping
from pathlib import Path

import psutil

from tutorial.ros.backend import ros_backend
from tutorial.ros.doctor.facts import Program
from tutorial.ros.doctor.rules import PLACES
from tutorial.ros.domains import FIRST_PORT, FIRST_UNICAST, PORTS
from tutorial.ros.wheels.folder import RANGE

COMMAND = 60  # maximum number of characters of a program's command to show
READS = 10  # how often to list the sockets, because a single list can be incomplete
EPHEMERAL = 32768  # from this port up, the system assigns ports to programs


def reach() -> str:
    """Return the discovery range of this program."""
    return os.environ.get(RANGE) or ("SUBNET" if ros_backend() == "rclpy" else "LOCALHOST")


def domain_in(variables: Mapping[str, str]) -> int:
    """Return the domain that a program's environment variables select."""
    given = variables.get("ROS_DOMAIN_ID", "").strip()
    return int(given) if given.isdecimal() else 0


def participants(domain: int) -> int:
    """Return how many of a domain's participant slots (with Cyclone DDS) are in use on this machine; 0 if unknown."""
    first = FIRST_PORT + PORTS * domain + FIRST_UNICAST
    return len((_udp_ports() or set()).intersection(range(first, first + 2 * PLACES, 2)))


def domains_in_use(domains: Iterable[int]) -> list[int]:
    """Return the given domains that are in use on this machine, or all of them if that is unknown."""
    ports = _udp_ports()
    return [each for each in domains if ports is None or any((port - FIRST_PORT) // PORTS == each for port in ports)]


def programs() -> list[Program]:
    """Return this user's other programs that have network connections; on Linux only."""
    try:
        sockets = psutil.net_connections("inet")
    except (psutil.Error, OSError):  # on macOS, only root can list connections
        return []
    domains: dict[int, list[int]] = {each.pid: [] for each in sockets if each.pid not in (None, os.getpid())}
    for each in sockets:
        port = each.laddr.port if each.laddr and each.type == socket.SOCK_DGRAM else 0
        if each.pid in domains and FIRST_PORT <= port < EPHEMERAL:
            domains[each.pid].append((port - FIRST_PORT) // PORTS)
    found = (_program(pid, domains[pid]) for pid in sorted(domains))
    return [each for each in found if each is not None]


def _program(pid: int, joined: list[int]) -> Program | None:
    try:
        process = psutil.Process(pid)
        variables, command, status = process.environ(), process.cmdline(), process.status()
    except (psutil.Error, OSError):  # the process has ended, or belongs to a different user
        return None
    first, *others = command or ["unknown"]
    return Program(
        pid,
        shlex.join([Path(first).name, *others])[:COMMAND],
        domain=min(joined) if joined else domain_in(variables),
        joined=bool(joined),
        stopped=status == psutil.STATUS_STOPPED,
        reach=variables.get(RANGE, ""),
        rmw=variables.get("RMW_IMPLEMENTATION", ""),
    )


def _udp_ports() -> set[int] | None:
    """Return the UDP ports in use on this machine; None if only root may list them.

    While programs open and close sockets, Linux can omit some of the other sockets from a list: see ``READS``.
    """
    try:
        lists = [psutil.net_connections("udp") for _ in range(READS)]
        return {each.laddr.port for connections in lists for each in connections if each.laddr}
    except (psutil.Error, OSError):
        return None
