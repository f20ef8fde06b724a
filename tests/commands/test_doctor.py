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
from contextlib import closing
from dataclasses import replace
from unittest.mock import Mock

import psutil
import pytest
from packaging.specifiers import SpecifierSet
from programs import TANK, until

from tutorial.commands.doctor import examination
from tutorial.commands.doctor.contained import UnansweredError, ask
from tutorial.commands.doctor.examination import examine
from tutorial.commands.doctor.finding import Finding, layout, summary
from tutorial.commands.doctor.installation import jupyter, mujoco, packages, python, python_home, rendering
from tutorial.commands.doctor.processes import Listener, Process, is_orphan, listeners, ports, processes, running, title
from tutorial.commands.doctor.ros import backend, discovery, domain, nodes
from tutorial.commands.lab import lab_command
from tutorial.errors import TutorialError
from tutorial.paths import HOME
from tutorial.ros import domains
from tutorial.ros.node_thread import NodeThread
from tutorial.view import web

HERE = "/usr/bin/python3"
VENV = "in a virtual environment"
JAZZY = {"version": "7.1.3", "file": "/opt/ros/jazzy/lib/rclpy/__init__.py", "rmw": "rmw_fastrtps_cpp"}
ZENOH, DISTRO = JAZZY | {"rmw": "rmw_zenoh_cpp"}, {"ROS_DISTRO": "jazzy"}
BROKEN = "there is a real rclpy, and it is broken: ImportError: "
MINE = Process(pid=12, user="ann", is_mine=True, is_orphan=False, age=300.0, command=("tank", "joy"))


def only(findings) -> Finding:
    """The finding of a probe that has one."""
    (finding,) = findings
    return finding


def answers(answer):
    """Stand in for a process that answers."""
    return Mock(return_value=answer)


answers_jazzy = answers(JAZZY)
fails = Mock(side_effect=UnansweredError("ImportError: libcrypto.so.3"))
vulkan = Mock(side_effect=UnansweredError("MUJOCO_GL is odd"))
nonsense = Mock(side_effect=TutorialError("TUTORIAL_ROS is 'ros2'."))
REQUIRED = ["numpy>=2", "nowhere; platform_system == 'None'", "pygame-ce>=2.5; extra == 'gamepad'"]
NUMPY, PADS = {"numpy": "2.4.6"}, {"pygame-ce": "2.5.8"}
RANGE, OTHER = "ROS_AUTOMATIC_DISCOVERY_RANGE", "all machines of this network"
FAST = {"RMW_IMPLEMENTATION": "rmw_fastrtps_cpp"}


def draws(environment, good):
    """Find out which backends draw, where those are good."""

    def ask_one(_question, given):
        if given["MUJOCO_GL"] not in good:
            raise UnansweredError("crashed with SIGSEGV")
        return True

    return rendering(environment, ask_one, ("egl", "osmesa", "glfw"))


def chosen(environment, choice="rclpy", is_there=True, answer=answers_jazzy):
    return backend(environment, lambda: choice, lambda: is_there, answer)


def reach(value, is_real):
    return discovery({} if value is None else {RANGE: value}, is_real)


def named(*names, settled=True):
    return nodes({"ROS_DOMAIN_ID": "7"}, answers({"nodes": names, "settled": settled}))


def has(text, part):
    """Whether a text has this part, or ends with it where a $ says so."""
    return text.endswith(part[:-1]) if part.endswith("$") else part in text


