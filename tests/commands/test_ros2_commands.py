"""``tank node`` and ``tank topic``, compared with what a real ``ros2`` printed; each node is a process of its own."""

from __future__ import annotations

import os
import re
import subprocess
import sys
from collections.abc import Callable, Iterator
from contextlib import ExitStack
from pathlib import Path

import pytest
from click.testing import CliRunner
from domains import reserved_domain
from programs import PATIENCE, TANK, until
from rclpy.utilities import get_rmw_implementation_identifier
from recorded import masked, recorded, recorded_status
from std_msgs.msg import String

from tutorial.commands import asking
from tutorial.commands.tank import tank
from tutorial.commands.topic import topic
from tutorial.ros.node_thread import NodeThread
from tutorial.ros.topics.populate import passed_class, populated

JOINT_STATE = "/Tank/joint_state"
JOY = ("/joy", "sensor_msgs/msg/Joy")
NODES = ("simulation", "viewer", "joystick")

NODE_PROGRAM = f"""
import sys
import time
import tutorial
from sensor_msgs.msg import JointState, Joy
from tutorial.ros.node_thread import NodeThread

message = JointState(name=["TURRET_Y", "TURRET_P"], position=[0.25, -0.00979])
message.velocity, message.effort = [0.0, 0.0], [0.0, 1.9613]
message.header.stamp.sec, message.header.stamp.nanosec = 8, 160_000_000

def show(joy):
    print(list(joy.axes), flush=True)

def is_met(node):
    counts = (node.count_publishers, node.count_subscribers)
    return all(count(topic) for count in counts for topic in ("{JOINT_STATE}", "/joy"))

name = sys.argv[1]
with NodeThread(name) as thread:
    node = thread.node
    if name == "simulation":
        publisher = node.create_publisher(JointState, "{JOINT_STATE}", 1)
        node.create_timer(1 / 50.0, lambda: publisher.publish(message))
        node.create_subscription(Joy, "/joy", show, 10)
    elif name == "viewer":
        node.create_subscription(JointState, "{JOINT_STATE}", lambda _: None, 1)
    else:
        node.create_publisher(Joy, "/joy", 1)
    while not is_met(node):
        time.sleep(0.02)
    print("met", flush=True)
    sys.stdin.read()
"""


class Graph:
    """The three nodes of the recording, each a process, and commands that look at them."""

    def __init__(self, domain: int, directory: Path, stack: ExitStack) -> None:
        self.environment = {**os.environ, "ROS_DOMAIN_ID": str(domain)}
        self._logs = {name: directory / f"{name}.log" for name in NODES}
        for name in NODES:
            with self._logs[name].open("w") as log:
                process = subprocess.Popen(
                    [sys.executable, "-c", NODE_PROGRAM, name],
                    stdin=subprocess.PIPE,
                    stdout=log,
                    stderr=subprocess.STDOUT,
                    env=self.environment,
                )
            stack.callback(process.communicate)
            stack.callback(process.kill)
        until(lambda: all("met" in self.log(name) for name in NODES), f"all nodes: {list(map(self.log, NODES))}")

    def log(self, name: str) -> str:
        return self._logs[name].read_text()

    def run(self, command: str, *arguments: str) -> subprocess.CompletedProcess[str]:
        """Run a ``tank`` command, with further arguments that hold spaces."""
        return subprocess.run(
            [TANK, *command.split(), *arguments],
            env=self.environment,
            capture_output=True,
            text=True,
            timeout=PATIENCE,
            check=False,
        )

    def says(self, command: str, *arguments: str) -> None:
        """Run a command until it prints what was recorded: discovery may be too slow at first, on a busy machine."""
        line = " ".join((f"ros2 {command}", *arguments))
        wanted = (comparable(recorded(line)), recorded_status(line))
        last: list[object] = []

        def agrees() -> bool:
            run = self.run(command, *arguments)
            last[:] = comparable(run.stdout + run.stderr), run.returncode
            if run.returncode:
                assert run.stderr.endswith(recorded(line).splitlines()[-1] + "\n")
            return last == list(wanted)

        try:
            until(agrees, line)
        finally:
            assert last == list(wanted)


