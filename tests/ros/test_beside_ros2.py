"""The pocket ROS 2 and a real one in one domain: programs of one, and commands of the other.

They run if TANK_REAL_ROS2 is set to a command that runs another command with a real ROS 2, such as a script that
sources ``/opt/ros/jazzy/setup.bash`` and ends with ``exec "$@"``.
"""

import os
import shlex
import signal
import subprocess
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass

import pytest
import yaml
from packages import CONTROLLERS, install, need_setuptools
from pictures import need_pictures
from programs import TANK, TIMEOUT, until
from rclpy.qos import HistoryPolicy, QoSProfile, ReliabilityPolicy
from rclpy.serialization import serialize_message
from sensor_msgs.msg import JointState

from tutorial.ros.bags import Bag, Player, Recorder, bag_info
from tutorial.ros.domains import reserved_domain
from tutorial.ros.node_thread import NodeThread
from tutorial.ros.wheels import folder

REAL = shlex.split(os.environ.get("TANK_REAL_ROS2", ""))
JOINTS, JOY = "/Tank/joint_state", "/joy"
CAMERA = "/Tank/camera/image"
JOINT_STATE, STICK_TO_THE_RIGHT = "sensor_msgs/msg/JointState", "{axes: [0, 0, 0.3, 0]}"

pytestmark = [pytest.mark.ros2, pytest.mark.timeout(300)]
if not REAL:
    pytest.skip("TANK_REAL_ROS2 is not set to a command that runs other commands on ROS 2", allow_module_level=True)


@dataclass
class Beside:
    """A simulation on one ROS 2, and the commands of the other ROS 2.

    Attributes:
        simulation: the running simulation, or None.
        ros2: the words that start ``ros2`` on the other ROS 2.
        environment: the environment of both.
    """

    simulation: subprocess.Popen | None
    ros2: list[str]
    environment: dict[str, str]

    def run(self, *command: str) -> subprocess.CompletedProcess:
        """Run a command that exits on its own."""
        alone = self.ros2[-1] == "ros2" and command[0] != "bag" and command[1] in ("list", "info")
        arguments = [*self.ros2, *command, *["--no-daemon"] * alone]
        return subprocess.run(
            arguments, env=self.environment, check=False, capture_output=True, text=True, timeout=2 * TIMEOUT
        )

    def say(self, *command: str) -> str:
        """Return a command's output."""
        return self.run(*command).stdout

    def says(self, text: str, *command: str) -> str:
        """Repeat a command until its output contains a text: discovery takes a moment."""
        said = []
        until(lambda: said.append(self.say(*command)) or text in said[-1], f"{text!r} from {command}")
        return said[-1]

    @contextmanager
    def going_on(self, *command: str) -> Iterator[subprocess.Popen]:
        """Run a command in the background, and stop its process group with Ctrl-C."""
        arguments, pipe = [*self.ros2, *command], subprocess.PIPE
        process = subprocess.Popen(arguments, env=self.environment, stdout=pipe, text=True, start_new_session=True)
        try:
            yield process
        finally:
            if process.poll() is None:
                os.killpg(process.pid, signal.SIGINT)
            process.communicate(timeout=TIMEOUT)

    def joints(self) -> dict[str, float]:
        """Return the current positions of the simulated joints [rad]."""
        real = ["--no-lost-messages", JOINTS, JOINT_STATE] if self.ros2[-1] == "ros2" else [JOINTS]
        said = self.say("topic", "echo", "--once", *real)
        message = yaml.safe_load(said.partition("---")[0])
        return dict(zip(message["name"], message["position"], strict=True))

    def clear(self) -> None:
        """Stop everything that is still running, including the daemon of ``ros2``."""
        if self.simulation.poll() is None:
            os.killpg(self.simulation.pid, signal.SIGTERM)
        self.simulation.communicate(timeout=TIMEOUT)
        if self.ros2[-1] == "ros2":
            self.say("daemon", "stop")


