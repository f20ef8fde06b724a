"""``tank race`` as a teacher runs it: scores, failing drivers, and that nothing is left behind."""

import json
from pathlib import Path

import psutil
import pytest
from pictures import need_pictures
from programs import need_sandbox_here, until

from tutorial.commands import racing

DRIVERS = Path(__file__).parents[1] / "support" / "drivers"

STANDS = """import rclpy
from sensor_msgs.msg import Joy
rclpy.init()
node = rclpy.create_node("driver")
publishers = [node.create_publisher(Joy, "/joy", 1)]
print("it stands")
"""
DEAF = "import signal, subprocess, sys\nsignal.signal(signal.SIGINT, signal.SIG_IGN)\n"
DAEMONS = """
subprocess.run(["sh", "-c", "sleep 999 &"], start_new_session=True)
unmarked = subprocess.Popen(["sleep", "999"], start_new_session=True, env={})
open(__file__ + ".pid", "w").write(str(unmarked.pid))
"""
ENDLESS = "while True: pass\n"
RIVAL = "from tf2_msgs.msg import TFMessage\npublishers.append(node.create_publisher(TFMessage, '/tf', 1))\n"
NOSY = """
from sensor_msgs.msg import Image
node.create_subscription(Image, "/Tank/camera/image", lambda _: open("{}", "w"), 1)
rclpy.spin(node)
"""
FAULTY = {
    "crash": (STANDS + "1 / 0\n", "ZeroDivisionError: division by zero"),
    "ends": ("print('score: 100')\n", "the driver's program has ended"),
    "rival": (DEAF + DAEMONS + STANDS + RIVAL + ENDLESS, "2 publishers on /tf, not 1"),
}


@pytest.fixture(autouse=True)
def _pictures():
    need_pictures()


@pytest.mark.process
def test_a_good_driver_gets_over_80_points_and_a_page(program, tmp_path):
    board = tmp_path / "scores.json"
    running = program("race", DRIVERS / "good.py", "--json", board, "--replay", tmp_path / "new")
    assert running.ends() == 0
    (line,) = board.read_text().splitlines()
    entry = json.loads(line)
    assert (entry["driver"], entry["layout"], entry["progress"], entry["end"]) == (
        "good.py",
        "bend",
        1.0,
        "rail touched",
    )
    assert entry["score"] > 80
    assert f"{entry['score']:.1f}" in running.output
    assert "<title>good.py, bend</title>" in (tmp_path / "new" / "good-bend.html").read_text()
    running.leaves_nothing()


@pytest.mark.process
def test_a_league_names_each_fault_and_leaves_nothing(program, tmp_path):
    paths = [tmp_path / f"{name}.py" for name in FAULTY]
    for path, (text, _) in zip(paths, FAULTY.values()):
        path.write_text(text)
    running = program("race", *paths, "--layout", "hook", "--json", tmp_path / "scores.json")
    assert running.ends() == 1
    entries = [json.loads(line) for line in (tmp_path / "scores.json").read_text().splitlines()]
    assert {entry["driver"]: entry["note"] for entry in entries} == {f"{n}.py": said for n, (_, said) in FAULTY.items()}
    assert {entry["score"] for entry in entries} == {0.0}
    assert "crash.py: ZeroDivisionError: division by zero" in running.output
    assert "score: 100" not in running.output
    unmarked = int((tmp_path / "rival.py.pid").read_text())
    until(lambda: not psutil.pid_exists(unmarked), "the end of the process without a mark")
    running.leaves_nothing()


@pytest.mark.process
def test_in_the_sandbox_a_driver_sees_pictures_and_changes_no_file(program, tmp_path):
    need_sandbox_here()
    (tmp_path / "nosy.py").write_text(STANDS + NOSY.format(tmp_path / "mine"))
    running = program("race", tmp_path / "nosy.py", "--sandbox", "--json", tmp_path / "scores.json")
    assert running.ends() == 1
    entry = json.loads((tmp_path / "scores.json").read_text())
    assert entry["seconds"] > 0
    assert entry["note"].startswith(("OSError: ", "FileNotFoundError: ")), entry
    assert not (tmp_path / "mine").exists()
    running.leaves_nothing()


@pytest.mark.process
def test_ctrl_c_ends_an_endless_driver(program, tmp_path):
    path = tmp_path / "endless.py"
    path.write_text(DEAF + STANDS + ENDLESS)
    running = program("race", path)
    running.says("it stands")
    running.asks_to_stop()
    assert running.ends() == 130
    assert "Interrupted: 1 of 1 races were not finished." in running.output
    running.leaves_nothing()


@pytest.mark.process
def test_without_pictures_nothing_starts(program):
    running = program("race", DRIVERS / "good.py", environment={"MUJOCO_GL": "nonsense"})
    assert running.ends() == 1
    assert "Error: a race needs the camera's pictures, but MuJoCo can't render: " in running.output


def test_a_changed_or_new_file_changes_the_fingerprint(tmp_path, monkeypatch):
    monkeypatch.setattr(racing, "PACKAGE", tmp_path)
    monkeypatch.setattr(racing, "original", lambda: tmp_path)
    (tmp_path / "project" / "race").mkdir(parents=True)
    seen = {racing.fingerprint()}
    for name in ("code.py", "project/race.yaml", "project/race/bend.yaml"):
        for text in ("", "1", "2"):
            (tmp_path / name).write_text(text)
            seen.add(racing.fingerprint())
    assert len(seen) == 10
    (tmp_path / "notes.txt").write_text("")
    assert racing.fingerprint() in seen


@pytest.mark.nightly
def test_the_baseline_scores_the_same_every_time(program, tmp_path):
    board = tmp_path / "scores.json"
    running = program("race", *[DRIVERS / "baseline.py"] * 4, "--json", board)
    assert running.process.wait(300) == 0
    scores = [json.loads(line)["score"] for line in board.read_text().splitlines()]
    assert 35 < min(scores) <= max(scores) < 45
    assert max(scores) - min(scores) < 0.02 * max(scores)