@pytest.fixture(scope="module")
def graph(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Graph]:
    with ExitStack() as stack:
        domain = stack.enter_context(reserved_domain())
        yield Graph(domain, tmp_path_factory.mktemp("nodes"), stack)


@pytest.fixture
def eventually(domain: int) -> Callable[..., None]:
    """Run a command until its output and its errors are such."""

    def eventually(command: str, stdout: str, stderr: str = "") -> None:
        def agrees() -> bool:
            run = subprocess.run(
                [TANK, *command.split()], capture_output=True, text=True, timeout=PATIENCE, check=False
            )
            return (run.stdout, run.stderr) == (stdout, stderr)

        until(agrees, f"{command!r} to print {stdout!r} and {stderr!r}")

    return eventually


def comparable(text: str) -> str:
    """Hide identifiers and figures, the services, which the embedded ROS 2 lacks, and what Fast DDS does not tell."""
    if "fastrtps" in get_rmw_implementation_identifier():
        text = re.sub(r"History \(Depth\): .*", "History (Depth): *", text)
    services = r"  (Service|Action) (Servers|Clients):\n((    .*\n)+|\n)"
    return re.sub(services, r"  \1 \2: *\n", masked(text))


@pytest.mark.parametrize(
    "command",
    [
        "node list",
        "node info /simulation",
        "node info /nobody",
        "topic list",
        "topic list -t",
        f"topic info {JOINT_STATE}",
        f"topic info -v {JOINT_STATE}",
        "topic info /nothing",
        f"topic type {JOINT_STATE}",
        "topic find sensor_msgs/msg/JointState",
        f"topic echo --once {JOINT_STATE}",
        f"topic echo --once --field position {JOINT_STATE}",
        f"topic echo --once --csv {JOINT_STATE}",
        "topic echo --once /nothing",
        "topic pub --once /joy sensor_msgs/msg/Joyy {}",
    ],
)
def test_it_prints_what_ros2_prints(graph, command):
    graph.says(command)


def test_pub_publishes_what_it_says(graph):
    graph.says(f"topic pub --once {' '.join(JOY)}", "{axes: [0.0, 0.5]}")
    until(lambda: "[0.0, 0.5]\n" in graph.log("simulation"), "the message")


def test_pub_publishes_so_many_times(graph):
    count = graph.log("simulation").count("[0.0, 0.25]")
    run = graph.run(f"topic pub -r 50 --times 3 -p 0 {' '.join(JOY)}", "{axes: [0.0, 0.25]}")
    assert (run.returncode, run.stderr) == (0, "")
    until(lambda: graph.log("simulation").count("[0.0, 0.25]") == count + 3, "three messages")


def test_pub_says_what_it_publishes_each_time(graph):
    graph.says(f"topic pub -r 5 --times 3 {' '.join(JOY)}", "{axes: [0.0, 0.5]}")


def test_pub_refuses_a_field_that_there_is_not(graph):
    graph.says(f"topic pub --once {' '.join(JOY)}", "{axis: [0.0, 0.5]}")


def test_pub_writes_the_time_of_each_publication(graph):
    run = graph.run("topic pub -r 20 -t 2 -w 0 /stamped std_msgs/msg/Header", "{stamp: now}")
    first, second = re.findall(r"Time\(sec=(\d+), nanosec=(\d+)\)", run.stdout)
    assert first > ("0", "0")
    assert first != second


def test_a_type_that_nobody_has_is_no_topic_s(graph):
    run = graph.run("topic type /nothing")
    assert (run.stdout, run.stderr, run.returncode) == ("", "", 1)
    run = graph.run("topic find std_msgs/msg/Empty")
    assert (run.stdout, run.stderr, run.returncode) == ("", "", 0)


def test_counts(graph):
    until(lambda: graph.run("node list -c").stdout == "3\n", "three nodes")
    until(lambda: graph.run("topic list -c").stdout == "4\n", "four topics")
    until(lambda: graph.run("topic find -c sensor_msgs/msg/Joy").stdout == "1\n", "one topic")