@pytest.fixture(scope="module", params=["rmw_cyclonedds_cpp", "rmw_fastrtps_cpp"])
def rmw(request):
    return request.param


@contextmanager
def running(rmw: str, simulation: list[str], ros2: list[str], stdout: int = subprocess.DEVNULL, **variables: str):
    """Run a simulation in a separate domain, and stop all its processes."""
    with reserved_domain() as domain:
        environment = {**os.environ, **variables, "ROS_DOMAIN_ID": str(domain), "RMW_IMPLEMENTATION": rmw}
        process = subprocess.Popen(simulation, env=environment, stdout=stdout, text=True, start_new_session=True)
        beside = Beside(process, ros2, environment)
        try:
            yield beside
        finally:
            beside.clear()


@pytest.fixture(scope="module", params=["the real one's commands", "the pocket one's commands"])
def beside(request, rmw):
    """Step 2's running simulation, which the other side has discovered."""
    theirs = request.param.startswith("the real")
    tank, ros2 = ([TANK], [*REAL, "ros2"]) if theirs else ([*REAL, TANK], [TANK])
    with running(rmw, [*tank, "run", "step2", "--headless"], ros2) as beside:
        beside.says(JOINTS, "topic", "list")
        yield beside


def test_neither_side_complains(beside):
    assert beside.run("topic", "list").stderr == ""


def test_topic_info_shows_the_publisher_and_its_qos(beside):
    said = beside.says("Node name: tank", "topic", "info", "-v", JOINTS)
    hashed = "Topic type hash: RIHS01_a13ee3a330e346c9d87b5aa18d24e11690752bd33a0350f11c5882bc9179260e"
    wanted = {f"Type: {JOINT_STATE}", "Publisher count: 1", hashed, "Reliability: RELIABLE", "Durability: VOLATILE"}
    assert wanted <= {line.strip() for line in said.splitlines()}


def test_a_published_message_turns_the_turret(beside):
    before = beside.joints()
    with beside.going_on("topic", "pub", "-r", "10", JOY, "sensor_msgs/msg/Joy", STICK_TO_THE_RIGHT):
        until(lambda: abs(beside.joints()["TURRET_Y"] - before["TURRET_Y"]) > 0.05, "the turret turns")


def test_a_killed_node_leaves_the_graph(beside):
    beside.says("/tank\n", "node", "list")
    os.killpg(beside.simulation.pid, signal.SIGKILL)
    until(lambda: "/tank" not in beside.say("node", "list").splitlines(), "the node is gone")
    until(lambda: JOINTS not in beside.say("topic", "list"), "its topic is gone")


def test_a_real_topic_echo_receives_a_whole_image(rmw):
    need_pictures()
    with running(rmw, [TANK, "run", "step6", "--headless"], [*REAL, "ros2"]) as beside:
        beside.says(CAMERA, "topic", "list")
        whole = "data: '<sequence type: uint8, length: 230400>'"
        said = beside.says(whole, "topic", "echo", "--once", "--no-arr", CAMERA)
        assert {"encoding: rgb8", "step: 960", "  frame_id: Tank/CAMERA_optical"} <= set(said.splitlines())


