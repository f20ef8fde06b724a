"""`tank check` with a class whose answers try everything: each one gets its own verdict, and the teacher is safe."""

import asyncio
import json
import os
import shutil
import subprocess
from pathlib import Path
from xml.etree import ElementTree

import psutil
import pytest
from pictures import need_pictures
from programs import TANK, need_sandbox_here, until

from tutorial.checks.exercise import listing
from tutorial.checks.publish import publish
from tutorial.commands.checking import submission
from tutorial.system.paths import HOME

IMPORTS = "from tutorial.checks.joint_state_subscriber import by_name\nfrom tutorial.checks.tank_controller import aim"
PUBLISHER = """
from rclpy.time import Time
from sensor_msgs.msg import JointState
from tutorial.controller import SimpleController
"""
CHECK = "await by_name.check(match_by_name)"
RIGHT = """
import math

def match_by_name(joint_names, message):
    found = zip(message.name, message.position)
    return {name: position for name, position in found if name in joint_names and math.isfinite(position)}
"""
AT_ONCE = "class HeldJoint:\n    {}\n    def aim(self, stick): 1 / 0"
ENDLESS = "import time\n    while True: time.sleep(0.1)"  # without the pause it would use a core for `LIMIT` seconds
SHOUT = """
import os

def shout():
    for fd in range(3, 50):
        try:
            os.write(fd, b"all right\\n")
        except OSError:
            pass
"""
SLEEPER = "import sys, time; time.sleep(10_000)  # {}"
LIMIT = 30  # [s] time limit for an answer: judging one takes a second, or ten on a busy machine


def notebook(path, *sources):
    """Write a notebook with a cell for each source."""
    cells = [{"cell_type": "code", "source": source, "metadata": {}, "outputs": []} for source in sources]
    path.write_text(json.dumps({"cells": cells, "nbformat": 4, "nbformat_minor": 5, "metadata": {}}))
    return path


pytestmark = [pytest.mark.process, pytest.mark.timeout(320)]


@pytest.fixture(scope="module", autouse=True)
def bubblewrap():
    need_sandbox_here()


@pytest.fixture(scope="module")
def school(tmp_path_factory):
    """The notebooks of a class."""
    room = tmp_path_factory.mktemp("class")
    notebook(room / "ben.ipynb", IMPORTS, RIGHT.replace(" and math.isfinite(position)", ""), CHECK)
    notebook(room / "carl.ipynb", IMPORTS, AT_ONCE.format(ENDLESS), "await aim.check(HeldJoint)", RIGHT, CHECK)
    (room / "gina.ipynb").write_text("Dear teacher, \x1b[31m my dog has eaten it.")
    with (room / "hans.ipynb").open("wb") as file:
        file.truncate(submission.LARGEST + 1)
    os.mkfifo(room / "ida.ipynb")
    deep = SHOUT.replace("all right", r"{\"x\": " + "[" * 30_000)
    notebook(room / "jack.ipynb", IMPORTS, deep, AT_ONCE.format("shout(); os._exit(0)"), RIGHT, CHECK)
    command = f"[sys.executable, '-c', {SLEEPER.format(room)!r}], start_new_session=True"
    leave = f"import os, subprocess, sys; subprocess.Popen({command}); os._exit(0)"
    notebook(room / "kim.ipynb", IMPORTS, AT_ONCE.format(leave), RIGHT, CHECK)
    praise = SHOUT.replace("all right", r"""{\"type\": \"Judged\", \"exercise\": \"aim\", \"outcome\": \"right\"}""")
    notebook(room / "moe.ipynb", IMPORTS, praise, AT_ONCE.format("shout()"), RIGHT, CHECK)
    shutil.copy(HOME / "notebooks" / "2_joint_state_publisher.ipynb", room / "lena.ipynb")
    notebook(room / "nora.ipynb", PUBLISHER, listing(publish.right_answer))
    (room / ".ipynb_checkpoints").mkdir()
    notebook(room / ".ipynb_checkpoints" / "anna-checkpoint.ipynb", IMPORTS)
    return room