def test_verbose_list(graph):
    lines = (
        " * /joy [sensor_msgs/msg/Joy] 1 publisher\n",
        "\n\nSubscribed topics:\n",
        f" * {JOINT_STATE} [sensor_msgs/msg/JointState] 1 subscriber\n",
        " * /joy [sensor_msgs/msg/Joy] 1 subscriber\n",
    )

    def agrees() -> bool:
        stdout = graph.run("topic list -v").stdout
        return all(line in stdout for line in lines)

    until(agrees, str(lines))


def test_hidden_nodes_are_listed_when_asked_for(graph):
    names = {f"/{name}" for name in NODES}
    until(lambda: set(graph.run("node list -a").stdout.splitlines()) > names, "a hidden node beside the others")


def test_echo_ends_after_a_timeout(graph):
    run = graph.run(f"topic echo --timeout 1 --field header.stamp.sec {JOINT_STATE}")
    assert run.stdout.startswith("8\n---\n8\n---\n")
    assert (run.stderr, run.returncode) == ("", 0)
    run = graph.run("topic echo --timeout 0.1 /joy")
    assert (run.stdout, run.stderr, run.returncode) == ("", "", 0)


def test_echo_waits_for_a_topic_of_a_type_that_it_is_told(graph):
    run = graph.run("topic echo --timeout 0.1 /later std_msgs/msg/String")
    assert (run.stdout, run.stderr, run.returncode) == ("", "", 0)
    run = graph.run("topic echo /later std_msgs/msg/Strin")
    assert (run.stdout, run.stderr, run.returncode) == ("", "The passed message type is invalid\n", 1)


def test_echo_takes_a_relative_name(graph):
    until(lambda: graph.run(f"topic echo --once --csv {JOINT_STATE[1:]}").stdout.startswith("8,160000000,"), "a line")


@pytest.mark.parametrize(
    ("command", "said"),
    [
        (f"topic hz -w 50 {JOINT_STATE}", "std dev: "),
        ("topic hz /nothing", recorded("ros2 topic hz /nothing")),
        (f"topic echo {JOINT_STATE}", "---\nheader:\n"),
        ("topic echo /nothing std_msgs/msg/String", ""),
        ("topic pub -r 2 /mine std_msgs/msg/String", "publishing #2: std_msgs.msg.String(data='')\n\n"),
    ],
)
def test_ctrl_c_ends_it_as_it_ends_ros2(graph, program, command, said):
    """Its output is in the pipe line by line, and its exit status is 2, the number of the signal."""
    running = program(*command.split(), environment={**graph.environment, "PYTHONUNBUFFERED": ""})
    if said:
        running.says(said)
    else:
        until(lambda: "/nothing" in graph.run("topic list").stdout, "the subscription")
    running.asks_to_stop()
    assert running.ends() == 2
    assert "Traceback" not in running.output


def test_hz_by_simulated_time_has_a_node_that_uses_it(monkeypatch):
    given = []
    monkeypatch.setattr(asking, "ask", lambda ros_args, question: given.append(ros_args))
    for arguments in (["hz", "/x"], ["hz", "-s", "/x"]):
        CliRunner().invoke(topic, arguments, obj=["--ros-args", "-r", "a:=b"], catch_exceptions=False)
    assert given[1] == [*given[0], "--ros-args", "-p", "use_sim_time:=true"]


def test_nobody_reads_on(graph):
    """What ``| head -1`` does."""
    with subprocess.Popen(
        [TANK, "topic", "echo", JOINT_STATE],
        env=graph.environment,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    ) as running:
        assert running.stdout.readline() == "header:\n"
        running.stdout.close()
        assert running.wait(PATIENCE) == 141
        assert running.stderr.read() == ""


