"""A further step needs its own files and a row in each table of steps, nothing else: one is added to a copy.

The files are in ``further_step/``, each where it belongs in the course.
"""

from __future__ import annotations

import json
import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from tutorial.paths import HOME

STEP = Path(__file__).parent / "further_step"
NUMBER = 1 + max(int(path.name[0]) for path in (HOME / "notebooks").glob("[0-9]_*.ipynb"))
PAGE = f"notebooks/{NUMBER}_raw_imu_publisher.ipynb"
NOTEBOOK = f"[`{NUMBER}_raw_imu_publisher`]({PAGE})"
CONTROLLER = "[`raw_imu_publisher.py`](tutorial/controllers/raw_imu_publisher.py)"
CHECK = "[`raw_imu_publisher.py`](tutorial/checks/raw_imu_publisher.py)"
FILES = (
    f"[`step{NUMBER}.yaml`](project/step{NUMBER}.yaml) | [`step{NUMBER}.launch.py`](launch_py/step{NUMBER}.launch.py)"
)
ROWS = {
    "README.md": f"| {NUMBER} | {NOTEBOOK} | a publisher of the sensors | {CONTROLLER} | {FILES} | `/Tank/raw_imu` |",
    "CONTRIBUTING.md": f"| {NUMBER} | {NOTEBOOK} | {CONTROLLER} | {CHECK} | {FILES} |",
    "book/index.md": f"| [Step {NUMBER}]({PAGE}) | what is measured | `/Tank/raw_imu` |",
}
TESTS = [
    *(PAGE, "tests/checks/test_lean.py", "tests/checks/test_exercise.py"),
    *("tests/course/test_notebooks.py", "tests/house/test_layout.py", "tests/house/test_readme.py"),
    *("-k", "not test_exercise or lean or controller"),  # of what all exercises are asked, only what is about this one
]


def committed():
    """The files of the repository; where git does not know them, those that are there."""
    listing = ""
    if shutil.which("git"):
        listing = subprocess.run(["git", "ls-files"], cwd=HOME, capture_output=True, text=True, check=False).stdout
    there = map(Path, listing.splitlines()) if listing else (path.relative_to(HOME) for path in HOME.rglob("*"))
    return [path for path in there if (HOME / path).is_file() and (listing or path.parts[0][0] != ".")]


def numbered(text):
    """Put the next step's number in the place of an N."""
    return re.sub(r"\b(step|Step |)N(?=\b|_raw)", rf"\g<1>{NUMBER}", text)


@pytest.fixture(scope="module")
def course(tmp_path_factory):
    """A copy of the course, with the step."""
    copy = tmp_path_factory.mktemp("course")
    for path in committed():
        (copy / path).parent.mkdir(parents=True, exist_ok=True)
        shutil.copy(HOME / path, copy / path)
    for path in STEP.rglob("*.*"):
        if path.suffix != ".pyc":
            target = copy / numbered(str(path.relative_to(STEP)))
            target.parent.mkdir(parents=True, exist_ok=True)
            target.write_text(numbered(path.read_text("utf-8")), encoding="utf-8")
    for name, row in ROWS.items():
        page = copy / name
        with_row = re.sub(r"^\| step \|.*\n(\|.*\n)+", rf"\g<0>{row}\n", page.read_text("utf-8"), flags=re.MULTILINE)
        page.write_text(with_row, encoding="utf-8")
    return copy


@pytest.fixture
def environment(course, monkeypatch):
    """That of a process in the copy, which imports the copy's tutorial."""
    monkeypatch.chdir(course)
    return {"PYTHONPATH": f"{course}{os.pathsep}{os.environ.get('PYTHONPATH', '')}"}


@pytest.mark.parametrize(("command", "node", "seconds"), [("run", "tank", 1), ("launch", "simulation", 2)])
def test_it_runs_and_publishes(program, environment, tmp_path, command, node, seconds):
    running = program(
        command, f"step{NUMBER}", "--headless", "--duration", seconds, "--report", tmp_path, environment=environment
    )
    assert running.ends() == 0, running.output
    topics = json.loads((tmp_path / f"{node}.json").read_text())["topics"]
    assert topics["/Tank/raw_imu"]["published"] == 50 * seconds


def test_the_tests_of_steps_pass_with_it(environment):
    words = [sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider", *TESTS]
    done = subprocess.run(words, env={**os.environ, **environment}, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout + done.stderr


def test_no_file_that_was_there_differs_but_the_tables(course):
    assert {str(path) for path in committed() if (course / path).read_bytes() != (HOME / path).read_bytes()} == {*ROWS}
