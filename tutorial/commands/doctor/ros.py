"""Which ROS 2 is in use, how far it is heard, and who else is in its domain. Nothing here imports rclpy."""

from __future__ import annotations

import sys
from collections import Counter
from collections.abc import Callable, Iterator, Mapping

from tutorial.commands.doctor.contained import Ask, UnansweredError
from tutorial.commands.doctor.finding import Finding
from tutorial.errors import TutorialError, did_you_mean

__all__ = ["backend", "discovery", "domain", "nodes"]

RANGE = "ROS_AUTOMATIC_DISCOVERY_RANGE"
RANGES = {
    "LOCALHOST": "nodes on this machine only",
    "SUBNET": "nodes on all machines of this network",
    "OFF": "no other node, not even on this machine",
    "SYSTEM_DEFAULT": "what the middleware is configured for",
}
MOST_NAMES = 50
OURS = "the tutorial's own, on Cyclone DDS"
LAST_DOMAIN, LAST_SAFE_DOMAIN = 232, 101  # above 101 the ports are among those that Linux gives to outgoing connections


def backend(
    environment: Mapping[str, str], choose: Callable[[], str], is_there: Callable[[], bool], ask: Ask
) -> Iterator[Finding]:
    """Say which ROS 2 is in use, and why.

    Args:
        environment: the variables.
        choose: decides, as `tutorial.ros_backend`.
        is_there: whether a real rclpy can be found.
        ask: has rclpy imported elsewhere.
    """
    try:
        chosen = choose()
    except TutorialError as error:
        yield Finding("ROS 2", "problem", str(error), "unset TUTORIAL_ROS")
        return
    yield _real(environment, is_there(), ask) if chosen == "rclpy" else _underlay(environment, ask)


def discovery(environment: Mapping[str, str], is_real: bool) -> Iterator[Finding]:
    """Say in plain words how far the nodes here look for others, and what was set by hand.

    Args:
        environment: the variables.
        is_real: whether a real ROS 2 is in use; its default is another than the tutorial's own.
    """
    given = environment.get(RANGE, "")
    reach = given or ("SUBNET" if is_real else "LOCALHOST")
    origin = f"{RANGE} is {given}" if given else f"{reach}, the default"
    mend = f"export {RANGE}=LOCALHOST" if is_real else f"unset {RANGE}"
    if reach not in RANGES:
        text = f"{RANGE} is {given!r}.{did_you_mean(given, RANGES)}"
        yield Finding("discovery", "problem", text, mend)
    elif reach == "LOCALHOST":
        yield Finding("discovery", "ok", f"{RANGES[reach]} ({origin})")
    else:
        yield Finding("discovery", "note", f"{RANGES[reach]} ({origin})", f"for this machine only: {mend}")
    yield from _by_hand(environment)


def domain(environment: Mapping[str, str]) -> Iterator[Finding]:
    """Say which domain nodes meet in."""
    given = environment.get("ROS_DOMAIN_ID", "").strip()
    number = _number(environment)
    if number is None:
        text = f"ROS_DOMAIN_ID is {given!r}, and must be a number from 0 to {LAST_DOMAIN}"
        yield Finding("domain", "problem", text, f"unset ROS_DOMAIN_ID, or a number up to {LAST_SAFE_DOMAIN}")
    elif number > LAST_SAFE_DOMAIN:
        text = f"{number}: its ports, from {7400 + 250 * number} on, may be taken by other programs' connections"
        yield Finding("domain", "note", text, f"export ROS_DOMAIN_ID=42, or another up to {LAST_SAFE_DOMAIN}")
    else:
        origin = "ROS_DOMAIN_ID" if given else "the default; a notebook takes one of its own"
        yield Finding("domain", "ok", f"{number} ({origin}): only nodes of one domain hear each other")