@pytest.fixture(scope="module")
def judged(school, tmp_path_factory):
    """The result: each learner's problem, and answers by exercise; the whole JSON; the process; the JUnit file."""
    junit = tmp_path_factory.mktemp("junit") / "junit.xml"
    words = [TANK, "check", school, "--json", "--limit", str(LIMIT), "--junit", junit, "--jobs", "3"]
    done = subprocess.run(words, capture_output=True, text=True, timeout=300, check=False)
    assert done.stdout, done.stderr
    whole = json.loads(done.stdout)
    by_learner = {
        Path(each["notebook"]).stem: (each["problem"], {answer["exercise"]: answer for answer in each["answers"]})
        for each in whole["notebooks"]
    }
    return by_learner, whole, done, junit


DISTURBED = "The answer interfered with the process that judged it."
AIM = [
    ("carl", "not judged", f"The answer did not finish within {LIMIT} s."),
    ("jack", "not judged", DISTURBED),
    ("kim", "not judged", submission.BROKEN),
    ("moe", "not judged", DISTURBED),
]


@pytest.mark.parametrize(("learner", "verdict", "cause"), AIM)
def test_each_answer_is_blamed_only_for_its_own_actions(judged, learner, verdict, cause):
    found = {exercise: (answer["verdict"], answer["cause"]) for exercise, answer in judged[0][learner][1].items()}
    assert found == {"aim": (verdict, cause), "by_name": ("right", "")}


def test_wrong_answers_have_causes_and_other_files_problems(judged):
    learners, _, done, _ = judged
    ben = learners["ben"][1]["by_name"]
    assert (ben["verdict"], bool(ben["cause"]), "✗" in ben["text"]) == ("wrong", True, True)
    assert {answer["verdict"] for answer in learners["lena"][1].values()} == {"not tried"}
    assert learners["nora"][1]["publish"]["verdict"] == "right", "this answer needs the tank's model"
    assert "anna-checkpoint" not in learners
    assert learners["gina"][0].startswith("not a notebook: JSONDecodeError: ")
    assert learners["hans"][0] == "it is larger than 50 MB"
    assert learners["ida"][0] == "it is not a file"
    assert "\x1b" not in done.stdout


def test_no_files_or_processes_are_left(judged, school):
    started = (process.info["cmdline"] or [] for process in psutil.process_iter(["cmdline"]))
    assert not [words for words in started if SLEEPER.format(school) in words]


def test_it_prints_a_summary(judged):
    _, whole, done, junit = judged
    assert done.returncode == 1
    assert whole["summary"][0].startswith("10 notebooks, ")
    assert whole["summary"][1] == "3 notebooks could not be judged."
    assert whole["summary"][2].startswith("The most frequent cause (")
    assert "10 of 10: " in done.stderr
    suites = {suite.get("name"): suite for suite in ElementTree.parse(junit).getroot()}
    assert len(suites) == 10
    carl = suites["carl.ipynb"]
    assert carl[0].find("error").get("message").startswith("The answer did not finish")
    assert suites["ben.ipynb"].find("testcase/failure") is not None
    assert suites["gina.ipynb"].find("testcase/error") is not None


def test_right_answers_exit_with_status_0(program, tmp_path):
    path = notebook(tmp_path / "nora.ipynb", RIGHT)
    running = program("check", path, notebook(tmp_path / "none.ipynb", "x = 1"))
    assert running.ends() == 0, running.output
    for words in (" by_name ", " right ", "2 notebooks, 1 answer: 1 right.\n", "no exercise"):
        assert words in running.output


def test_without_a_sandbox_nothing_is_judged_and_a_full_disk_costs_no_verdict(program, tmp_path):
    path = notebook(tmp_path / "kim.ipynb", AT_ONCE.format("import os; os._exit(0)"), RIGHT)
    running = program("check", path, "--no-sandbox", "--junit", "/dev/full")
    assert running.ends() == 1
    assert "2 answers: 1 right, 1 not judged" in running.output
    assert "The answers ran without a sandbox" in running.output
    assert "Error: the JUnit report cannot be written: No space left on device." in running.output
    assert "Traceback" not in running.output


