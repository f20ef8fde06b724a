"""``tank node`` and ``tank topic``, compared with what a real ``ros2`` printed."""

import os
import re
import subprocess
import sys
import time
from collections.abc import Iterator
from functools import partial
from unittest.mock import Mock

import pytest
from builtin_interfaces.msg import Time
from click.testing import CliRunner
from programs import TANK, TIMEOUT, until
from rclpy.utilities import get_rmw_implementation_identifier
from recorded import recorded, recorded_nodes, recorded_status
from std_msgs.msg import String

from tutorial.commands.topic import topic
from tutorial.errors import TutorialError
from tutorial.ros.bags.writer import BagWriter
from tutorial.ros.domains import reserved_domain
from tutorial.ros.node_thread import MeteredNode, NodeThread
from tutorial.ros.topics.populate import populated

JOINT_STATE = "/Tank/joint_state"
JOY = "/joy sensor_msgs/msg/Joy"


@pytest.fixture(scope="module")
def number() -> Iterator[int]:
    """A domain with the nodes of the recording."""
    with reserved_domain() as domain, pytest.MonkeyPatch.context() as patch:
        patch.setenv("ROS_DOMAIN_ID", str(domain))
        with recorded_nodes() as nodes:
            counts = [count for node in nodes for count in (node.count_publishers, node.count_subscribers)]
            until(lambda: all(count(topic) for count in counts for topic in (JOINT_STATE, "/joy")), "all nodes")
            yield domain


@pytest.fixture
def beside(number, tank, monkeypatch) -> None:
    """Run the test's commands in that domain."""
    monkeypatch.setenv("ROS_DOMAIN_ID", str(number))


@pytest.fixture
def eventually(tank):
    """Run a command until it has the expected output: discovery may be slow on a busy machine."""

    def eventually(form, wanted, *words):
        until(lambda: form(tank(*words)) == wanted, f"{words}: {wanted}")

    return eventually


def comparable(text: str) -> str:
    """Hide identifiers, figures, and whatever Fast DDS does not report."""
    if "fastrtps" in get_rmw_implementation_identifier():
        text = re.sub(r"History \(Depth\): .*", "History (Depth): *", text)
    text = re.sub(r"GID: [0-9a-f.]{47}\n", "GID: *\n", text)
    return re.sub(r"^\d+,\d+,", "*,*,", text)


@pytest.mark.parametrize(
    "command",
    [
        "node list",
        "topic list",
        "topic list -t",
        f"topic info {JOINT_STATE}",
        f"topic info -v {JOINT_STATE}",
        "topic info /nothing",
        f"topic echo --once {JOINT_STATE}",
        f"topic echo --once --field position {JOINT_STATE}",
        "topic echo --once /nothing",
        "topic pub --once /joy sensor_msgs/msg/Joyy {}",
        f"topic pub --once {JOY} {{axes: [0.0, 0.5]}}",
        f"topic pub --once {JOY} {{axis: [0.0, 0.5]}}",
    ],
)
def test_it_prints_what_ros2_prints(beside, eventually, command):
    line = f"ros2 {command}"
    words, brace, value = command.partition("{")

    def form(run):
        if run.status:
            assert run.stderr.endswith(recorded(line).splitlines()[-1] + "\n")
        return comparable(run.output), run.status

    wanted = comparable(recorded(line)), recorded_status(line)
    eventually(form, wanted, words, *[brace + value] * bool(brace))


def test_pub_waits_for_a_subscription(beside, tank):
    received, waits = [], "Waiting for at least 1 matching subscription(s)...\n"
    with NodeThread("listener") as listener:
        listen = partial(listener.node.create_subscription, String, "/x", lambda m: received.append(m.data), 1)
        run = tank("topic pub --once /x std_msgs/msg/String", "{data: hello}", once=waits, then=listen)
        until(lambda: received == ["hello"], "the message")
    assert (run.status, run.stdout.partition("publisher: ")[0].replace(waits, "")) == (0, "")
    assert run.stdout.endswith("publisher: beginning loop\npublishing #1: std_msgs.msg.String(data='hello')\n\n")