@pytest.mark.parametrize(
    ("level", "said", "mend", "probe"),
    [
        ("problem", HERE, "", lambda: python((3, 10, 4), HERE, VENV)),
        ("ok", "in a conda environment", "", lambda: python((3, 13, 9), HERE, "in a conda environment")),
        ("note", "not in a virtual environment", "", lambda: python((3, 12, 3), HERE, "")),
        ("problem", "libcrypto", "python -m pip install --force-reinstall mujoco$", lambda: mujoco({}, fails)),
        ("problem", "cannot be imported: MUJOCO_GL is odd$", "unset MUJOCO_GL$", lambda: mujoco({}, vulkan)),
        ("ok", "with egl, glfw of egl, osmesa, glfw; MUJOCO_GL is not set", "", lambda: draws({}, ("egl", "glfw"))),
        ("ok", "MUJOCO_GL is egl", "", lambda: draws({"MUJOCO_GL": "egl"}, ("egl",))),
        ("note", "but MUJOCO_GL is osmesa", "", lambda: draws({"MUJOCO_GL": "osmesa"}, ("egl",))),
        (
            "note",
            "none of egl, osmesa, glfw draws off the screen. The tutorial itself",
            "",
            lambda: draws({"MUJOCO_GL": ""}, ()),
        ),
        ("ok", "all 1 that the tutorial requires$", "", lambda: packages(REQUIRED, (NUMPY | PADS).get)),
        ("problem", "missing or too old: numpy", "-m pip install 'numpy>=2'$", lambda: packages(REQUIRED, PADS.get)),
        ("problem", "numpy 1.26.4 (needs >=2)", "", lambda: packages(REQUIRED, (PADS | {"numpy": "1.26.4"}).get)),
        ("note", "", "", lambda: packages(None, {}.get)),
        ("ok", "because this Python finds no rclpy$", "", lambda: chosen({}, "underlay")),
        ("ok", "TUTORIAL_ROS=underlay$", "", lambda: chosen({"TUTORIAL_ROS": "underlay"} | DISTRO, "underlay")),
        ("problem", "libcrypto", "cyclonedds", lambda: chosen({}, "underlay", answer=fails)),
        ("note", "ROS 2 jazzy is set up", "--system-site-packages", lambda: chosen(DISTRO, "underlay")),
        ("ok", "because TUTORIAL_ROS=rclpy:", "", lambda: chosen({"TUTORIAL_ROS": "rclpy"} | DISTRO)),
        ("ok", "on rmw_fastrtps_cpp (RMW_IMPLEMENTATION)$", "", lambda: chosen(FAST | DISTRO)),
        ("note", "made for jazzy", ". /opt/ros/jazzy/setup.bash", lambda: chosen({"ROS_DISTRO": "humble"})),
        ("note", "does not speak DDS", "export RMW_IMPLEMENTATION=", lambda: chosen(DISTRO, answer=answers(ZENOH))),
        ("problem", f"{BROKEN}libcrypto.so.3", "export TUTORIAL_ROS=underlay", lambda: chosen(DISTRO, answer=fails)),
        ("problem", "finds no rclpy", "", lambda: chosen({"TUTORIAL_ROS": "rclpy"}, is_there=False)),
        ("problem", "TUTORIAL_ROS is 'ros2'.$", "unset TUTORIAL_ROS$", lambda: backend({}, nonsense, bool, fails)),
        ("ok", "nodes on this machine only (LOCALHOST, the default)", "", lambda: reach(None, False)),
        ("note", f"{OTHER} (SUBNET, the default)", "=LOCALHOST", lambda: reach(None, True)),
        ("ok", f"this machine only ({RANGE} is LOCALHOST)", "", lambda: reach("LOCALHOST", True)),
        ("note", OTHER, f": unset {RANGE}", lambda: reach("SUBNET", False)),
        ("note", "no other node, not even on this machine", f": unset {RANGE}", lambda: reach("OFF", False)),
        ("note", "what the middleware is configured for", "=LOCALHOST", lambda: reach("SYSTEM_DEFAULT", True)),
        ("problem", "Did you mean 'LOCALHOST'?", f"unset {RANGE}", lambda: reach("LOCAL", False)),
        ("ok", "0 (the default", "", lambda: domain({"ROS_DOMAIN_ID": ""})),
        ("ok", f"{domains.LAST} (ROS_DOMAIN_ID)", "", lambda: domain({"ROS_DOMAIN_ID": str(domains.LAST)})),
        ("note", "its ports, from 32900 on", "", lambda: domain({"ROS_DOMAIN_ID": str(domains.LAST + 1)})),
        ("problem", "is '233', and must be a number from 0 to 232", "", lambda: domain({"ROS_DOMAIN_ID": "233"})),
        ("problem", "'one'", "", lambda: domain({"ROS_DOMAIN_ID": "one"})),
        ("ok", "in domain 7: nobody else", "", named),
        ("ok", "in domain 7: /joy, /viewer", "", lambda: named("/viewer", "/joy")),
        ("note", "in domain 7: /joy, 2 x /tank. Nodes of one name", "", lambda: named("/tank", "/joy", "/tank")),
        ("note", "in domain 7: /joy. Some still come or go", "", lambda: named("/joy", settled=False)),
        ("ok", "and 1,950 more", "", lambda: named(*(f"/{i}" for i in range(2000)))),
        ("note", "nobody was looked for", "", lambda: nodes({"ROS_DOMAIN_ID": "x"}, fails)),
        ("problem", "a node cannot be made: ImportError", "", lambda: nodes({}, fails)),
        ("ok", "", "", lambda: processes([replace(MINE, command=("bash", "-l"))])),
    ],
)
def test_what_there_is_is_found(level, said, mend, probe):
    finding = only(probe())
    assert (finding.level, has(finding.text, said), has(finding.mend, mend)) == (level, True, True), finding


