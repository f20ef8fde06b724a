"""The doctor's probes, each with good and bad answers. test_hostile_names.py runs the whole command."""

from unittest.mock import Mock

import pytest

from tutorial.commands import doctor
from tutorial.commands.doctor import RANGE, ask
from tutorial.errors import TutorialError

JAZZY, RCLPY = {"ROS_DISTRO": "jazzy"}, ["7.1.3", "/opt/ros/jazzy/lib/rclpy/__init__.py", "rmw_fastrtps_cpp"]
ZENOH = [*RCLPY[:2], "rmw_zenoh_cpp"]
LIBCRYPTO, VULKAN = TutorialError("ImportError: libcrypto.so.3"), TutorialError("MUJOCO_GL is odd")
OTHERS = "nodes on this network"


@pytest.mark.parametrize(
    ("probe", "kind", "answer", "environment", "level", "said", "fix"),
    [
        ("mujoco", "pocket", LIBCRYPTO, {}, "problem", "libcrypto", "pip install --force-reinstall mujoco"),
        ("mujoco", "pocket", VULKAN, {}, "problem", "cannot be imported: MUJOCO_GL is odd", "unset MUJOCO_GL"),
        ("mujoco", "pocket", ["4.0", ["no EGL", "libegl1"]], {}, "note", "works except cameras: no EGL", "libegl1"),
        ("mujoco", "pocket", ["4.0", None], {}, "ok", "4.0, which can render", ""),
        ("backend", "pocket", RCLPY, {}, "ok", "the pocket ROS 2, on Cyclone DDS, because this Python finds no", ""),
        ("backend", "pocket", RCLPY, JAZZY | {"TUTORIAL_ROS": "pocket"}, "ok", "because TUTORIAL_ROS=pocket", ""),
        ("backend", "pocket", LIBCRYPTO, {}, "problem", "libcrypto", "cyclonedds"),
        ("backend", "pocket", RCLPY, JAZZY, "note", "ROS 2 jazzy is set up", "--system-site-packages"),
        ("backend", "sourced", RCLPY, JAZZY, "ok", "ROS 2 jazzy, because this Python finds it: rclpy 7.1.3, /opt", ""),
        ("backend", "sourced", RCLPY, {"ROS_DISTRO": "humble"}, "note", "written for Jazzy", f". {__file__}"),
        ("backend", "folder", RCLPY, {}, "ok", "the real ROS 2 from tank ros install", ""),
        ("backend", "folder", LIBCRYPTO, {}, "problem", "broken: ImportError: libcrypto", "tank ros remove, then"),
        ("backend", "pixi", RCLPY, JAZZY, "ok", "ROS 2 jazzy from RoboStack, because this Python finds it", ""),
        ("backend", "pixi", LIBCRYPTO, JAZZY, "problem", "broken: ImportError: libcrypto", "pixi run doctor"),
        ("backend", "sourced", ZENOH, JAZZY, "note", "does not use DDS", "export RMW_IMPLEMENTATION="),
        ("backend", "sourced", LIBCRYPTO, JAZZY, "problem", "broken: ImportError: libcrypto", "TUTORIAL_ROS=pocket"),
        ("discovery", "pocket", 0, {}, "ok", "LOCALHOST: nodes on this machine only", ""),
        ("discovery", "sourced", 0, {}, "note", f"SUBNET: all {OTHERS}", "=LOCALHOST"),
        ("discovery", "pocket", 0, {RANGE: "LOCAL"}, "problem", "Did you mean 'LOCALHOST'?", f"unset {RANGE}"),
        ("discovery", "pocket", 0, {"CYCLONEDDS_URI": "x"}, "note", "; CYCLONEDDS_URI is 'x'", "unset CYCLONEDDS_URI"),
        ("domain", "pocket", [], {"ROS_DOMAIN_ID": ""}, "ok", "in domain 0: no other nodes", ""),
        ("domain", "pocket", ["/t", "/j", "/t"], {}, "note", "/j, 2 x /t. Nodes with the same", "__node:=viewer"),
        ("domain", "pocket", LIBCRYPTO, {}, "problem", "cannot create a node in domain 0: ImportError", "ROS 2"),
    ],
)
def test_each_probe_reports_what_it_finds(monkeypatch, probe, kind, answer, environment, level, said, fix):
    monkeypatch.setattr(doctor.os, "environ", environment)
    monkeypatch.setattr(doctor, "ask", Mock(side_effect=[answer]))  # instead of starting a process
    monkeypatch.setattr(doctor, "ros_backend", lambda: "pocket" if kind == "pocket" else "rclpy")
    monkeypatch.setattr(doctor, "_kind", lambda: kind)
    monkeypatch.setattr(doctor, "SETUP", __file__)
    found = getattr(doctor, probe)()
    assert found.level == level
    assert said in found.text
    assert fix in found.fix
    assert bool(found.fix) == (level != "ok")


def test_loopback_down(monkeypatch):
    monkeypatch.setattr(doctor, "loopback_is_up", lambda: False)
    found = doctor.discovery()
    assert (found.level, found.fix) == ("problem", doctor.TURN_ON)
    assert "the loopback interface (127.0.0.1) is down" in found.text


def test_output_has_columns_and_a_failed_probe_does_not_stop_the_rest(monkeypatch, capsys):
    found = doctor.Diagnosis("problem", f"{'word ' * 30}{'/long' * 30}", "export ROS_DOMAIN_ID=42")
    probes = {"ROS 2": lambda: found, "broken": lambda: 1 / 0, "Python": doctor.PROBES["Python"]}
    monkeypatch.setattr(doctor, "PROBES", probes)
    assert doctor.doctor() == 1
    first, second, third, fix, broken, _, python, *_, last = capsys.readouterr().out.splitlines()
    assert first.startswith("ROS 2      problem  word")
    assert second.startswith(" " * 20 + "word")
    assert max(map(len, (first, second))) <= 100
    assert third == " " * 20 + "/long" * 30
    assert fix == " " * 17 + "-> export ROS_DOMAIN_ID=42"
    assert broken == "broken     note     the check failed: ZeroDivisionError: division by zero"
    assert python.startswith("Python     ok ")
    assert last == "problems: 1, notes: 1"


@pytest.mark.process
@pytest.mark.parametrize(
    ("module", "timeout", "said"),
    [
        ("import os; os.abort()", 45, "crashed with SIGABRT"),
        ("1 / 0", 45, "ZeroDivisionError"),
        ("raise SystemExit(3)", 45, "exit status 3"),
        ("import time; time.sleep(60)", 0.1, r"no answer within 0\.1 s"),
    ],
)
def test_a_crashed_or_hanging_probe_is_reported(tmp_path, monkeypatch, module, timeout, said):
    (tmp_path / "mujoco.py").write_text(module)
    monkeypatch.setenv("PYTHONPATH", str(tmp_path))
    with pytest.raises(TutorialError, match=said):
        ask(doctor._mujoco, timeout)