@pytest.mark.parametrize(
    ("command", "said"),
    [
        (f"topic hz {JOINT_STATE}", "std dev: "),
        (f"topic echo {JOINT_STATE}", "---\nheader:\n"),
        ("topic pub -r 2 /mine std_msgs/msg/String", "publishing #2: std_msgs.msg.String(data='')\n\n"),
    ],
)
def test_ctrl_c_ends_it_like_ros2(beside, tank, command, said):
    """Its exit status is 2, the number of SIGINT."""
    assert tank(command, once=said).status == 2


def test_hz_with_sim_time_uses_a_node_with_sim_time(monkeypatch):
    node_thread = Mock(side_effect=TutorialError)
    monkeypatch.setattr("tutorial.ros.node_thread.NodeThread", node_thread)
    for arguments in (["hz", "/x"], ["hz", "-s", "/x"]):
        CliRunner().invoke(topic, arguments, obj=["--ros-args", "-r", "a:=b"])
    plain, timed = (call.args[1] for call in node_thread.call_args_list)
    assert timed == [*plain, "--ros-args", "-p", "use_sim_time:=true"]


@pytest.mark.process
def test_a_closed_pipe_ends_it(beside):
    """As with ``| head -1``: the pipe closes after the first line."""
    words = [TANK, "topic", "echo", JOINT_STATE]
    pipes = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE, "text": True}
    with subprocess.Popen(words, env={**os.environ, "PYTHONUNBUFFERED": ""}, **pipes) as running:
        assert running.stdout.readline() == "header:\n"
        running.stdout.close()
        assert running.wait(TIMEOUT) == 141
        assert running.stderr.read() == ""


@pytest.mark.parametrize(
    ("command", "asked", "error"),
    [
        ("topic list", "get_topic_names_and_types", UnicodeDecodeError("utf-8", b"/\xff", 1, 2, "invalid start byte")),
        ("node list", "get_node_names_and_namespaces", RuntimeError("empty node name returned by the RMW layer")),
    ],
)
def test_rclpys_error_is_shown_unchanged(tank, monkeypatch, command, asked, error):
    """rclpy raises it while a different program has a name that is empty or not valid UTF-8."""
    monkeypatch.setattr(MeteredNode, asked, Mock(side_effect=error))
    run = tank(command)
    assert (run.status, f"Error: ROS 2 reports: {error}\n" in run.stderr) == (1, True)


def test_two_nodes_with_the_same_name_are_listed_twice(eventually):
    listed = (
        "WARNING: Be aware that there are nodes in the graph that share an exact name, "
        "which can have unintended side effects.\n"
    )
    with NodeThread("twin"), NodeThread("twin"):
        eventually(lambda run: (run.stdout, run.stderr), ("/twin\n/twin\n", listed), "node list")


def test_ros_arguments_name_the_node_and_remap_its_topics(tank):
    said = []

    def look():
        with NodeThread("_looker") as looker:
            until(lambda: set(looker.node.get_node_names()) == {"hand", "_looker"}, "the node")
            until(lambda: looker.node.count_publishers("/y"), "the publisher")
            said.append(dict(looker.node.get_topic_names_and_types())["/y"])

    tank("topic pub -r 10 /x std_msgs/msg/String --ros-args -r __node:=hand -r /x:=/y", once=lambda: look() or True)
    assert said == [["std_msgs/msg/String"]]


@pytest.mark.process
def test_help_needs_no_rclpy():
    code = "import sys, tutorial.commands.tank; sys.exit(bool({'rclpy', 'numpy', 'mujoco'} & {*sys.modules}))"
    subprocess.run([sys.executable, "-c", code], check=True)


@pytest.mark.process
@pytest.mark.parametrize("words", [["progress"], ["bag", "info", "x"]])
def test_works_without_rclpy(words, tmp_path):
    BagWriter(tmp_path / "x").close()
    code = f"import sys; sys.modules['rclpy'] = None; from tutorial.commands.tank import main; main({words})"
    subprocess.run([sys.executable, "-c", code], check=True, cwd=tmp_path)


