"""Drive files, and what is said when they are wrong."""

from __future__ import annotations

import textwrap

import pytest

from tutorial.errors import TutorialError
from tutorial.joystick import ScriptedDrive
from tutorial.paths import find_drive


@pytest.fixture
def write(tmp_path):
    def write(text):
        path = tmp_path / "drive.yaml"
        path.write_text(textwrap.dedent(text))
        return path

    return write


def test_the_axes_are_held_from_each_moment_on(write):
    drive = ScriptedDrive(write("drive:\n- {time: 1, axes: [0, 0.5]}\n- {time: 2.5, axes: [1]}"))
    assert drive.read(0.0) == ([0.0] * 6, [])
    assert drive.read(1.0) == ([0.0, 0.5], [])
    assert drive.read(2.4) == ([0.0, 0.5], [])
    assert drive.read(99.0) == ([1.0], [])


def test_a_drive_may_repeat(write):
    drive = ScriptedDrive(
        write("repeat: true\ndrive:\n- {time: 0, axes: [0.1]}\n- {time: 1, axes: [0.2]}\n- {time: 2, axes: []}")
    )
    assert drive.read(0.5)[0] == drive.read(2.5)[0] == drive.read(200.5)[0] == [0.1]
    assert drive.read(1.5)[0] == drive.read(3.5)[0] == [0.2]


def test_the_tour_loads_and_moves_every_stick():
    tour = ScriptedDrive(find_drive("tour"))
    seen = [tour.read(t / 10)[0] for t in range(150)]
    assert all(any(axes[i] != 0 for axes in seen) for i in range(4))


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("drive: 3", "line 1: drive: expected a list, got a whole number."),
        ("drives: []", "line 1: 'drives' is not known here. Did you mean 'drive'?"),
        (
            "drive:\n- {time: 0, axes: [2]}",
            "line 2: drive[0].axes[0]: expected a number <= 1.0.",
        ),
        ("drive:\n- {time: -1, axes: [0]}", "line 2: drive[0].time: expected a number >= 0.0."),
        (
            "drive:\n- {time: 1, axes: [0]}\n- {time: 1, axes: [0]}",
            "line 3: 1.0 is not later than 1.0. Put the moments in order.",
        ),
        ("drive:\n- {time: 1, axis: [0]}", "line 2: 'axis' is not known here. Did you mean 'axes'?"),
    ],
)
def test_a_bad_drive_is_named_with_its_line_and_the_mend(write, text, said):
    path = write(text)
    with pytest.raises(TutorialError) as info:
        ScriptedDrive(path)
    assert str(info.value).startswith(f"{path}, {said}")


def test_a_missing_drive_is_named_with_the_nearest():
    with pytest.raises(TutorialError, match=r"there is no drive 'tuor'\. Did you mean 'tour'\?"):
        find_drive("tuor")
