"""``tank doctor``: check whether the tutorial can run on this machine, and suggest fixes.

Checks that can crash or hang run in a separate process, which prints its answer as JSON.
"""

# ruff: noqa: PLC0415 - modules that can crash are imported only in that process

import asyncio
import json
import os
import platform
import signal
import subprocess
import sys
import textwrap
import time
from collections import Counter
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from importlib import metadata
from pathlib import Path
from typing import Any, Literal, NamedTuple

from pocket_ros2 import real_rclpy
from tutorial.errors import TutorialError, did_you_mean
from tutorial.ros.backend import VARIABLE, ros_backend
from tutorial.ros.loopback import TURN_ON, loopback_is_up, require_loopback
from tutorial.ros.wheels import folder
from tutorial.ros.wheels.folder import RANGE
from tutorial.system.printing import print_text

WIDTH = 100  # columns, including 20 for subject and level
TIMEOUT = 45  # [s] maximum time to wait for an answer: imports are slow on a loaded machine
FIRST_LOOK = 4.0  # [s] until the graph counts as known: nodes on Fast DDS show up after 1 to 4 s

PIP = "python -m pip install"
SETUP = "/opt/ros/jazzy/setup.bash"

Kind = Literal["pocket", "folder", "pixi", "sourced"]
"""Which ROS 2 is in use: the pocket ROS 2, a real one from PyPI wheels or from RoboStack, or a sourced one."""

RANGES = {
    "LOCALHOST": "nodes on this machine only",
    "SUBNET": "all nodes on this network",
    "OFF": "no other node, not even on this machine",
    "SYSTEM_DEFAULT": "as configured in the middleware",
}
BY_HAND = ("ROS_STATIC_PEERS", "ROS_LOCALHOST_ONLY", "CYCLONEDDS_URI")
"""Other variables that affect discovery."""


class Diagnosis(NamedTuple):
    """The result of one probe.

    Attributes:
        level: ``"ok"``; ``"note"`` if the result may be surprising; ``"problem"`` if something does not work.
        text: what the probe found.
        fix: the fix, such as a command. Only notes and problems have a fix.
    """

    level: Literal["ok", "note", "problem"]
    text: str
    fix: str = ""


def doctor() -> int:
    """Run all probes, and print what each of them found.

    Returns:
        The exit status: 1 if there is a problem, else 0.
    """
    levels = Counter[str]()
    with ThreadPoolExecutor(len(PROBES)) as pool:
        for subject, (level, text, fix) in zip(PROBES, pool.map(_looked, PROBES.values())):
            print_text(_columns(f"{subject:11}{level:9}", text) + _columns(f"{'':17}-> ", fix) * bool(fix))
            levels[level] += 1
    print_text(f"\nproblems: {levels['problem']}, notes: {levels['note']}\n")
    return int(levels["problem"] > 0)


def _looked(probe: Callable[[], Diagnosis]) -> Diagnosis:
    try:
        return probe()
    except TutorialError:
        return Diagnosis("note", "not checked because of the problem above", "fix that first")
    except Exception as error:  # noqa: BLE001 - the other probes continue
        return Diagnosis("note", f"the check failed: {type(error).__name__}: {error}", "check it by hand")


def _columns(label: str, text: str) -> str:
    """Wrap text beside its label, without breaking words, so that paths and commands can be copied."""
    indent = " " * 20
    wrapper = textwrap.TextWrapper(WIDTH, label, indent, break_long_words=False, break_on_hyphens=False)
    return wrapper.fill(text) + "\n"


def ask(question: Callable[[], Any], timeout: float = TIMEOUT) -> Any:
    """Call a function in a separate process, and return its result.

    Args:
        question: one of this module's functions.
        timeout: the time limit [s].

    Raises:
        TutorialError: the function crashed, failed or took too long; the error reports which.
    """
    code = f"import json; from {__name__} import {question.__name__} as ask; print(json.dumps(ask()))"
    command = [sys.executable, "-P", "-X", "utf8", "-c", code]
    try:
        done = subprocess.run(command, capture_output=True, encoding="utf-8", timeout=timeout, check=False)
    except subprocess.TimeoutExpired:
        raise TutorialError(f"no answer within {timeout:g} s") from None
    if done.returncode < 0:
        raise TutorialError(f"crashed with {signal.Signals(-done.returncode).name}")
    if done.returncode > 0:
        raised = (done.stderr.splitlines() or [f"exit status {done.returncode}"])[-1]
        raise TutorialError(raised.removeprefix("tutorial.errors.TutorialError: "))
    return json.loads(done.stdout.splitlines()[-1])


