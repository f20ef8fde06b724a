"""``tank race`` as a teacher runs it: scores, failing drivers, and that nothing is left behind."""

import json
import os
from pathlib import Path

import psutil
import pytest
from pictures import need_pictures
from programs import need_sandbox_here, until

from tutorial.commands import racing
from tutorial.commands.race import names_of, remarks
from tutorial.race.rules import Result

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
def test_a_limit_ends_a_race_early(program, tmp_path):
    running = program("race", DRIVERS / "baseline.py", "--limit", "1", "--json", tmp_path / "scores.json")
    assert running.ends() == 0
    entry = json.loads((tmp_path / "scores.json").read_text())
    assert (entry["end"], entry["limit"], round(entry["seconds"], 1)) == ("time up", 1.0, 1.0)


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
    assert "Error: a race needs camera images, but MuJoCo can't render: " in running.output


def test_a_changed_or_new_file_changes_the_fingerprint(tmp_path, monkeypatch):
    monkeypatch.setattr(racing, "PACKAGE", tmp_path)
    monkeypatch.setattr(racing, "original", lambda: tmp_path)
    (tmp_path / "project" / "race").mkdir(parents=True)
    line = tmp_path / "secret.txt"
    line.write_text("")
    seen = {racing.fingerprint(line)}
    for name in ("code.py", "project/race.yaml", "project/race/bend.yaml", "secret.txt"):
        for text in ("", "1", "2"):
            (tmp_path / name).write_text(text)
            seen.add(racing.fingerprint(line))
    assert len(seen) == 12
    (tmp_path / "notes.txt").write_text("")
    (tmp_path / "project" / ".ipynb_checkpoints").mkdir()
    os.mkfifo(tmp_path / "project" / "pipe.yaml")
    assert racing.fingerprint(line) in seen


@pytest.mark.parametrize(
    ("given", "names"),
    [
        (["ada.py", "ben.py"], ["ada.py", "ben.py"]),
        (["ada/drive.py", "ben/drive.py"], ["ada/drive.py", "ben/drive.py"]),
        (["class/ada/drive.py", "class/ben.py", "class/ada/../cy/drive.py"], ["ada/drive.py", "ben.py", "cy/drive.py"]),
        (["ada.py", "ada.py"], ["ada.py", "ada.py"]),
    ],
)
def test_drivers_with_the_same_file_name_are_named_by_their_folders(given, names):
    assert names_of(tuple(map(Path, given))) == names


def test_the_remarks_name_what_was_wrong():
    fine = racing.Entry("ada.py", "bend", Result(), real_time=1.0)
    slow = racing.Entry(
        "ben\n.py", "bend", Result(seconds=2.0, touched=("Lab/CRATE after 1.5 s",)), "1 / 0", real_time=0.5
    )
    assert remarks([fine, slow]).splitlines() == [
        "ben\\n.py: 1 / 0",
        "ben\\n.py: raced at 0.50 times real time: race again with nothing else running on this machine",
        "ben\\n.py: the tank has touched Lab/CRATE after 1.5 s",
    ]


@pytest.mark.process
def test_a_failed_race_does_not_end_the_league(program, tmp_path):
    path = tmp_path / f"{'a' * 250}.py"
    path.write_text(STANDS)
    (tmp_path / "loud.py").write_text(STANDS + "print('x' * 2_000_000, flush=True)\n1 / 0\n")
    running = program("race", path, tmp_path / "loud.py", "--replay", tmp_path / "pages")
    assert running.ends() == 1
    assert f"{path.name}: the replay cannot be written to " in running.output
    assert "loud.py: ZeroDivisionError: division by zero" in running.output
    running = program("race", tmp_path / "loud.py")
    assert running.ends() == 1
    assert "The rest of the driver's output is not shown." in running.output
    assert running.output.count("x") < 1_100_000


@pytest.mark.process
def test_a_driver_that_changes_the_line_ends_the_league(program, tmp_path):
    line = tmp_path / "secret.yaml"
    line.write_text("points: [[-2, -0.5], [2, -0.5]]")
    (tmp_path / "cheat.py").write_text(STANDS + f"open({str(line)!r}, 'a').write(' ')\n1 / 0\n")
    (tmp_path / "next.py").write_text(STANDS + ENDLESS)
    running = program("race", tmp_path / "cheat.py", tmp_path / "next.py", "--layout", line)
    assert running.ends() == 1
    assert "cheat.py: the line or the tutorial's files have changed\n" in running.output
    assert "have changed: restore them, and then race the remaining drivers." in running.output


@pytest.mark.nightly
def test_the_baseline_scores_the_same_every_time(program, tmp_path):
    board = tmp_path / "scores.json"
    running = program("race", *[DRIVERS / "baseline.py"] * 4, "--json", board)
    assert running.process.wait(300) == 0
    scores = [json.loads(line)["score"] for line in board.read_text().splitlines()]
    assert 35 < min(scores) <= max(scores) < 45
    assert max(scores) - min(scores) < 0.02 * max(scores)
