"""The doctor: each probe with what is well and what is not, and the whole command in a process of its own."""

from __future__ import annotations

import os
import re
import signal
import socket
import subprocess
import sys
import threading
import tomllib
from collections.abc import Iterator
from contextlib import closing, contextmanager
from dataclasses import replace

import psutil
import pytest
from kernels import kernel
from packaging.specifiers import SpecifierSet
from programs import TANK, until

from tutorial.commands.doctor.contained import UnansweredError, ask
from tutorial.commands.doctor.examination import examine
from tutorial.commands.doctor.finding import Finding, layout, summary
from tutorial.commands.doctor.installation import (
    NEWEST,
    OLDEST,
    jupyter,
    mujoco,
    packages,
    python,
    python_home,
    rendering,
)
from tutorial.commands.doctor.processes import (
    FIRST_PORT,
    PORTS,
    Listener,
    Process,
    is_orphan,
    listeners,
    ports,
    processes,
    running,
    title,
)
from tutorial.commands.doctor.ros import LAST_SAFE_DOMAIN, backend, discovery, domain, nodes
from tutorial.commands.lab import lab_command
from tutorial.errors import TutorialError
from tutorial.paths import HOME
from tutorial.ros import domains
from tutorial.ros.node_thread import NodeThread
from tutorial.view import web

JAZZY = {"version": "7.1.3", "file": "/opt/ros/jazzy/lib/rclpy/__init__.py", "rmw": "rmw_fastrtps_cpp"}
MINE = Process(pid=12, user="ann", is_mine=True, is_orphan=False, age=300.0, command=("tank", "joy"))


def only(findings) -> Finding:
    """The finding of a probe that has one."""
    (finding,) = findings
    return finding


def answers(answer):
    """Stand in for a process that answers."""
    return lambda _question, _environment: answer


def is_jazzy(_question, _environment):
    return JAZZY


def fails(_question, _environment):
    raise UnansweredError("ImportError: libcrypto.so.3")


@pytest.mark.parametrize(
    ("version", "home", "level"),
    [
        ((3, 10, 4), "in a virtual environment", "problem"),
        ((3, 11, 0), "in a virtual environment", "ok"),
        ((3, 13, 9), "in a conda environment", "ok"),
        ((3, 14, 0), "in a virtual environment", "problem"),
        ((3, 12, 3), "", "note"),
    ],
)
def test_python(version, home, level):
    finding = only(python(version, "/usr/bin/python3", home))
    assert finding.level == level
    assert "/usr/bin/python3" in finding.text
    assert (home or "not in a virtual environment") in finding.text


def test_where_a_python_is_at_home(tmp_path):
    assert python_home("/home/ann/.venv", "/usr") == "in a virtual environment"
    assert python_home(str(tmp_path), str(tmp_path)) == ""
    (tmp_path / "conda-meta").mkdir()
    assert python_home(str(tmp_path), str(tmp_path)) == "in a conda environment"


def test_mujoco_is_imported_elsewhere():
    assert only(mujoco(os.environ, ask)).level == "ok"


def test_a_mujoco_that_does_not_import_is_a_problem():
    finding = only(mujoco({**os.environ, "MUJOCO_GL": "vulkan"}, ask))
    assert (finding.level, finding.mend) == ("problem", "unset MUJOCO_GL")
    assert "vulkan" in finding.text
    assert only(mujoco({}, fails)).mend == "python -m pip install --force-reinstall mujoco"


@pytest.mark.parametrize(
    ("chosen", "good", "level", "said"),
    [
        ("", ("egl", "glfw"), "ok", "off the screen with egl, glfw of egl, osmesa, glfw; MUJOCO_GL is not set"),
        ("egl", ("egl",), "ok", "MUJOCO_GL is egl"),
        ("osmesa", ("egl",), "note", "but MUJOCO_GL is osmesa"),
        ("", (), "note", "none of egl, osmesa, glfw draws"),
    ],
)
def test_rendering(chosen, good, level, said):
    def draws(_question, environment):
        if environment["MUJOCO_GL"] not in good:
            raise UnansweredError("crashed with SIGSEGV")
        return True

    finding = only(rendering({"MUJOCO_GL": chosen}, draws, ("egl", "osmesa", "glfw")))
    assert finding.level == level
    assert said in finding.text
    assert "mujoco.Renderer" in finding.text