def test_where_a_python_is_at_home(tmp_path):
    assert python_home("/home/ann/.venv", "/usr") == VENV
    assert python_home(str(tmp_path), str(tmp_path)) == ""
    (tmp_path / "conda-meta").mkdir()
    assert python_home(str(tmp_path), str(tmp_path)) == "in a conda environment"


def test_without_the_gamepads_package_a_note():
    _, finding = packages(REQUIRED, NUMPY.get)
    assert (finding.level, finding.mend) == ("note", "python -m pip install 'pygame-ce>=2.5'")


def test_jupyter(tmp_path):
    versions = {"jupyterlab": "4.6.6", "ipykernel": "7.4.0", "ipywidgets": "8.1.9", "anywidget": "0.11.0"}
    mend = "python -m pip install --force-reinstall jupyterlab_widgets anywidget"
    finding = only(jupyter(versions.get, [tmp_path]))
    assert (finding.level, finding.mend) == ("problem", mend)
    for name in ("anywidget", "@jupyter-widgets/jupyterlab-manager"):
        (tmp_path / name).mkdir(parents=True)
    finding = only(jupyter(versions.get, [tmp_path / "nowhere", tmp_path]))
    assert (finding.level, finding.text.split(",")[0]) == ("ok", "jupyterlab 4.6.6")
    del versions["anywidget"]
    finding = only(jupyter(versions.get, [tmp_path]))
    assert (finding.level, finding.mend) == ("problem", "python -m pip install anywidget")


@pytest.mark.parametrize("name", ["ROS_STATIC_PEERS", "CYCLONEDDS_URI", "ROS_LOCALHOST_ONLY"])
def test_what_else_was_set_by_hand(name):
    _, finding = discovery({name: "10.0.0.7" * 20}, is_real=False)
    assert (finding.level, finding.mend) == ("note", f"if it is not meant: unset {name}")
    assert finding.text.startswith(f"{name} is '10.0.0.7")
    assert len(finding.text) < 160


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
        ((), None),
    ],
)
def test_which_command_lines_are_the_tutorials(command, said):
    assert title(command) == said


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
    asked = [(1, "tini", None), (900, "systemd", None), (900, "bash", None), (1, "bash", "/dev/pts/0")]
    assert [is_orphan(*parent) for parent in asked] == [True, True, False, False]


def test_this_process_is_found():
    me, seen = psutil.Process(), only(process for process in running() if process.pid == os.getpid())
    assert (seen.user, seen.is_mine, list(seen.command)) == (me.username(), True, me.cmdline())
    assert 0 < seen.age < 1e6


def test_ports_that_are_taken():
    first, second, free = ports([Listener(7001, None, ""), Listener(7000, 12, "tank run step2"), Listener(8888, 5, "")])
    assert first.text == "7000 is taken by tank run step2, pid 12"
    assert second.text == "7001 is taken by a process of another user"
    assert free.text == "the next 3D view of tank run is on 7002"
    every = [Listener(web.FIRST_PORT + n, 12, "x") for n in range(web.PORTS_TRIED)]
    *_, finding = ports(every)
    assert (finding.level, "--port" in finding.mend) == ("problem", True)
    *_, finding = ports(every[:-1])
    assert finding.text.endswith(f"on {every[-1].port}")


def test_a_port_that_this_process_listens_on_and_one_that_it_only_uses():
    with socket.create_server(("127.0.0.1", 0)) as server, socket.create_connection(server.getsockname()) as client:
        port, used = server.getsockname()[1], client.getsockname()[1]
        assert [each.pid for each in listeners() if each.port == port] == [os.getpid()]
        assert used not in [each.port for each in listeners()]
    assert port not in [each.port for each in listeners()]


def test_the_pythons_that_the_project_is_for_are_well():
    required = SpecifierSet(tomllib.loads((HOME / "pyproject.toml").read_text())["project"]["requires-python"])
    levels = [only(python((3, minor, 0), HERE, VENV)).level for minor in range(30)]
    assert levels == ["ok" if f"3.{minor}.0" in required else "problem" for minor in range(30)]


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

    lacking = Mock(side_effect=ModuleNotFoundError("No module named 'psutil'", name="psutil"))
    first, second = map(only, examine({"first": broken, "second": lacking}))
    assert (first.level, first.text) == ("note", "it could not be looked at: ValueError: odd")
    assert (second.level, second.mend) == ("note", "python -m pip install psutil")