def test_packages_run_and_launch_on_a_real_ros_2(rmw, tmp_path):
    need_setuptools()
    (tmp_path / "mine.py").write_text(CONTROLLERS, encoding="utf-8")
    own = ("--controller", tmp_path / "mine.py:JointStatePublisher")
    for name, arguments in (("own_tank", own), ("plain_node", ())):
        make = (TANK, "package", name, *arguments, "--destination-directory", tmp_path)
        subprocess.run(make, check=True, capture_output=True)
        site = install(tmp_path / name, tmp_path / "install")
    both = 'export AMENT_PREFIX_PATH=$0:$AMENT_PREFIX_PATH PYTHONPATH=$1:$PYTHONPATH; shift; exec "$@"'
    ros2 = [*REAL, "sh", "-c", both, str(tmp_path / "install"), str(site), "ros2"]  # as after install/setup.bash
    launch = [*ros2, "launch", "own_tank", "own_tank.launch.py"]
    variables = {"ROS_LOG_DIR": str(tmp_path / "log"), "RCUTILS_LOGGING_USE_STDOUT": "1", "TANK_HEADLESS": "1"}
    with running(rmw, launch, ros2, subprocess.PIPE, **variables) as beside:
        launched = beside.simulation
        assert any("[simulation]: mine publishes" in line for line in launched.stdout)
        with beside.going_on("run", "plain_node", "listener") as listener:
            assert any(line.endswith("[listener]: TURRET_Y 0.00, TURRET_P -0.01\n") for line in listener.stdout)
            pocket = Beside(launched, [TANK], beside.environment)
            pocket.says("/listener\n", "node", "list")
            pocket.says("/simulation\n", "node", "list")
        launched.send_signal(signal.SIGINT)
        launched.communicate(timeout=TIMEOUT)
        assert launched.returncode == 0


TRIGGER, SET_BOOL = "std_srvs/srv/Trigger", "std_srvs/SetBool"
ASKED = [
    ("service", "list", "-t"),
    ("service", "type", "/Tank/reset"),
    ("service", "call", "/Tank/reset", TRIGGER),
    ("service", "call", "/Tank/set_motors", SET_BOOL, "{data: true}"),
    ("service", "call", "/Tank/set_motors", SET_BOOL, "{dat: 1}"),
    ("service", "call", "/Tank/set_motors", JOINT_STATE),
    ("param", "list"),
    ("param", "list", "/tank"),
    ("param", "get", "/tank", "Tank.p_gain"),
    ("param", "get", "/tank", "nope"),
    ("param", "set", "/tank", "Tank.d_gain", "5.0"),
    ("param", "set", "/tank", "Tank.d_gain", "60"),
    ("param", "set", "/tank", "Tank.d_gain", "60.0"),
    ("param", "set", "/tank", "nope", "1"),
    ("param", "describe", "/tank", "Tank.d_gain", "use_sim_time"),
    ("param", "dump", "tank"),
    ("param", "dump", "/nope"),
]


@pytest.fixture(params=[pytest.param("the real one", marks=pytest.mark.nightly), "the wheels"])
def answering(request, rmw):
    """Step 10's running simulation on a real ROS 2, the commands of ``ros2``, and those of ``tank``."""
    if request.param == "the real one":
        tank, variables = [*REAL, TANK], {}
    elif rmw == folder.RMW and folder.state() == "installed":
        tank, variables = [TANK], {"TUTORIAL_ROS": "rclpy"}
    else:
        pytest.skip(f"there are no wheels with {rmw} here: see make ros")
    with running(rmw, [*tank, "run", "step10", "--headless"], [*REAL, "ros2"], **variables) as beside:
        beside.says("/Tank/set_motors", "service", "list")
        beside.says("/tank", "node", "list")
        yield beside, Beside(beside.simulation, tank, beside.environment)


def test_services_and_parameters_are_printed_as_by_ros2(answering, tmp_path):
    ros2, tank = answering

    def printed(beside, command):
        done = beside.run(*command)
        return done.stdout.replace(WAITING, ""), done.stderr, done.returncode

    for command in ASKED:
        ours = printed(tank, command)  # it waits for the node; ros2 does not wait long enough on Fast DDS
        until(lambda command=command, ours=ours: printed(ros2, command) == ours, f"{ours} from ros2 {command}")
    dumped = tmp_path / "tank.yaml"
    dumped.write_text(tank.say("param", "dump", "/tank").replace("p_gain: 200.0", "p_gain: 300.0"))
    assert "Set parameter Tank.p_gain successful" in ros2.say("param", "load", "/tank", str(dumped))
    assert ros2.say("param", "get", "/tank", "Tank.p_gain") == "Double value is: 300.0\n"


WAITING = "waiting for service to become available...\n"
"""What ``ros2 service call`` prints if its node has not discovered the service yet; ``tank`` first waits a moment."""