REQUIRED = [
    "numpy>=2",
    "nowhere; platform_system == 'None'",
    "pygame-ce>=2.5; extra == 'gamepad'",
    "pytest; extra == 'test'",
]


def test_packages_that_are_there():
    finding = only(packages(REQUIRED, {"numpy": "2.4.6", "pygame-ce": "2.5.8"}.get))
    assert finding == Finding("packages", "ok", "all 1 that the tutorial requires")


@pytest.mark.parametrize(
    ("there", "said"),
    [({}, "missing or too old: numpy"), ({"numpy": "1.26.4"}, "numpy 1.26.4 (needs >=2)")],
)
def test_packages_that_are_missing_or_too_old(there, said):
    finding = next(iter(packages(REQUIRED, there.get)))
    assert finding.level == "problem"
    assert said in finding.text
    assert finding.mend == "python -m pip install 'numpy>=2'"


def test_without_the_gamepads_package_a_note():
    _, finding = packages(REQUIRED, {"numpy": "2.4.6"}.get)
    assert (finding.level, finding.mend) == ("note", "python -m pip install 'pygame-ce>=2.5'")


def test_a_tutorial_that_is_not_installed():
    assert only(packages(None, {}.get)).level == "note"


def test_jupyter(tmp_path):
    versions = {"jupyterlab": "4.6.6", "ipykernel": "7.4.0", "ipywidgets": "8.1.9", "anywidget": "0.11.0"}
    finding = only(jupyter(versions.get, [tmp_path]))
    assert finding.level == "problem"
    assert finding.mend == "python -m pip install --force-reinstall jupyterlab_widgets anywidget"
    for name in ("anywidget", "@jupyter-widgets/jupyterlab-manager"):
        (tmp_path / name).mkdir(parents=True)
    finding = only(jupyter(versions.get, [tmp_path / "nowhere", tmp_path]))
    assert (finding.level, finding.text.split(",")[0]) == ("ok", "jupyterlab 4.6.6")
    del versions["anywidget"]
    finding = only(jupyter(versions.get, [tmp_path]))
    assert (finding.level, finding.mend) == ("problem", "python -m pip install anywidget")


def chosen(environment, choice="rclpy", is_there=True, answer=is_jazzy):
    return only(backend(environment, lambda: choice, lambda: is_there, answer))


def test_the_tutorials_own_ros_2():
    finding = chosen({}, "underlay")
    assert finding.level == "ok"
    assert finding.text.endswith("because this Python finds no rclpy")
    assert chosen({"TUTORIAL_ROS": "underlay", "ROS_DISTRO": "jazzy"}, "underlay").text.endswith(
        "TUTORIAL_ROS=underlay"
    )


def test_the_tutorials_own_ros_2_that_does_not_start():
    finding = chosen({}, "underlay", answer=fails)
    assert finding.level == "problem"
    assert "libcrypto" in finding.text
    assert "cyclonedds" in finding.mend


def test_a_ros_2_that_is_set_up_but_not_found():
    finding = chosen({"ROS_DISTRO": "jazzy"}, "underlay")
    assert finding.level == "note"
    assert "ROS 2 jazzy is set up" in finding.text
    assert "--system-site-packages" in finding.mend


def test_a_real_ros_2():
    finding = chosen({"ROS_DISTRO": "jazzy"})
    assert finding.level == "ok"
    assert finding.text == (
        "ROS 2 jazzy, because this Python finds it: rclpy 7.1.3, /opt/ros/jazzy/lib/rclpy/__init__.py, "
        "on rmw_fastrtps_cpp (the default)"
    )
    finding = chosen({"ROS_DISTRO": "jazzy", "TUTORIAL_ROS": "rclpy", "RMW_IMPLEMENTATION": "rmw_fastrtps_cpp"})
    assert "because TUTORIAL_ROS=rclpy:" in finding.text
    assert finding.text.endswith("(RMW_IMPLEMENTATION)")