def nodes(environment: Mapping[str, str], ask: Ask) -> Iterator[Finding]:
    """Say who is in the domain, and which names are there more than once."""
    number = _number(environment)
    if number is None:
        yield Finding("nodes", "note", "nobody was looked for", "set ROS_DOMAIN_ID right first")
        return
    try:
        answer = ask("nodes", environment)
    except UnansweredError as error:
        mend = "mend what is said above of ROS 2, or see how many processes there are below"
        yield Finding("nodes", "problem", f"a node cannot be made: {error}", mend)
        return
    counts = Counter(answer["nodes"])
    named = [f"{count} x {name}" if count > 1 else name for name, count in sorted(counts.items())]
    more = [f"and {len(named) - MOST_NAMES:,} more"] if len(named) > MOST_NAMES else []
    text = f"in domain {number}: {', '.join(named[:MOST_NAMES] + more) or 'nobody else'}"
    twins = [name for name, count in counts.items() if count > 1]
    if twins:
        mend = "give each its own name: tank run step3 --ros-args -r __node:=viewer"
        yield Finding("nodes", "note", f"{text}. Nodes of one name cannot be told apart", mend)
    elif not answer["settled"]:
        yield Finding("nodes", "note", f"{text}. Some still come or go", "run tank doctor again")
    else:
        yield Finding("nodes", "ok", text)


def _real(environment: Mapping[str, str], is_there: bool, ask: Ask) -> Finding:
    distro = environment.get("ROS_DISTRO", "")
    if not is_there:
        text = "TUTORIAL_ROS=rclpy asks for a real ROS 2, and this Python finds no rclpy"
        return Finding("ROS 2", "problem", text, ". /opt/ros/jazzy/setup.bash, or unset TUTORIAL_ROS")
    try:
        found = ask("rclpy", environment)
    except UnansweredError as error:
        this = f"{sys.version_info.major}.{sys.version_info.minor}"
        mend = f"Jazzy's is made for Python 3.12 (this is {this}); the tutorial's own: export TUTORIAL_ROS=underlay"
        return Finding("ROS 2", "problem", f"there is a real rclpy, and it is broken: {error}", mend)
    why = "TUTORIAL_ROS=rclpy" if environment.get("TUTORIAL_ROS") else "this Python finds it"
    how = "RMW_IMPLEMENTATION" if environment.get("RMW_IMPLEMENTATION") else "the default"
    name = f"ROS 2 {distro or '(ROS_DISTRO is not set)'}"
    text = f"{name}, because {why}: rclpy {found['version']}, {found['file']}, on {found['rmw']} ({how})"
    if "dds" not in found["rmw"] and "fastrtps" not in found["rmw"]:
        mend = "export RMW_IMPLEMENTATION=rmw_cyclonedds_cpp"
        return Finding("ROS 2", "note", f"{text}, which does not speak DDS: it hears none of the others", mend)
    if distro != "jazzy":
        return Finding("ROS 2", "note", f"{text}. The tutorial is made for jazzy", ". /opt/ros/jazzy/setup.bash")
    return Finding("ROS 2", "ok", text)


def _underlay(environment: Mapping[str, str], ask: Ask) -> Finding:
    distro = environment.get("ROS_DISTRO", "")
    asked_for = bool(environment.get("TUTORIAL_ROS"))
    text = f"{OURS}, because {'TUTORIAL_ROS=underlay' if asked_for else 'this Python finds no rclpy'}"
    try:
        ask("rclpy", environment)
    except UnansweredError as error:
        mend = "python -m pip install cyclonedds rosbags; where there is no cyclonedds, a real ROS 2"
        return Finding("ROS 2", "problem", f"{text}; but it does not start: {error}", mend)
    if distro and not asked_for:
        mend = "with the Python that ROS 2 is made for: python3.12 -m venv --system-site-packages ~/tank-ros"
        return Finding("ROS 2", "note", f"{text}, although ROS 2 {distro} is set up in this shell", mend)
    return Finding("ROS 2", "ok", text)


def _by_hand(environment: Mapping[str, str]) -> Iterator[Finding]:
    """What else was set that changes who is found."""
    meanings = {
        "ROS_STATIC_PEERS": "nodes on these machines are looked for as well",
        "ROS_LOCALHOST_ONLY": "ROS 2's former way, which a real one may put above the range",
        "CYCLONEDDS_URI": "it comes on top of what the tutorial and ROS 2 configure",
    }
    for name, meaning in meanings.items():
        if value := environment.get(name):
            shown = value if len(value) <= 60 else f"{value[:57]}..."
            yield Finding("discovery", "note", f"{name} is {shown!r}: {meaning}", f"if it is not meant: unset {name}")


def _number(environment: Mapping[str, str]) -> int | None:
    """The domain's number; None where ROS_DOMAIN_ID is not one."""
    text = environment.get("ROS_DOMAIN_ID", "").strip() or "0"
    return int(text) if text.isdecimal() and int(text) <= LAST_DOMAIN else None