def test_two_nodes_of_one_name(program, eventually):
    for _ in range(2):
        program("topic", "pub", "-n", "twin", "/x", "std_msgs/msg/String")
    warning = (
        "WARNING: Be aware that there are nodes in the graph that share an exact name, "
        "which can have unintended side effects.\n"
    )
    eventually("node list", "/twin\n/twin\n", warning)
    warning = (
        'There are 2 nodes in the graph with the exact name "/twin". You are seeing information about only one of them.'
    )

    def is_warned() -> bool:
        run = subprocess.run(
            [TANK, "node", "info", "/twin"], capture_output=True, text=True, timeout=PATIENCE, check=False
        )
        return run.stderr == f"{warning}\n"

    until(is_warned, warning)


def test_ros_arguments(program, eventually):
    command = "topic pub -r 10 /x std_msgs/msg/String --ros-args -r __node:=hand -r /x:=/y"
    program(*command.split())
    eventually("node list", "/hand\n")
    eventually("topic type /y", "std_msgs/msg/String\n")
    eventually("topic echo --once --field data /x --ros-args -r /x:=/y", "\n---\n")


def test_pub_waits_for_a_subscription(program, domain):
    running = program("topic", "pub", "--once", "/x", "std_msgs/msg/String", "{data: hello}")
    running.says("Waiting for at least 1 matching subscription(s)...\n")
    assert "publisher: beginning loop" not in running.output
    received: list[str] = []
    with NodeThread("listener") as listener:
        listener.node.create_subscription(String, "/x", lambda message: received.append(message.data), 1)
        assert running.ends() == 0
        until(lambda: received, "the message")
    assert received == ["hello"]
    assert running.output.endswith("publisher: beginning loop\npublishing #1: std_msgs.msg.String(data='hello')\n\n")


@pytest.mark.parametrize(
    ("command", "status", "said"),
    [
        ("topic echo --field . /x", 1, "Invalid field value '.'\n"),
        ("topic echo x//y", 1, "topic name"),
        ("topic hz a-b", 1, "topic name"),
        ("topic pub a-b std_msgs/msg/String", 1, "topic name"),
        ("topic pub {foo} std_msgs/msg/String", 1, "topic name"),
        ("topic pub /x std_msgs/msg/String {data:2001-99-99}", 1, "Failed to populate field"),
        ("topic pub /x std_msgs/msg/String data", 1, "The passed value needs to be a dictionary in YAML format\n"),
        ("topic list --ros-args --nonsense", 1, "ROS 2 does not know the arguments ['--nonsense']\n"),
    ],
)
def test_a_mistake_is_a_clear_error(program, command, status, said):
    running = program(*command.split())
    assert running.ends() == status
    assert said in running.output
    assert "Traceback" not in running.output


@pytest.mark.parametrize(
    ("command", "said"),
    [
        ("topic ecko /x", "No such command 'ecko'. Did you mean 'echo'?"),
        ("node lst", "No such command 'lst'. Did you mean 'list'?"),
        ("node info", "Missing argument 'NODE_NAME'."),
        ("topic echo", "Missing argument 'TOPIC_NAME'."),
        ("topic pub /x", "Missing argument 'MESSAGE_TYPE'."),
        ("topic pub /x std_msgs/msg/String -r 0", "0.0 is not in the range x>0."),
        ("topic pub /x std_msgs/msg/String -r -1", "-1.0 is not in the range x>0."),
        ("topic pub /x std_msgs/msg/String -r inf", "'inf' is not a number."),
        ("topic pub /x std_msgs/msg/String -t -1", "-1 is not in the range x>=0."),
        ("topic pub /x std_msgs/msg/String -1 -t 3", "argument -t/--times: not allowed with argument -1/--once"),
        ("topic hz --window 0 /x", "0 is not in the range x>=1."),
        ("topic echo --timeout 0 /x", "0.0 is not in the range 0<x<=1000000."),
        (
            "topic echo --qos-reliability relable /x",
            "'relable' is not one of 'reliable', 'best_effort', 'system_default'.",
        ),
    ],
)
def test_a_slip_of_the_pen_is_met_before_anything_starts(command, said):
    result = CliRunner().invoke(tank, command.split(), obj=[])
    assert result.exit_code == 2
    assert said in result.output