@pytest.mark.parametrize(
    ("environment", "answer", "said", "mend"),
    [
        ({"ROS_DISTRO": "humble"}, JAZZY, "made for jazzy", ". /opt/ros/jazzy/setup.bash"),
        ({"ROS_DISTRO": "jazzy"}, JAZZY | {"rmw": "rmw_zenoh_cpp"}, "does not speak DDS", "export RMW_IMPLEMENTATION="),
    ],
)
def test_a_real_ros_2_that_may_surprise(environment, answer, said, mend):
    finding = chosen(environment, answer=answers(answer))
    assert finding.level == "note"
    assert said in finding.text
    assert finding.mend.startswith(mend)


def test_a_real_ros_2_that_is_broken():
    finding = chosen({"ROS_DISTRO": "jazzy"}, answer=fails)
    assert finding.level == "problem"
    assert "there is a real rclpy, and it is broken: ImportError: libcrypto.so.3" in finding.text
    assert "export TUTORIAL_ROS=underlay" in finding.mend


def test_a_real_ros_2_that_is_asked_for_and_not_there():
    finding = chosen({"TUTORIAL_ROS": "rclpy"}, is_there=False)
    assert finding.level == "problem"
    assert "finds no rclpy" in finding.text


def test_nonsense_in_tutorial_ros():
    def choose():
        raise TutorialError("TUTORIAL_ROS is 'ros2'.")

    finding = only(backend({}, choose, lambda: False, fails))
    assert finding == Finding("ROS 2", "problem", "TUTORIAL_ROS is 'ros2'.", "unset TUTORIAL_ROS")


@pytest.mark.parametrize(
    ("given", "is_real", "level", "said", "mend"),
    [
        (None, False, "ok", "nodes on this machine only (LOCALHOST, the default)", ""),
        (None, True, "note", "all machines of this network (SUBNET, the default)", "=LOCALHOST"),
        ("LOCALHOST", True, "ok", "this machine only (ROS_AUTOMATIC_DISCOVERY_RANGE is LOCALHOST)", ""),
        ("SUBNET", False, "note", "all machines of this network", ": unset ROS_AUTOMATIC_DISCOVERY_RANGE"),
        ("OFF", False, "note", "no other node, not even on this machine", ": unset ROS_AUTOMATIC_DISCOVERY_RANGE"),
        ("SYSTEM_DEFAULT", True, "note", "what the middleware is configured for", "=LOCALHOST"),
        ("LOCAL", False, "problem", "Did you mean 'LOCALHOST'?", "unset ROS_AUTOMATIC_DISCOVERY_RANGE"),
    ],
)
def test_discovery(given, is_real, level, said, mend):
    environment = {} if given is None else {"ROS_AUTOMATIC_DISCOVERY_RANGE": given}
    finding = only(discovery(environment, is_real))
    assert finding.level == level
    assert said in finding.text
    assert mend in finding.mend


@pytest.mark.parametrize("name", ["ROS_STATIC_PEERS", "CYCLONEDDS_URI", "ROS_LOCALHOST_ONLY"])
def test_what_else_was_set_by_hand(name):
    _, finding = discovery({name: "10.0.0.7" * 20}, is_real=False)
    assert (finding.level, finding.mend) == ("note", f"if it is not meant: unset {name}")
    assert finding.text.startswith(f"{name} is '10.0.0.7")
    assert len(finding.text) < 160