JOYS = "sensor_msgs/msg/Joy"


@pytest.mark.parametrize(
    ("type_name", "text", "problem"),
    [
        (JOYS, "{header: {stmp: 1}}", "'Header' object has no attribute 'stmp'"),
        (JOYS, "{axes: [a]}", "must be real number, not str"),
        (JOYS, "{header: now}", "Value 'now' is expected to be a dictionary but is a str"),
        (JOYS, "{header: {stamp: auto}}", "Value 'auto' is expected to be a dictionary but is a str"),
        ("nav_msgs/Path", "{poses: [auto]}", "Value 'auto' is expected to be a dictionary but is a str"),
        (JOYS, "{header: {stamp: [now]}}", "Value '['now']' is expected to be a dictionary"),
        (JOYS, "{header: atuo}", "Value 'atuo' is expected to be a dictionary but is a str"),
        ("std_msgs/msg/Float64", "{data: null}", "Value 'None' is expected to be a dictionary but is a NoneType"),
        ("sensor_msgs/msg/Imu", "{orientation_covariance: [1.0]}", "The 'orientation_covariance' "),
        ("diagnostic_msgs/msg/DiagnosticStatus", "{values: [{ky: a}]}", "'KeyValue' object has no attribute 'ky'"),
    ],
)
def test_values_that_do_not_fit_are_refused(type_name, text, problem):
    with pytest.raises(Exception, match=re.escape(f"Failed to populate field: {problem}")):
        populated(type_name, text)


@pytest.mark.parametrize(
    ("type_name", "text", "shown"),
    [
        (JOYS, "{axes: [0, 0.5], buttons: [1]}", "axes=[0.0, 0.5], buttons=[1])"),
        ("geometry_msgs/msg/Pose", "{position: {x: 1}}", "position=geometry_msgs.msg.Point(x=1.0, y=0.0, z=0.0)"),
        ("diagnostic_msgs/msg/DiagnosticStatus", "{values: [{}, {key: a}]}", "KeyValue(key='a', value='')])"),
    ],
)
def test_values_that_fit(type_name, text, shown):
    assert shown in repr(populated(type_name, text).message)


def stamps(message):
    """Return the seconds of all stamps in a message, in order."""
    return [int(found) for found in re.findall(r"Time\(sec=(\d+)", repr(message))]


@pytest.mark.parametrize(
    ("type_name", "text", "seconds"),
    [
        ("sensor_msgs/Joy", "{header: auto, axes: [1]}", [7]),
        (JOYS, "{header: {stamp: now, frame_id: a}}", [7]),
        (JOYS, "{header: {stamp: {sec: 3}}}", [3]),
        ("nav_msgs/Path", "{header: auto, poses: [{header: auto}, {}, {header: {stamp: now}}]}", [7, 7, 0, 7]),
        ("tf2_msgs/msg/TFMessage", "{transforms: [{header: auto, child_frame_id: auto}]}", [7]),
        ("rosgraph_msgs/Clock", "{clock: now}", [7]),
        ("builtin_interfaces/Time", "{sec: 3}", [3]),
    ],
)
def test_stamps(type_name, text, seconds):
    filled = populated(type_name, text)
    filled.stamp(Time(sec=7))
    assert stamps(filled.message) == seconds
    filled.stamp(Time(sec=8))
    assert stamps(filled.message) == [8 if second == 7 else second for second in seconds]


def test_pub_stamps_each_message(tank):
    run = tank("topic pub -r 50 /mine sensor_msgs/Joy", "{header: auto}", once="publishing #3: ")
    times = [int(sec) * 10**9 + int(nsec) for sec, nsec in re.findall(r"sec=(\d+), nanosec=(\d+)", run.stdout)]
    assert times == sorted(set(times))
    assert 0 <= time.time_ns() - times[0] < TIMEOUT * 1e9


def test_invalid_yaml_is_refused():
    with pytest.raises(Exception, match=r"(?s)The passed value needs to be in YAML string or a dictionary\n.*line 1"):
        populated("std_msgs/msg/String", "{data: [")