def test_a_probe_that_takes_too_long_is_given_up():
    release = threading.Event()
    slow, quick = examine({"slow": lambda: [release.wait()], "quick": lambda: [Finding("quick", "ok", "x")]}, 0.5)
    release.set()
    assert (only(slow).level, only(slow).text) == ("note", "it takes too long to look")
    assert only(quick).level == "ok"


@pytest.mark.process
@pytest.mark.parametrize(
    ("module", "said"), [("import os; os.abort()", "crashed with SIGABRT"), ("1 / 0", "ZeroDivisionError")]
)
def test_what_crashes_elsewhere_is_only_an_answer_that_does_not_come(tmp_path, module, said):
    (tmp_path / "mujoco.py").write_text(module)
    with pytest.raises(UnansweredError, match=said):
        ask("mujoco", {**os.environ, "PYTHONPATH": str(tmp_path)})


def test_no_answer_in_time_and_a_failure_without_a_word_are_said(monkeypatch):
    ends = [subprocess.TimeoutExpired((), 0.5), subprocess.CompletedProcess((), 3, "", " \n")]
    monkeypatch.setattr(subprocess, "run", run := Mock(side_effect=ends))
    for said in (r"^no answer within 0\.5 s$", r"^exit status 3$"):
        with pytest.raises(UnansweredError, match=said):
            ask("mujoco", {}, patience=0.5)
        assert run.call_args.kwargs["timeout"] == 0.5


def examined(**environment: str) -> subprocess.CompletedProcess[str]:
    """Run the whole command."""
    process = subprocess.run(
        [TANK, "doctor"], env={**os.environ, **environment}, capture_output=True, text=True, timeout=110, check=False
    )
    assert (process.stderr, process.returncode) == ("", 1)
    return process.stdout


@pytest.fixture
def orphan():
    """A ``tank joy`` whose parent has gone; its pid."""
    script = f"'{TANK}' joy </dev/null >/dev/null 2>&1 & echo $!"
    pid = int(subprocess.run(["sh", "-c", script], stdout=subprocess.PIPE, text=True, check=True).stdout)
    try:
        until(lambda: title(psutil.Process(pid).cmdline()) == "tank joy", "the program's own command line")
        yield pid
    finally:
        os.kill(pid, signal.SIGKILL)
        until(lambda: not psutil.pid_exists(pid), "its end")


@pytest.mark.process
def test_the_whole_command(domain, orphan):
    runs: list[str] = []
    with closing(NodeThread("twin")), closing(NodeThread("twin")), web._listen(None) as taken:
        port = taken.getsockname()[1]
        until(lambda: runs.append(examined()) or "2 x /twin" in runs[-1], "the twins")
    said = runs[-1]
    for line in (
        rf"nodes +note +in domain {domain}: .*2 x /twin.*",
        rf"processes +problem +tank joy: pid {orphan}, for \d+ s; what started it is gone",
        rf" +-> kill {orphan}",
        rf"ports +ok +{port} is taken by .+, pid {os.getpid()}",
        r"MuJoCo +ok +.*",
    ):
        assert re.search(f"^{line}$", said, re.MULTILINE), said
    assert "_doctor" not in said
    subjects = dict.fromkeys(line[:11].rstrip() for line in said.rpartition("\n\n")[0].splitlines() if line[0] != " ")
    assert list(subjects) == list(examination._probes({}))
    assert all(len(line) <= 100 or len(line.split()) == 1 for line in said.splitlines()), "a long path stands alone"


@pytest.mark.process
def test_the_whole_command_where_nothing_is_well(tmp_path):
    (tmp_path / "rclpy").mkdir()
    (tmp_path / "rclpy" / "__init__.py").write_text("raise ImportError('no librcl_action.so')\n")
    said = examined(PYTHONPATH=f"{tmp_path}", TUTORIAL_ROS="", ROS_DOMAIN_ID="many", MUJOCO_GL="vulkan")
    for words in (f"{BROKEN}no librcl_action.so", "ROS_DOMAIN_ID is 'many'", "nobody was looked", "unset MUJOCO_GL"):
        assert words in " ".join(said.split())
    assert "Traceback" not in said
    assert "TUTORIAL_ROS is 'ros2'" in examined(TUTORIAL_ROS="ros2")