@pytest.mark.parametrize(
    ("given", "level", "said"),
    [
        ("", "ok", "0 (the default"),
        ("42", "ok", "42 (ROS_DOMAIN_ID)"),
        ("101", "ok", "101"),
        ("102", "note", "its ports, from 32900 on"),
        ("233", "problem", "ROS_DOMAIN_ID is '233', and must be a number from 0 to 232"),
        ("-1", "problem", "'-1'"),
        ("one", "problem", "'one'"),
    ],
)
def test_domain(given, level, said):
    finding = only(domain({"ROS_DOMAIN_ID": given}))
    assert finding.level == level
    assert said in finding.text


@pytest.mark.parametrize(
    ("names", "settled", "level", "said"),
    [
        ([], True, "ok", "in domain 7: nobody else"),
        (["/viewer", "/joy"], True, "ok", "in domain 7: /joy, /viewer"),
        (["/tank", "/joy", "/tank"], True, "note", "in domain 7: /joy, 2 x /tank. Nodes of one name"),
        (["/joy"], False, "note", "in domain 7: /joy. Some still come or go"),
        ([f"/{i}" for i in range(2000)], True, "ok", "and 1,950 more"),
    ],
)
def test_nodes(names, settled, level, said):
    finding = only(nodes({"ROS_DOMAIN_ID": "7"}, answers({"nodes": names, "settled": settled})))
    assert finding.level == level
    assert said in finding.text


def test_nodes_that_cannot_be_asked():
    assert only(nodes({"ROS_DOMAIN_ID": "x"}, fails)).level == "note"
    finding = only(nodes({}, fails))
    assert finding.level == "problem"
    assert "a node cannot be made: ImportError" in finding.text


@pytest.mark.parametrize(
    ("command", "said"),
    [
        (("/v/bin/python", "/v/bin/tank", "run", "step2", "--headless"), "tank run step2 --headless"),
        (("/v/bin/python3.12", "-u", "-X", "dev", "-m", "tutorial", "joy"), "tank joy"),
        (("tank", "launch", "x" * 100), f"tank launch {'x' * 45}..."),
        (("tank", "run", "\x1b[31m\udce4.yaml"), "tank run ?[31m?.yaml"),
        (("python", "-P", "-u", "-m", "tutorial.checks._child", "5"), "the check of an exercise"),
        (("python", "-S", "-I", "/x/tutorial/commands/lifeline.py", "9", "/v/bin/tank", "joy"), "lifeline of tank joy"),
        (tuple(lab_command()), "tank lab"),
        ((sys.executable, "-m", "ipykernel_launcher", "-f", "k.json"), "a notebook's kernel"),
        (("/other/bin/python", "-m", "ipykernel_launcher", "-f", "k.json"), None),
        (("/v/bin/python", "/v/bin/tank", "doctor"), None),
        (("/v/bin/python", "/v/bin/tank", "--help"), None),
        (("vim", "/x/tank", "run"), None),
        (("python", "-m", "jupyterlab"), None),
        (("python",), None),
        ((), None),
    ],
)
def test_which_command_lines_are_the_tutorials(command, said):
    assert title(command) == said


def test_no_process_of_the_tutorials():
    assert only(processes([replace(MINE, command=("bash", "-l"))])).level == "ok"


def test_processes_and_what_is_left_over():
    hers = replace(MINE, is_mine=False, user="eve")
    found = [MINE, replace(MINE, pid=13, is_orphan=True, age=7200), hers, replace(hers, pid=14, is_orphan=True), hers]
    mine, mine_left, hers_left, others = processes(found)
    assert mine == Finding("processes", "ok", "tank joy: pid 12, for 5 min")
    text = "tank joy: pid 13, for 2 h; what started it is gone"
    assert mine_left == Finding("processes", "problem", text, "kill 13")
    assert (hers_left.level, hers_left.mend) == ("note", "ask eve to: kill 14")
    assert others == Finding("processes", "ok", "2 of the tutorial's belong to other users")


def test_who_is_an_orphan():
    assert is_orphan(1, "tini", None)
    assert is_orphan(900, "systemd", None)
    assert not is_orphan(900, "bash", None)
    assert not is_orphan(1, "bash", "/dev/pts/0")


