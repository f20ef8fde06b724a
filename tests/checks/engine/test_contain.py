"""Answers that damage their own process, without any effect on the learner's."""

import asyncio
import contextlib
import ctypes
import io
import os
import subprocess
import sys
import time
from types import SimpleNamespace

import psutil
import pytest
from programs import until

from tutorial.checks.drive import GentleTank, drive
from tutorial.checks.engine.verdict import right
from tutorial.checks.exercise import Exercise
from tutorial.ros.domains import DOMAINS


def children(pid=None):
    """Return the judging child processes of a process, including those that have just ended."""
    with contextlib.suppress(psutil.NoSuchProcess):
        return [p for p in psutil.Process(pid).children() if p.status() != psutil.STATUS_ZOMBIE and _judges(p)]
    return []


def _judges(process):
    return (
        "tutorial.checks.engine.child" in process.cmdline()
    )  # compare whole arguments: a fork server's argument merely contains the name


def said_about(answer):
    """Return the output of a check, and make sure that its process has ended."""
    with contextlib.redirect_stdout(io.StringIO()) as text:
        asyncio.run(drive.check(answer))
    assert not children()
    return text.getvalue()


class TakesLong(GentleTank):
    def control(self):
        until = time.process_time() + 0.1
        while time.process_time() < until:
            pass


class EndsTheProcess(GentleTank):
    def control(self):
        os._exit(3)


class Crashes(GentleTank):
    def control(self):
        ctypes.string_at(0)


class Floods(GentleTank):
    def control(self):
        while True:
            print("here I am")


class HaltsPython(GentleTank):
    """Block all threads, including the watchdog."""

    def control(self):
        ctypes.PyDLL(None).sleep(3600)


ENDS = [
    (TakesLong, "✗ the calls to control take too long", "in control, line ", "return immediately"),
    (EndsTheProcess, "✗ the process exited with status 3", "as os._exit does", "only has to return"),
    (Crashes, "✗ the process was killed by the signal SIGSEGV", ": ctypes.string_at(0)", "library"),
    (Floods, "✗ control does not return", "  | here I am", "it needs no loop"),
    (HaltsPython, "✗ Python itself hangs", "in control, line", "A call into C code probably did not return"),
]


@pytest.mark.process
@pytest.mark.parametrize(("answer", "what", "where", "why"), ENDS, ids=lambda value: getattr(value, "__name__", ""))
def test_whatever_it_does_is_contained_and_explained(answer, what, where, why):
    said = said_about(answer)
    assert all(each in said for each in (what, where, why)), said
    assert len(said.splitlines()) < 40


NOTEBOOK = """
import asyncio
import threading
from sensor_msgs.msg import Joy
from tutorial.checks.drive import GentleTank
from tutorial.handoff import Latest

held = threading.Lock()
held.acquire()
reentrant = threading.RLock()
elsewhere = threading.Condition()
seen = Latest(Joy())

class TakesLocks(GentleTank):
    lock = threading.Lock()

    def on_joy(self, message):
        with held, reentrant, elsewhere, self.lock:
            seen.put(message)
            super().on_joy(message)

scene = (each for each in "scene")
joystick = {"buttons": scene}

class UsesAGlobal(GentleTank):
    def on_joy(self, message):
        self.joy.put(next(scene))

class UsesItInside(GentleTank):
    def control(self):
        return [joystick for _ in range(3)]

def make():
    closed_over = scene
    class UsesAClosure(GentleTank):
        def control(self):
            next(closed_over)
    return UsesAClosure

UsesAClosure = make()

class Keeps(GentleTank):
    scene = scene

loop = asyncio.new_event_loop()
loop.close()

class UsesTheLoop(GentleTank):
    def on_joy(self, message):
        loop.call_later(0.5, self.joy.put, message)
"""


def of_the_notebook(name):
    namespace = {"__name__": "__main__"}
    exec(NOTEBOOK, namespace)
    return namespace[name]


@pytest.mark.parametrize(
    ("name", "used", "kind"),
    [
        ("UsesAGlobal", "scene", "generator"),
        ("UsesItInside", "joystick", "dict"),
        ("UsesAClosure", "closed_over", "generator"),
        ("Keeps", "scene", "generator"),
    ],
)
def test_objects_of_the_notebook_are_named(name, used, kind):
    said = said_about(of_the_notebook(name))
    assert f"✗ {name} uses {used}, an object of the class {kind} that belongs to the notebook" in said
    assert "get everything that it needs from config, io or its arguments" in said


def test_the_notebooks_event_loop_is_replaced_by_the_running_one():
    said = said_about(of_the_notebook("UsesTheLoop"))
    assert "✗ UsesTheLoop uses loop, " in said
    assert "write asyncio.get_running_loop() instead" in said


@pytest.mark.process
def test_the_notebooks_locks_are_passed_on_unlocked():
    said = said_about(of_the_notebook("TakesLocks"))
    assert "All right." in said, said


class TellsItsDomain(GentleTank):
    def initialize(self, io):
        print("|".join(os.environ.get(name, "") for name in ("ROS_DOMAIN_ID", "ROS_AUTOMATIC_DISCOVERY_RANGE")))
        super().initialize(io)


@pytest.mark.process
def test_it_runs_in_a_different_ros_domain(domain, monkeypatch):
    monkeypatch.setenv("ROS_AUTOMATIC_DISCOVERY_RANGE", "SUBNET")
    said = next(line for line in said_about(TellsItsDomain).splitlines() if line.startswith("  | "))
    other, reach = said.removeprefix("  | ").split("|")
    assert int(other) in {*DOMAINS} - {domain}
    assert reach == "LOCALHOST"


class Anything:
    def method(self):
        return 1


TEXT = "Do.\n\nDo it.\n\nHint 1: Look.\n\nNotice it."


class Dozing(Exercise):
    def findings(self, answer, instruments):
        """Judge forever."""
        while True:
            time.sleep(0.1)
            yield right("still")


dozing = Dozing("dozing", TEXT, SimpleNamespace(solution=Anything))
PARENT = "import asyncio; from engine.test_contain import Anything, dozing; asyncio.run(dozing.check(Anything))"


@pytest.mark.process
def test_it_ends_when_its_parent_is_killed():
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join(filter(None, sys.path))}
    with subprocess.Popen([sys.executable, "-c", PARENT], env=environment) as parent:
        try:
            until(lambda: [each for each in children(parent.pid) if each.num_threads() > 1], "its watchdog")
            (child,) = children(parent.pid)
        finally:
            parent.kill()
    until(lambda: not child.is_running() or child.status() == psutil.STATUS_ZOMBIE, "its end")