COUNT = 100
KEEP_ALL = QoSProfile(history=HistoryPolicy.KEEP_ALL, reliability=ReliabilityPolicy.RELIABLE)
PAYLOADS = [serialize_message(JointState(name=["TURRET_Y"], position=[i / 10])) for i in range(COUNT)]
FIRST = serialize_message(JointState(name=["TURRET_Y"], position=[-1.0]))


@pytest.fixture
def ros2(rmw, domain):
    """The commands of the real ROS 2."""
    return Beside(None, [*REAL, "ros2"], {**os.environ, "RMW_IMPLEMENTATION": rmw})


@pytest.fixture
def node(domain):
    with NodeThread("pocket") as thread:
        yield thread.node


def hear(node) -> list[bytes]:
    """Return a list of the payloads that arrive from now on."""
    payloads: list[bytes] = []
    node.create_subscription(JointState, JOINTS, payloads.append, KEEP_ALL, raw=True)
    return payloads


@pytest.fixture
def publisher(node):
    return node.create_publisher(JointState, JOINTS, KEEP_ALL)


def words(info):
    """Return the lines of a bag's info, sorted: a real ros2 prints topics in the order of a hash table."""
    return sorted(line.removeprefix("Topic information:").strip() for line in info.splitlines())


@pytest.mark.parametrize("storage", ["mcap", "sqlite3"])
def test_a_real_recording_is_read_and_played(ros2, node, publisher, tmp_path, storage):
    path, everything = tmp_path / "bag", tmp_path / "qos.yaml"
    everything.write_text(f"{JOINTS}: {{history: keep_all, reliability: reliable, durability: volatile}}")
    how = ("-s", storage, "-o", str(path), "--qos-profile-overrides-path", str(everything))
    with ros2.going_on("bag", "record", *how, "--topics", JOINTS):
        until(lambda: publisher.get_subscription_count() == 1, "the recorder")
        publisher.publish(FIRST)  # the recorder acknowledges it only once it knows the publisher, which may be later
        until(publisher.wait_for_all_acked, "the recorder knows of the publisher")
        for payload in PAYLOADS:
            publisher.publish(payload)
            threading.Event().wait(0.01)  # in real time, because it is played back later
        until(publisher.wait_for_all_acked, "what was published has arrived")
    bag = Bag(path)
    recorded = [data for _, _, data in bag.raw_messages([JOINTS])]
    assert recorded in (PAYLOADS, [FIRST, *PAYLOADS])
    assert bag.damage == ""
    assert words(bag_info(bag)) == words(ros2.say("bag", "info", str(path)))
    node.destroy_publisher(publisher)
    heard = hear(node)
    Player(node, bag, topics=[JOINTS]).run(threading.Event())
    until(lambda: len(heard) == len(recorded), "what was played")
    assert heard == recorded


@pytest.mark.parametrize("storage", ["mcap", "sqlite3"])
def test_a_real_ros_2_reads_and_plays_our_recording(ros2, node, publisher, tmp_path, storage):
    path, heard = tmp_path / "bag", hear(node)
    with NodeThread("recorder") as thread, Recorder(thread.node, path, [JOINTS], storage, 10.0) as recorder:
        until(lambda: publisher.get_subscription_count() == 2 and recorder.hears(JOINTS), "the match")
        for payload in PAYLOADS:
            publisher.publish(payload)
            threading.Event().wait(0.005)  # in real time, because it is played from a history of ten
    node.destroy_publisher(publisher)
    assert words(ros2.say("bag", "info", str(path))) == words(bag_info(Bag(path)))
    until(lambda: len(heard) == COUNT, "what was published")
    heard.clear()
    with ros2.going_on("bag", "play", str(path), "--delay", "3", "--loop") as playing:  # it may miss the first round
        until(lambda: heard[-COUNT:] == PAYLOADS or playing.poll() is not None, "what was played, from its beginning")
        assert heard[-COUNT:] == PAYLOADS