def test_a_kernel_is_found_and_is_no_orphan():
    with kernel() as running_kernel:
        seen = [process for process in running() if process.pid == running_kernel.process.pid]
    assert title(only(seen).command) == "a notebook's kernel"
    assert only(seen).is_mine
    assert not only(seen).is_orphan


def test_ports():
    finding = only(ports([]))
    assert finding == Finding("ports", "ok", "the next 3D view of tank run is on 7000")
    taken = [Listener(7001, None, ""), Listener(7000, 12, "tank run step2"), Listener(8888, 5, "jupyter")]
    first, second, free = ports(taken)
    assert first.text == "7000 is taken by tank run step2, pid 12"
    assert second.text == "7001 is taken by a process of another user"
    assert free.text == "the next 3D view of tank run is on 7002"


def test_all_ports_taken():
    *_, finding = ports([Listener(7000 + n, 12, "x") for n in range(100)])
    assert finding.level == "problem"
    assert "--port" in finding.mend


def test_a_port_that_this_process_listens_on_and_one_that_it_only_uses():
    with socket.create_server(("127.0.0.1", 0)) as server, socket.create_connection(server.getsockname()) as client:
        port, used = server.getsockname()[1], client.getsockname()[1]
        assert [each.pid for each in listeners() if each.port == port] == [os.getpid()]
        assert used not in [each.port for each in listeners()]
    assert port not in [each.port for each in listeners()]


def test_the_doctor_knows_what_the_rest_of_the_house_has():
    python_range = SpecifierSet(tomllib.loads((HOME / "pyproject.toml").read_text())["project"]["requires-python"])
    assert [minor for minor in range(30) if f"3.{minor}.0" in python_range] == [11, 12, 13]
    assert (OLDEST, NEWEST) == ((3, 11), (3, 13))
    assert (FIRST_PORT, PORTS) == (web.FIRST_PORT, web.PORTS_TRIED)
    assert LAST_SAFE_DOMAIN == domains.LAST


def test_a_problem_without_a_mend_is_a_defect():
    with pytest.raises(ValueError, match="a note says its mend: 'odd' has none"):
        Finding("Python", "note", "odd")


def test_a_finding_stands_in_columns():
    finding = Finding("ROS 2", "note", "word " * 30, "export ROS_DOMAIN_ID=42")
    first, second, mend = layout(finding).splitlines()
    assert first.startswith("ROS 2      note     word")
    assert second.startswith(" " * 20 + "word")
    assert mend == " " * 20 + "-> export ROS_DOMAIN_ID=42"
    assert max(map(len, (first, second))) <= 100


def test_the_summary_counts():
    assert summary([]) == "no problems, no notes."
    assert summary([Finding("a", "problem", "b", "c"), *[Finding("a", "note", "b", "c")] * 2]) == "1 problem, 2 notes."


def test_a_probe_that_fails_is_a_finding():
    def broken():
        yield Finding("first", "ok", "fine")
        raise ValueError("odd")

    def lacking():
        raise ModuleNotFoundError("No module named 'psutil'", name="psutil")

    first, second = map(only, examine({"first": broken, "second": lacking}))
    assert (first.level, first.text) == ("note", "it could not be looked at: ValueError: odd")
    assert (second.level, second.mend) == ("note", "python -m pip install psutil")


def test_a_probe_that_takes_too_long_is_given_up():
    release = threading.Event()
    slow, quick = examine({"slow": lambda: [release.wait()], "quick": lambda: [Finding("quick", "ok", "x")]}, 0.5)
    release.set()
    assert (only(slow).level, only(slow).text) == ("note", "it takes too long to look")
    assert only(quick).level == "ok"


def test_what_crashes_elsewhere_is_only_an_answer_that_does_not_come(tmp_path):
    (tmp_path / "mujoco.py").write_text("import os, signal\nos.kill(os.getpid(), signal.SIGSEGV)\n")
    with pytest.raises(UnansweredError, match="crashed with SIGSEGV"):
        ask("mujoco", {**os.environ, "PYTHONPATH": str(tmp_path)})
    (tmp_path / "mujoco.py").write_text("import time\ntime.sleep(600)\n")
    with pytest.raises(UnansweredError, match=r"no answer within 0\.5 s"):
        ask("mujoco", {**os.environ, "PYTHONPATH": str(tmp_path)}, patience=0.5)


