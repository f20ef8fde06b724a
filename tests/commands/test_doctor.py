"""The doctor: each probe with what is well and what is not, and the whole command in a process of its own."""

from __future__ import annotations

import re
import subprocess
from contextlib import closing

import pytest
from programs import TANK, until

from tutorial.commands import doctor
from tutorial.commands.doctor import RANGE, ask
from tutorial.errors import TutorialError
from tutorial.ros.node_thread import NodeThread

JAZZY, RCLPY = {"ROS_DISTRO": "jazzy"}, ["7.1.3", "/opt/ros/jazzy/lib/rclpy/__init__.py", "rmw_fastrtps_cpp"]
ZENOH = [*RCLPY[:2], "rmw_zenoh_cpp"]
LIBCRYPTO, VULKAN = TutorialError("ImportError: libcrypto.so.3"), TutorialError("MUJOCO_GL is odd")
NO_RCLPY = TutorialError("ModuleNotFoundError: No module named 'rclpy'")
OTHERS = "all machines of this network"


@pytest.fixture
def machine(monkeypatch):
    """Set up a machine: its variables, whether it has a real rclpy, and what a process of its own answers."""

    def machine(is_real, answer, **environment):
        def answered(_question):
            if isinstance(answer, Exception):
                raise answer
            return answer

        for name in ("TUTORIAL_ROS", "ROS_DISTRO", "ROS_DOMAIN_ID", *doctor.BY_HAND, RANGE):
            monkeypatch.delenv(name, raising=False)
        for name, value in environment.items():
            monkeypatch.setenv(name, value)
        monkeypatch.setattr(doctor, "ask", answered)
        wanted = environment.get("TUTORIAL_ROS", "rclpy" if is_real else "pocket")
        monkeypatch.setattr(doctor, "ros_backend", lambda: wanted)

    return machine


@pytest.mark.parametrize(
    ("probe", "is_real", "answer", "environment", "level", "said", "mend"),
    [
        ("mujoco", False, LIBCRYPTO, {}, "problem", "libcrypto", "pip install --force-reinstall mujoco"),
        ("mujoco", False, VULKAN, {}, "problem", "cannot be imported: MUJOCO_GL is odd", "unset MUJOCO_GL"),
        (
            "mujoco",
            False,
            ["4.0", ["no EGL", "libegl1"]],
            {},
            "note",
            "take no pictures, all else works: no",
            "libegl1",
        ),
        ("mujoco", False, ["4.0", None], {}, "ok", "4.0, which renders", ""),
        ("backend", False, RCLPY, {}, "ok", "the pocket ROS 2, on Cyclone DDS, because this Python finds no", ""),
        ("backend", False, RCLPY, JAZZY | {"TUTORIAL_ROS": "pocket"}, "ok", "because TUTORIAL_ROS=pocket", ""),
        ("backend", False, LIBCRYPTO, {}, "problem", "libcrypto", "cyclonedds"),
        ("backend", False, RCLPY, JAZZY, "note", "ROS 2 jazzy is set up", "--system-site-packages"),
        ("backend", True, RCLPY, JAZZY, "ok", "ROS 2 jazzy, because this Python finds it: rclpy 7.1.3, /opt", ""),
        ("backend", True, RCLPY, {"ROS_DISTRO": "humble"}, "note", "made for jazzy", ". /opt/ros/jazzy/setup.bash"),
        ("backend", True, ZENOH, JAZZY, "note", "does not speak DDS", "export RMW_IMPLEMENTATION="),
        ("backend", True, LIBCRYPTO, JAZZY, "problem", "broken: ImportError: libcrypto", "TUTORIAL_ROS=pocket"),
        ("backend", False, NO_RCLPY, {"TUTORIAL_ROS": "rclpy"}, "problem", "No module named", "setup.bash"),
        ("discovery", False, 0, {}, "ok", "LOCALHOST: nodes on this machine only", ""),
        ("discovery", True, 0, {}, "note", f"SUBNET: nodes on {OTHERS}", "=LOCALHOST"),
        ("discovery", False, 0, {RANGE: "SUBNET"}, "note", OTHERS, f": export {RANGE}="),
        ("discovery", False, 0, {RANGE: "LOCAL"}, "problem", "Did you mean 'LOCALHOST'?", f"unset {RANGE}"),
        ("discovery", False, 0, {"CYCLONEDDS_URI": "x"}, "note", "; CYCLONEDDS_URI is 'x'", "unset CYCLONEDDS_URI"),
        ("domain", False, [], {"ROS_DOMAIN_ID": ""}, "ok", "in domain 0: nobody else", ""),
        ("domain", False, ["/viewer", "/joy"], {}, "ok", "in domain 0: /joy, /viewer", ""),
        ("domain", False, ["/t", "/j", "/t"], {}, "note", "/j, 2 x /t. Nodes of one name", "__node:=viewer"),
        ("domain", False, LIBCRYPTO, {}, "problem", "a node cannot be made in domain 0: ImportError", "ROS 2"),
    ],
)
def test_what_there_is_is_found(machine, probe, is_real, answer, environment, level, said, mend):
    machine(is_real, answer, **environment)
    found = getattr(doctor, probe)()
    assert found.level == level
    assert said in found.text
    assert mend in found.mend
    assert bool(found.mend) == (level != "ok")