def test_help_comes_without_rclpy():
    code = "import sys, tutorial.commands.tank; sys.exit(bool({'rclpy', 'numpy', 'mujoco'} & {*sys.modules}))"
    subprocess.run([sys.executable, "-c", code], check=True)


class TestPopulate:
    @pytest.mark.parametrize(
        ("type_name", "text", "problem"),
        [
            ("sensor_msgs/msg/Joy", "{axis: [0.0, 0.5]}", "'Joy' object has no attribute 'axis'"),
            ("sensor_msgs/msg/Joy", "{header: {stmp: 1}}", "'Header' object has no attribute 'stmp'"),
            ("sensor_msgs/msg/Joy", "{axes: [a]}", "must be real number, not str"),
            ("sensor_msgs/msg/Joy", "{axes: 0.5}", "'float' object is not iterable"),
            ("sensor_msgs/msg/Joy", "{header: 3}", "Value '3' is expected to be a dictionary but is a int"),
            ("std_msgs/msg/Float64", "{data: null}", "Value 'None' is expected to be a dictionary but is a NoneType"),
            ("std_msgs/msg/Float64", "{data: fast}", "could not convert string to float: 'fast'"),
            ("std_msgs/msg/Int8", "{data: 300}", "The 'data' field must be"),
            ("sensor_msgs/msg/JointState", "{name: [1, 2]}", "The 'name' field must be"),
            ("sensor_msgs/msg/Imu", "{orientation_covariance: [1.0]}", "The 'orientation_covariance' "),
            ("diagnostic_msgs/msg/DiagnosticStatus", "{values: [{ky: a}]}", "'KeyValue' object has no attribute 'ky'"),
        ],
    )
    def test_what_does_not_fit(self, type_name, text, problem):
        with pytest.raises(Exception, match=re.escape(f"Failed to populate field: {problem}")):
            populated(passed_class(type_name), text)

    @pytest.mark.parametrize(
        ("type_name", "text", "shown"),
        [
            ("sensor_msgs/Joy", "{axes: [0, 0.5], buttons: [1]}", "axes=[0.0, 0.5], buttons=[1])"),
            ("std_msgs/msg/String", "data: 5", "std_msgs.msg.String(data='5')"),
            ("std_msgs/msg/Float64", "{data: 1e-3}", "std_msgs.msg.Float64(data=0.001)"),
            ("geometry_msgs/msg/Point", "{}", "geometry_msgs.msg.Point(x=0.0, y=0.0, z=0.0)"),
            (
                "diagnostic_msgs/msg/DiagnosticStatus",
                "{values: [{key: a}, {value: b}]}",
                "values=[diagnostic_msgs.msg.KeyValue(key='a', value=''), "
                "diagnostic_msgs.msg.KeyValue(key='', value='b')])",
            ),
            ("geometry_msgs/msg/Pose", "{position: {x: 1}}", "position=geometry_msgs.msg.Point(x=1.0, y=0.0, z=0.0)"),
        ],
    )
    def test_what_fits(self, type_name, text, shown):
        message, stamps = populated(passed_class(type_name), text)
        assert shown in repr(message)
        assert not stamps

    @pytest.mark.parametrize("text", ["{header: auto}", "{header: {stamp: now}}"])
    def test_times(self, text):
        message, stamps = populated(passed_class("sensor_msgs/msg/Joy"), text)
        time = passed_class("builtin_interfaces/msg/Time")
        for sec in (3, 4):
            for stamp in stamps:
                stamp(time(sec=sec))
            assert message.header.stamp.sec == sec

    def test_a_header_that_is_not_auto(self):
        with pytest.raises(Exception, match="Value 'atuo' is expected to be a dictionary but is a str"):
            populated(passed_class("sensor_msgs/msg/Joy"), "{header: atuo}")

    def test_what_is_no_yaml(self):
        with pytest.raises(
            Exception, match=r"(?s)The passed value needs to be in YAML string or a dictionary\n.*line 1"
        ):
            populated(passed_class("std_msgs/msg/String"), "{data: [")
