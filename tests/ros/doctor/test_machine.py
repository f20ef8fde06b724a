"""Causes that the doctor finds in the system: programs that cannot be discovered, and a full domain."""

import asyncio
import os
import signal
import socket
import subprocess
import sys
from contextlib import ExitStack

import psutil
import pytest
from programs import TANK, until

from tutorial.commands import terminal
from tutorial.commands.topic_doctor import doctor_of
from tutorial.ros.doctor.machine import READS, domains_in_use, programs
from tutorial.ros.doctor.observe import observe
from tutorial.ros.doctor.rules import diagnose
from tutorial.ros.node_thread import NodeThread

PUBLISH = [TANK, "topic", "pub", "-r", "20"]
SERVE = "import socket; s = socket.create_server(('127.0.0.1', {})); s.accept()"


@pytest.fixture
def start(domain):
    """Start a process in the test's domain, and wait until the doctor knows of it."""
    with ExitStack() as stack:

        def start(*command: str, **variables: str) -> subprocess.Popen:
            environment, quiet = {**os.environ, **variables}, subprocess.DEVNULL
            process = subprocess.Popen(command, env=environment, stdout=quiet, stderr=quiet)
            stack.callback(process.wait)
            stack.callback(process.kill)
            until(lambda: process.pid in {each.pid for each in programs() if each.domain == domain}, "the process")
            return process

        yield start


def first_cause(topic: str) -> str:
    with NodeThread("_doctor") as thread:
        return diagnose(asyncio.run(observe(thread.node, topic)))[0].name


@pytest.mark.process
@pytest.mark.parametrize(("topic", "kind"), [("/joy", "sensor_msgs/msg/Joy"), ("/chatter", "std_msgs/msg/String")])
def test_range_and_stopped(start, domain, topic, kind):
    hidden = start(*PUBLISH, topic, kind, ROS_AUTOMATIC_DISCOVERY_RANGE="OFF")
    assert first_cause(topic) == "range"
    hidden.kill()
    hidden.wait()
    seen = start(*PUBLISH, topic, kind)
    until(lambda: domains_in_use([domain]), "the publisher's ports")
    with NodeThread("_asker") as thread:
        until(lambda: thread.node.count_publishers(topic), "the publisher")
    seen.send_signal(signal.SIGSTOP)
    assert first_cause(topic) == "stopped"


def test_own_range(domain, monkeypatch):
    monkeypatch.setenv("ROS_AUTOMATIC_DISCOVERY_RANGE", "OFF")
    assert first_cause("/joy") == "range"


@pytest.mark.process
@pytest.mark.parametrize("topic", ["/joy", "/Tank/joint_state"])
def test_rmw(start, domain, topic):
    elsewhere = 7500 + 250 * (domain - 1)  # with UDP, this port would belong to a different domain
    start(sys.executable, "-c", SERVE.format(elsewhere), RMW_IMPLEMENTATION="rmw_zenoh_cpp")
    assert first_cause(topic) == "rmw"


@pytest.fixture
def take(domain):
    """Return a function that takes a number of places in the domain."""
    with ExitStack() as stack:

        def take(places: int) -> None:
            for place in range(places):
                stack.enter_context(socket.socket(type=socket.SOCK_DGRAM)).bind(("", 7410 + 250 * domain + 2 * place))

        yield take


@pytest.mark.pocket
@pytest.mark.parametrize("topic", ["/joy", "joint_state"])
def test_full_domain(domain, take, capsys, monkeypatch, topic):
    monkeypatch.setattr(terminal, "handle_signals", lambda *_: None)  # pytest has its own handlers
    take(32)
    assert doctor_of(topic, []) == 1
    assert capsys.readouterr().out.startswith("1. The domain is full\n     saw   All 32 places of domain")


@pytest.mark.pocket
def test_the_last_place(domain, take):
    take(31)
    assert first_cause("/joy") == "participants"


def test_an_incomplete_list_of_sockets_hides_no_domain(domain, take, monkeypatch):
    take(1)
    lists = iter([[], psutil.net_connections("udp"), *[[]] * READS])
    monkeypatch.setattr(psutil, "net_connections", lambda kind: next(lists))
    assert domains_in_use([domain]) == [domain]


def test_domains_in_use(domain):
    with socket.socket(type=socket.SOCK_DGRAM) as udp, socket.socket() as tcp:
        tcp.bind(("", 7499 + 250 * domain))
        assert domains_in_use([domain]) == []
        udp.bind(("", 7499 + 250 * domain))
        assert domains_in_use([domain]) == [domain]