def test_it_stands_in_columns_and_no_word_is_broken(monkeypatch, capsys):
    found = doctor.Diagnosis("note", f"{'word ' * 30}{'/long' * 30}", "export ROS_DOMAIN_ID=42")
    monkeypatch.setattr(doctor, "PROBES", {"ROS 2": lambda: found})
    doctor.doctor()
    first, second, third, mend, *_ = capsys.readouterr().out.splitlines()
    assert first.startswith("ROS 2      note     word")
    assert second.startswith(" " * 20 + "word")
    assert max(map(len, (first, second))) <= 100
    assert third == " " * 20 + "/long" * 30
    assert mend == " " * 17 + "-> export ROS_DOMAIN_ID=42"


def test_a_probe_that_fails_is_told_and_the_others_go_on(monkeypatch, capsys):
    monkeypatch.setattr(doctor, "PROBES", {"broken": lambda: 1 / 0, "Python": doctor.PROBES["Python"]})
    assert doctor.doctor() == 0
    said = capsys.readouterr().out
    assert "broken     note     it could not be looked at: ZeroDivisionError" in said
    assert "\nPython     ok " in said
    assert said.endswith("\nproblems: 0, notes: 1\n")


@pytest.mark.process
@pytest.mark.parametrize(
    ("module", "patience", "said"),
    [
        ("import os; os.abort()", 45, "crashed with SIGABRT"),
        ("1 / 0", 45, "ZeroDivisionError"),
        ("raise SystemExit(3)", 45, "exit status 3"),
        ("import time; time.sleep(60)", 0.1, r"no answer within 0\.1 s"),
    ],
)
def test_what_goes_wrong_elsewhere_is_only_an_answer_that_does_not_come(tmp_path, monkeypatch, module, patience, said):
    (tmp_path / "mujoco.py").write_text(module)
    monkeypatch.setenv("PYTHONPATH", str(tmp_path))
    with pytest.raises(TutorialError, match=said):
        ask(doctor._mujoco, patience)


def examined() -> tuple[int, str]:
    """Run the whole command."""
    done = subprocess.run([TANK, "doctor"], capture_output=True, text=True, timeout=110, check=False)
    assert done.stderr == ""
    return done.returncode, done.stdout


@pytest.mark.process
def test_the_whole_command(domain):
    runs: list[tuple[int, str]] = []
    with closing(NodeThread("twin")), closing(NodeThread("twin")):
        until(lambda: runs.append(examined()) or "2 x /twin" in runs[-1][1], "the twins")
    status, said = runs[-1]
    assert re.search(rf"^domain +note +in domain {domain}: .*2 x /twin", said, re.MULTILINE), said
    assert re.search(r"^packages +ok ", said, re.MULTILINE), said
    assert (status, "_doctor" in said) == (" problem " in said, False)
