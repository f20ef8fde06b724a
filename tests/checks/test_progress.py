"""Solved exercises are recorded beside the notebook, and nowhere else."""

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
    """A notebook's folder, as the current directory."""
    monkeypatch.delenv("TANK_PROGRESS")  # this variable keeps the tests' records out of the course's folder
    monkeypatch.chdir(tmp_path)
    return tmp_path


@pytest.fixture
def notebook(folder, monkeypatch):
    """The same folder, as in a notebook's kernel."""
    monkeypatch.setattr(progress, "_in_notebook", lambda: True)
    return folder


@pytest.mark.process
def test_a_kernel_records_solved_exercises_beside_its_notebook(folder):
    with kernel() as running:
        printed = running.run(SOLVE)
    today = date.today().isoformat()
    assert re.search(rf"by_name +solved on {today}\n", printed)
    assert re.search(r"\n1 of \d+ exercises are solved\.\n$", printed)
    assert json.loads((folder / FILE).read_text()) == {"solved": {"by_name": today}}
    assert [path.name for path in folder.iterdir()] == [FILE]


def test_the_first_date_and_other_entries_stay(notebook):
    (notebook / "own").write_text('{"solved": {"aim": "2026-01-02", "gyro": 5}}')
    (notebook / FILE).symlink_to("own")
    remember("aim")
    remember("show")
    assert read_progress() == ({"aim": "2026-01-02", "gyro": 5, "show": date.today().isoformat()}, "")
    assert read_progress(notebook) == read_progress()
    assert (notebook / FILE).is_symlink()


@pytest.mark.parametrize("text", ["", '{"solved": ["hop"]}', "\xff", "[" * 100_000])
def test_a_broken_file_is_reported_and_not_changed(notebook, text):
    (notebook / FILE).write_text(text, encoding="latin-1")
    said = repr(Overview(exercise_names()))
    assert re.search(r"\n0 of \d+ exercises are solved\.\n", said)
    assert f"{FILE} cannot be read, so no exercise counts as solved: " in said
    remember("aim")
    assert (notebook / FILE).read_text(encoding="latin-1") == text


@pytest.mark.parametrize("make", [os.mkfifo, lambda path: path.touch() or os.truncate(path, 3 * 10**9)])
def test_a_file_that_is_not_small_and_regular_is_not_read(notebook, make):
    make(notebook / FILE)
    remember("aim")
    assert "it is not a regular file, or it is larger than 1 MB." in read_progress()[1]


def test_a_failed_write_does_not_change_the_file(notebook, monkeypatch):
    remember("aim")
    monkeypatch.setattr("pathlib.Path.replace", Mock(side_effect=OSError(28, "No space left on device")))
    remember("show")
    assert set(read_progress()[0]) == {"aim"}
    assert [path.name for path in notebook.iterdir()] == [FILE]


def test_without_a_notebook_nothing_is_recorded(folder):
    remember("aim")
    assert list(folder.iterdir()) == []


def test_the_overview_lists_every_exercise_once(folder):
    (folder / FILE).write_text('{"solved": {"aim": "2026-01-02"}}')
    names = [name for own in exercise_names().values() for name in own]
    assert len(names) == len(set(names)), "names identify exercises"
    *rows, last = repr(Overview(exercise_names())).splitlines()
    assert [row.split()[-3 if "solved" not in row else -4] for row in rows] == names
    assert [row.split()[-4:] for row in rows if "solved" in row] == [["aim", "solved", "on", "2026-01-02"]]
    assert last == f"1 of {len(names)} exercises are solved."
    page = Overview(exercise_names())._repr_html_()
    assert [page.count(mark) for mark in ("<tr>", "✓", "○")] == [len(exercise_names()), 1, len(names) - 1]
    assert f'<progress max="{len(names)}" value="1"' in page
    assert 'title="solved on 2026-01-02"' in page


def test_empty_overview(folder):
    overview = Overview(exercise_names(step=0))
    assert repr(overview) == "0 of 0 exercises are solved."
    assert "0 of 0 exercises are solved." in overview._repr_html_()


def test_tank_progress_shows_the_current_or_given_folder(folder):
    (folder / "notebooks").mkdir()
    (folder / "notebooks" / FILE).write_text('{"solved": {"aim": "2026-01-02"}}')
    for words in ((), (str(folder),), (str(folder / "notebooks"),)):
        assert re.search(r" aim +solved on 2026-01-02\n", CliRunner().invoke(tank, ["progress", *words]).output)