def test_rclpy_is_imported_elsewhere():
    assert ask("rclpy", os.environ)["rmw"].startswith("rmw_")


def examined(**environment: str) -> subprocess.CompletedProcess[str]:
    """Run the whole command."""
    process = subprocess.run(
        [TANK, "doctor"], env={**os.environ, **environment}, capture_output=True, text=True, timeout=110, check=False
    )
    assert process.stderr == ""
    return process


@contextmanager
def orphan() -> Iterator[int]:
    """A ``tank joy`` whose parent has gone; its pid."""
    script = f"'{TANK}' joy </dev/null >/dev/null 2>&1 & echo $!"
    pid = int(subprocess.run(["sh", "-c", script], stdout=subprocess.PIPE, text=True, check=True).stdout)
    try:
        until(lambda: title(psutil.Process(pid).cmdline()) == "tank joy", "the program's own command line")
        yield pid
    finally:
        os.kill(pid, signal.SIGKILL)
        until(lambda: not psutil.pid_exists(pid), "its end")


@contextmanager
def taken_port() -> Iterator[int]:
    """The first of the 3D view's ports that is free, taken."""
    for port in range(7000, 7100):
        try:
            server = socket.create_server(("127.0.0.1", port))
        except OSError:
            continue
        with server:
            yield port
        return
    pytest.fail("no port is free")


def test_the_whole_command(domain):
    def has_met_the_twins():
        runs.append(examined())
        return "2 x /twin" in runs[-1].stdout

    runs: list[subprocess.CompletedProcess[str]] = []
    with closing(NodeThread("twin")), closing(NodeThread("twin")), orphan() as left_over, taken_port() as port:
        until(has_met_the_twins, "the twins")
    said = runs[-1].stdout
    assert runs[-1].returncode == 1
    assert re.search(rf"^nodes +note +in domain {domain}: .*2 x /twin", said, re.MULTILINE)
    assert "_doctor" not in said
    assert re.search(
        rf"^processes +problem +tank joy: pid {left_over}, for \d+ s; what started it is gone$", said, re.M
    )
    assert f"-> kill {left_over}\n" in said
    assert re.search(rf"^ports +ok +{port} is taken by .+, pid {os.getpid()}$", said, re.MULTILINE)
    assert [line.split()[0] for line in said.splitlines() if line[:1].isupper()][:2] == ["Python", "MuJoCo"]
    assert all(len(line) <= 100 or len(line.split()) == 1 for line in said.splitlines()), "a long path stands alone"


def test_the_whole_command_with_a_broken_rclpy(domain, tmp_path):
    (tmp_path / "rclpy").mkdir()
    (tmp_path / "rclpy" / "__init__.py").write_text("raise ImportError('no librcl_action.so')\n")
    process = examined(PYTHONPATH=str(tmp_path), TUTORIAL_ROS="")
    assert process.returncode == 1
    assert "there is a real rclpy, and it is broken: ImportError: no librcl_action.so" in " ".join(
        process.stdout.split()
    )
    assert "Traceback" not in process.stdout


def test_the_whole_command_with_variables_that_are_wrong(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    process = examined(ROS_DOMAIN_ID="many", MUJOCO_GL="vulkan")
    assert process.returncode == 1
    assert "ROS_DOMAIN_ID is 'many'" in process.stdout
    assert "nobody was looked for" in process.stdout
    assert "-> unset MUJOCO_GL" in process.stdout


def test_the_whole_command_with_nonsense_in_tutorial_ros(domain):
    process = examined(TUTORIAL_ROS="ros2")
    assert process.returncode == 1
    assert "TUTORIAL_ROS is 'ros2'" in process.stdout