@pytest.fixture
def judging(program, tmp_path):
    """A running check that has judged the first of two notebooks."""
    notebook(tmp_path / "a.ipynb", RIGHT)
    notebook(tmp_path / "b.ipynb", f"# {tmp_path}", AT_ONCE.format("while True: pass"))
    running = program("check", tmp_path, "--jobs", "1")
    running.says("1 of 2: a.ipynb")
    teacher = psutil.Process(running.process.pid)
    until(lambda: [p for p in teacher.children() if p.status() != psutil.STATUS_ZOMBIE], "the second notebook")
    below = teacher.children(recursive=True)
    yield running
    psutil.wait_procs(below, timeout=60)
    assert not [process for process in below if process.is_running() and process.status() != psutil.STATUS_ZOMBIE]


STANDS = """%%writefile my_driver.py
import rclpy
from sensor_msgs.msg import Joy
rclpy.init()
node = rclpy.create_node("driver")
publisher = node.create_publisher(Joy, "/joy", 1)
"""


def test_drivers_get_scores(program, tmp_path):
    need_pictures()
    notebook(tmp_path / "anna.ipynb", STANDS + "rclpy.spin(node)", RIGHT)
    notebook(tmp_path / "ben.ipynb", STANDS + "1 / 0")
    running = program("check", tmp_path, "--layout", "hook", "--json")
    assert running.ends() == 1
    text = running.output
    anna, ben = json.loads(text[text.index("{\n") : text.rindex("}") + 1])["notebooks"]
    assert [(each["exercise"], each["verdict"], each["score"]) for each in anna["answers"]] == [
        ("by_name", "right", None),
        ("race", "scored", 0.0),
    ]
    assert anna["answers"][1]["cause"].startswith("stuck: 0% of the line, 10.0 s, ")
    (race,) = ben["answers"]
    assert (race["verdict"], race["score"], race["cause"]) == ("wrong", 0.0, "ZeroDivisionError: division by zero")
    running.leaves_nothing()


def test_ctrl_c_ends_a_race(program, tmp_path):
    need_pictures()
    path = notebook(tmp_path / "anna.ipynb", STANDS + "rclpy.spin(node)")
    running = program("check", path)
    running.says("race 1 of 1: anna.ipynb")
    running.asks_to_stop()
    assert running.ends() == 130
    assert "The driver has not raced." in running.output
    assert "Interrupted: 1 of 1 notebooks were not judged." in running.output
    running.leaves_nothing()


def test_ctrl_c_shows_partial_results_and_leaves_nothing(judging):
    judging.asks_to_stop()
    assert judging.ends() == 130
    assert " right " in judging.output
    assert "Interrupted: 1 of 2 notebooks were not judged." in judging.output


def test_no_process_outlives_a_killed_check(judging):
    judging.process.kill()
    judging.ends()


def test_an_answers_processes_share_one_memory_limit(monkeypatch, tmp_path):
    monkeypatch.setattr(submission, "MEMORY", 3 << 30)
    sixteen = "import os, time\n    for _ in range(4): os.fork()\n    time.sleep(10_000)"
    path = notebook(tmp_path / "olga.ipynb", AT_ONCE.format(sixteen), RIGHT)
    verdicts = asyncio.run(submission.judge(path, LIMIT)).verdicts
    assert (verdicts["aim"].cause, verdicts["by_name"].outcome) == (submission.BROKEN, "right")


def test_a_check_can_be_interrupted_while_starting_a_process(tmp_path):
    path = notebook(tmp_path / "nora.ipynb", RIGHT)

    async def interrupt():
        for _ in range(100):
            judging = asyncio.ensure_future(submission.judge(path, LIMIT))
            await asyncio.sleep(0)
            judging.cancel()
            assert (await asyncio.wait([judging], timeout=LIMIT))[0]

    asyncio.run(interrupt())