def mujoco() -> Diagnosis:
    """Report MuJoCo's version, and whether it can render camera images."""
    try:
        version, problem = ask(_mujoco)
    except TutorialError as error:
        fix = "unset MUJOCO_GL" if "MUJOCO_GL" in str(error) else f"{PIP} --force-reinstall mujoco"
        return Diagnosis("problem", f"it cannot be imported: {error}", fix)
    if problem:
        return Diagnosis("note", f"{version}; everything works except cameras: {problem[0]}", problem[1])
    return Diagnosis("ok", f"{version}, which can render off screen")


def packages() -> Diagnosis:
    """Report what ``pip check`` prints."""
    command = [sys.executable, "-m", "pip", "check", "--disable-pip-version-check"]
    done = subprocess.run(command, capture_output=True, text=True, timeout=TIMEOUT, check=False)
    text = done.stdout.strip() or done.stderr.strip()
    if done.returncode:
        fix = f"in the tutorial's folder: {PIP} -c constraints.txt -e . -e tutorial/ros/pocket"
        return Diagnosis("problem", text, fix)
    return Diagnosis("ok", text)


def backend() -> Diagnosis:
    """Report which ROS 2 is in use, and why."""
    wanted, distro = os.environ.get(VARIABLE), os.environ.get("ROS_DISTRO")
    pocket = f"export {VARIABLE}=pocket"
    try:
        kind = _kind()
    except TutorialError as error:
        return Diagnosis(
            "problem", str(error), f"to use the pocket ROS 2 instead: {f'unset {VARIABLE}' if wanted else pocket}"
        )
    cyclonedds = f"{PIP} cyclonedds" if folder.is_supported() or sys.platform == "darwin" else folder.how_to_get_it()
    jazzy = f". {SETUP}, or {pocket}" if Path(SETUP).exists() else pocket
    name, repair = {
        "pocket": ("the pocket ROS 2, on Cyclone DDS", cyclonedds),
        "folder": ("the real ROS 2 from tank ros install", "tank ros remove, then tank ros install"),
        "pixi": (f"ROS 2 {distro or 'jazzy'} from RoboStack", "rm -r .pixi, then pixi run doctor"),
        "sourced": (f"ROS 2 {distro or '(ROS_DISTRO is not set)'}", jazzy),
    }[kind]
    finds = "no rclpy" if kind == "pocket" else "it"
    text = f"{name}, because {f'{VARIABLE}={wanted}' if wanted else f'this Python finds {finds}'}"
    try:
        version, file, rmw = ask(_rclpy)
    except TutorialError as error:
        return Diagnosis("problem", f"{text}; but it is broken: {error}", repair)
    if kind != "pocket":
        text += f": rclpy {version}, {file}, on {rmw}"
    if rmw == "rmw_zenoh_cpp":
        text += ", which does not use DDS, so its nodes cannot reach nodes that do"
        return Diagnosis("note", text, "export RMW_IMPLEMENTATION=rmw_cyclonedds_cpp")
    if kind == "sourced" and distro != "jazzy":
        return Diagnosis("note", f"{text}. The tutorial is written for Jazzy", repair)
    if kind == "pocket" and distro and not wanted:
        text += f", although ROS 2 {distro} is set up in this shell"
        fix = "python3.12 -m venv --system-site-packages ~/tank-ros; activate it, and source ROS 2's setup.bash again"
        return Diagnosis("note", text, fix)
    return Diagnosis("ok", text)


