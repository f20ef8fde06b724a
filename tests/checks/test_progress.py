"""What is solved is remembered beside the notebook, and nowhere else."""

import json
import os
import re
from datetime import date
from unittest.mock import Mock

import pytest
from click.testing import CliRunner
from kernels import kernel

from tutorial.checks import progress
from tutorial.checks.catalogue import exercise_names
from tutorial.checks.progress import FILE, Overview, read_progress, remember
from tutorial.commands.tank import tank

SOLVE = """
from tutorial.checks.joint_state_subscriber import by_name
from tutorial.notebook import progress
await by_name.check(lambda names, message: {})
await by_name.check(by_name.right_answer)
print(progress())
"""


@pytest.fixture
def folder(tmp_path, monkeypatch):
    """A notebook's folder, in which this process works."""
    monkeypatch.delenv("TANK_PROGRESS")  # it keeps what tests solve from the course's own folder
    monkeypatch.chdir(tmp_path)
    return tmp_path


@pytest.fixture
def notebook(folder, monkeypatch):
    """The same, as a notebook's kernel sees it."""
    monkeypatch.setattr(progress, "_in_notebook", lambda: True)
    return folder


@pytest.mark.process
def test_a_kernel_remembers_what_is_solved_beside_its_notebook(folder):
    with kernel() as running:
        printed = running.run(SOLVE)
    today = date.today().isoformat()
    assert re.search(rf"by_name +solved on {today}\n", printed)
    assert re.search(r"\n1 of \d+ exercises are solved\.\n$", printed)
    assert json.loads((folder / FILE).read_text()) == {"solved": {"by_name": today}}
    assert [path.name for path in folder.iterdir()] == [FILE]


def test_the_first_day_counts_and_others_stay(notebook):
    (notebook / "own").write_text('{"solved": {"aim": "2026-01-02", "gyro": 5}}')
    (notebook / FILE).symlink_to("own")
    remember("aim")
    remember("show")
    assert read_progress() == ({"aim": "2026-01-02", "gyro": 5, "show": date.today().isoformat()}, "")
    assert read_progress(notebook) == read_progress()
    assert (notebook / FILE).is_symlink()


@pytest.mark.parametrize("text", ["", '{"solved": ["hop"]}', "\xff", "[" * 100_000])
def test_a_broken_file_is_said_and_left_as_it_is(notebook, text):
    (notebook / FILE).write_text(text, encoding="latin-1")
    said = repr(Overview(exercise_names()))
    assert re.search(r"\n0 of \d+ exercises are solved\.\n", said)
    assert f"{FILE} cannot be read, so nothing counts as solved: " in said
    remember("aim")
    assert (notebook / FILE).read_text(encoding="latin-1") == text


@pytest.mark.parametrize("make", [os.mkfifo, lambda path: path.touch() or os.truncate(path, 3 * 10**9)])
def test_what_is_no_small_file_is_not_read(notebook, make):
    make(notebook / FILE)
    remember("aim")
    assert "it is no file of at most 1 MB." in read_progress()[1]


def test_a_write_that_fails_leaves_the_file_as_it_was(notebook, monkeypatch):
    remember("aim")
    monkeypatch.setattr("pathlib.Path.replace", Mock(side_effect=OSError(28, "No space left on device")))
    remember("show")
    assert set(read_progress()[0]) == {"aim"}
    assert [path.name for path in notebook.iterdir()] == [FILE]


def test_where_there_is_no_notebook_nothing_is_remembered(folder):
    remember("aim")
    assert list(folder.iterdir()) == []


def test_the_overview_has_every_exercise_once_under_its_notebook(folder):
    (folder / FILE).write_text('{"solved": {"aim": "2026-01-02"}}')
    names = [name for own in exercise_names().values() for name in own]
    assert len(names) == len(set(names)), "they are known by their names"
    *rows, last = repr(Overview(exercise_names())).splitlines()
    assert [row.split()[-3 if "solved" not in row else -4] for row in rows] == names
    assert [row.split()[-4:] for row in rows if "solved" in row] == [["aim", "solved", "on", "2026-01-02"]]
    assert last == f"1 of {len(names)} exercises are solved."
    page = Overview(exercise_names())._repr_html_()
    assert (page.count("<tr>"), page.count("✓")) == (len(names), 1)


def test_empty_overview(folder):
    overview = Overview(exercise_names(step=0))
    assert repr(overview) == "0 of 0 exercises are solved."
    assert "0 of 0 exercises are solved." in overview._repr_html_()


def test_tank_progress_shows_the_folder_one_is_in_or_names(folder):
    (folder / "notebooks").mkdir()
    (folder / "notebooks" / FILE).write_text('{"solved": {"aim": "2026-01-02"}}')
    for words in ((), (str(folder),), (str(folder / "notebooks"),)):
        assert re.search(r" aim +solved on 2026-01-02\n", CliRunner().invoke(tank, ["progress", *words]).output)
