"""Robot and desk on two machines: two network namespaces and a cable, which this test creates and removes.

Waiting cannot prove that two programs do not discover each other. The cable can: a program has to send something to be
discovered, so if its machine has not sent a single packet, no program on the other machine has discovered it.
"""

from __future__ import annotations

import ctypes
import json
import shutil
import subprocess
from collections.abc import Iterator
from contextlib import ExitStack, closing, contextmanager
from functools import partial
from pathlib import Path

import psutil
import pytest
from programs import TIMEOUT, until

pytestmark = pytest.mark.process

CLONE_NEWNET = 0x40000000  # from linux/sched.h
TOPIC = "/Tank/joint_state"
RANGE = "ROS_AUTOMATIC_DISCOVERY_RANGE"
PEERS = "ROS_STATIC_PEERS"


class Machine:
    """A network namespace, with an interface ``lan`` once a cable is connected.

    It has no name, and exists as long as there is a process in it. The first one is ``cat``, which ends with this
    process, however that ends. The cable disappears with the namespace.

    Attributes:
        address: its address on the cable.
    """

    def __init__(self, address: str) -> None:
        self.address = address
        pipes = dict.fromkeys(("stdin", "stdout", "stderr"), subprocess.PIPE)
        self._holder = subprocess.Popen(["unshare", "--net", "sh", "-c", "echo made; exec cat"], **pipes, text=True)
        if not self._holder.stdout.readline():
            pytest.skip(f"cannot create a network namespace here: {self._holder.communicate()[1].strip()}")

    @contextmanager
    def inside(self) -> Iterator[None]:
        """Enter this machine: sockets, threads and processes that this thread creates meanwhile belong to it."""
        there = Path(f"/proc/{self._holder.pid}/ns/net")
        with Path("/proc/thread-self/ns/net").open() as home, there.open() as away:
            _enter(away.fileno())
            try:
                yield
            finally:
                _enter(home.fileno())

    def cable_to(self, other: Machine) -> None:
        """Connect two machines. IPv6 is off, because the kernel would send packets on its own."""
        with self.inside():
            try:
                _ip(f"link add lan type veth peer name lan netns {other._holder.pid}")
            except subprocess.CalledProcessError as error:
                pytest.skip(f"cannot connect network namespaces here: {error.stderr.strip()}")
        for machine in (self, other):
            with machine.inside():
                _ip("link set lo up")
                _ip("link set lan addrgenmode none")
                _ip(f"address add {machine.address}/24 dev lan")
                _ip("link set lan up")
        for machine in (self, other):
            with machine.inside():  # Linux takes up to a second; Fast DDS ignores a cable that is not up yet
                until(lambda: "running" in psutil.net_if_stats()["lan"].flags, "the cable")

    @property
    def sent(self) -> int:
        """Return the number of packets that this machine has sent over the cable."""
        counters = Path(f"/proc/{self._holder.pid}/net/dev").read_text().split("lan:")[1].split()
        return int(counters[9])

    def close(self) -> None:
        """Remove the machine."""
        self._holder.communicate(timeout=TIMEOUT)


def _enter(namespace: int) -> None:
    """Move the calling thread into a network namespace, like `os.setns` from Python 3.12 on."""
    libc = ctypes.CDLL(None, use_errno=True)
    if libc.setns(namespace, CLONE_NEWNET):
        raise OSError(ctypes.get_errno(), "setns")


def _ip(words: str) -> None:
    subprocess.run(["ip", *words.split()], check=True, capture_output=True, text=True)


@pytest.fixture
def machines():
    """The robot's machine and the desk's, with a cable between them."""
    for tool in ("ip", "unshare"):
        if shutil.which(tool) is None:
            pytest.skip(f"creating a network namespace needs the command {tool!r}")
    with ExitStack() as stack:
        robot, desk = (
            stack.enter_context(closing(Machine(address)))
            for address in ("192.0.2.1", "192.0.2.2")  # from the range for documentation, which nobody uses
        )
        robot.cable_to(desk)
        yield robot, desk


@pytest.fixture
def start(machines, program, monkeypatch):
    """Start a ``tank`` command on a machine, with a discovery range (None for the default) and peers."""

    def start(machine, discovery, *arguments, peer=None):
        for name, value in ((RANGE, discovery), (PEERS, peer and peer.address)):
            monkeypatch.delenv(name, raising=False) if value is None else monkeypatch.setenv(name, value)
        with machine.inside():
            return program(*arguments)

    return start


def hears(listen, topic):
    """Return whether a message arrives; the topic may not have a publisher yet."""
    echo = listen("topic", "echo", "--once", topic)
    return echo.ends() == 0 and "\n---\n" in echo.output


def stop(running):
    running.asks_to_stop()
    assert running.ends() == 0, running.output
    running.leaves_nothing()


@pytest.mark.parametrize(
    ("robots", "robot_knows", "desks", "desk_knows"),
    [
        pytest.param("SUBNET", False, "SUBNET", False, id="subnet"),
        pytest.param("LOCALHOST", True, "LOCALHOST", True, id="localhost and each other"),
        pytest.param("LOCALHOST", True, "SUBNET", False, id="localhost and the desk, subnet"),
    ],
)
def test_the_desk_drives_the_robot_and_hears_its_joints(start, machines, robots, robot_knows, desks, desk_knows):
    robot, desk = machines
    at_robot = partial(start, robot, robots, peer=desk if robot_knows else None)
    at_desk = partial(start, desk, desks, peer=robot if desk_knows else None)
    running = at_robot("run", "step2", "--headless"), at_desk("joy", "--drive", "tour")
    for listen, topic in (at_desk, TOPIC), (at_robot, "/joy"):
        until(lambda listen=listen, topic=topic: hears(listen, topic), f"a message on {topic}")
    for each in running:
        stop(each)


@pytest.mark.pocket
@pytest.mark.parametrize("quiet", [None, "LOCALHOST", "OFF"])
@pytest.mark.parametrize("who", ["simulation", "viewer"])
def test_a_program_that_stays_local_meets_no_other_machine(start, machines, tmp_path, quiet, who):
    robot, desk = machines
    silent, calling = (robot, desk) if who == "simulation" else (desk, robot)
    viewer = start(
        desk, quiet if desk is silent else "SUBNET", "run", "step3", "--headless", "--report", tmp_path,
        "--ros-args", "-r", "__node:=viewer",
    )  # fmt: skip
    viewer.says("- JointStateSubscriber")
    simulation = start(robot, quiet if robot is silent else "SUBNET", "run", "step2", "--headless")
    simulation.says("- JointStatePublisher")
    before = calling.sent
    until(lambda: calling.sent >= before + 3, "three announcements on the cable")
    assert silent.sent == 0
    stop(simulation)
    stop(viewer)
    assert silent.sent == 0
    assert json.loads((tmp_path / "viewer.json").read_text())["topics"][TOPIC]["received"] == 0