def _kind() -> Kind:
    """Return which of the four kinds of ROS 2 is in use.

    Raises:
        TutorialError: the requested ROS 2 cannot be used.
    """
    if ros_backend() == "pocket":
        return "pocket"
    rclpy = real_rclpy()
    if rclpy is None or rclpy.is_relative_to(folder.prefix()):  # None if the folder is damaged
        return "folder"
    return "pixi" if (Path(sys.prefix) / "conda-meta").is_dir() else "sourced"


def discovery() -> Diagnosis:
    """Report the discovery range, and which variables change it."""
    reach = os.environ.get(RANGE) or ("SUBNET" if ros_backend() == "rclpy" else "LOCALHOST")
    if reach not in RANGES:
        return Diagnosis("problem", f"{RANGE} is {reach!r}.{did_you_mean(reach, RANGES)}", f"unset {RANGE}")
    if not loopback_is_up():
        return Diagnosis(
            "problem", "the loopback interface (127.0.0.1) is down: programs cannot find each other", TURN_ON
        )
    text = f"{reach}: {RANGES[reach]}"
    mends = [] if reach == "LOCALHOST" else [f"to reach only nodes on this machine: export {RANGE}=LOCALHOST"]
    for name in filter(os.environ.get, BY_HAND):
        text += f"; {name} is {os.environ[name]!r}, which also affects discovery"
        mends.append(f"if it was not set on purpose: unset {name}")
    return Diagnosis("note" if mends else "ok", text, "; ".join(mends))


def domain() -> Diagnosis:
    """Report the domain, the nodes in it, and the names that several of them share."""
    number = os.environ.get("ROS_DOMAIN_ID") or "0"
    ros_backend()
    require_loopback()
    try:
        names = ask(_nodes)
    except TutorialError as error:
        fix = "fix the problems with ROS 2 first; ROS_DOMAIN_ID can be any number from 0 to 101"
        return Diagnosis("problem", f"cannot create a node in domain {number}: {error}", fix)
    counts = Counter(names)
    named = [f"{count} x {name}" if count > 1 else name for name, count in sorted(counts.items())]
    text = f"in domain {number}: {', '.join(named) or 'no other nodes'}"
    if len(counts) < len(names):
        fix = "give each node a different name: tank run step3 --ros-args -r __node:=viewer"
        return Diagnosis("note", f"{text}. Nodes with the same name cannot be distinguished", fix)
    return Diagnosis("ok", text)


PROBES: dict[str, Callable[[], Diagnosis]] = {
    "Python": lambda: Diagnosis("ok", f"{platform.python_version()}, {sys.executable}"),
    "MuJoCo": mujoco,
    "packages": packages,
    "ROS 2": backend,
    "discovery": discovery,
    "domain": domain,
}
"""All probes, by subject, in the order their results are printed. They run concurrently."""


def _mujoco() -> tuple[str, tuple[str, str] | None]:
    """Return MuJoCo's version and, if it cannot render, the error and its fix."""
    import mujoco

    from tutorial.view import offscreen

    try:
        with offscreen.Offscreen(mujoco.MjModel.from_xml_string("<mujoco/>")):
            return mujoco.__version__, None
    except Exception as error:  # noqa: BLE001 - PyOpenGL, MuJoCo and drivers can raise anything
        return mujoco.__version__, (f"{type(error).__name__}: {error}", offscreen.advice())


def _rclpy() -> tuple[str, str | None, str]:
    """Return rclpy's version, its file and its middleware."""
    import rclpy
    from rclpy.utilities import get_rmw_implementation_identifier

    version = "".join(each.version for each in metadata.distributions(name="rclpy"))
    return version, rclpy.__file__, get_rmw_implementation_identifier()


def _nodes() -> list[str]:
    """Return the names of the nodes in the graph, except for hidden nodes, such as this function's own node."""
    from tutorial.ros.node_thread import NodeThread
    from tutorial.ros.topics.graph import wait_for_graph
    from tutorial.ros.topics.listing import node_names
    from tutorial.ros.topics.names import escape_name

    with NodeThread("_doctor") as thread:
        time.sleep(FIRST_LOOK)
        asyncio.run(wait_for_graph(thread.node))
        return [escape_name(name) for name in node_names(thread.node)]
