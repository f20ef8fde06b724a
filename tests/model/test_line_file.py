"""Lines on the floor: the curve through their points, and mistakes in their files."""

import re

import mujoco
import numpy as np
import pytest

from tutorial.errors import TutorialError
from tutorial.model.line_file import HEIGHT, line_points, read_line
from tutorial.program.project import Project
from tutorial.system.paths import original
from tutorial.world import Placement, compose

LAYOUTS = sorted((original() / "project" / "race").glob("*.yaml"))


@pytest.fixture
def write(tmp_path):
    path = tmp_path / "line.yaml"
    return lambda text: path.write_text(text) and path


def points(path, position=(0.0, 0.0, 0.0)):
    model = compose([Placement("Line", path, position)])
    data = mujoco.MjData(model)
    mujoco.mj_kinematics(model, data)
    return line_points(model, data)


def test_the_curve_passes_through_the_points_in_short_pieces(write):
    given = [(-2, 0), (0, 0.5), (0, -1), (-1, 1)]  # it crosses itself
    curve = points(write(f"points: {list(map(list, given))}"), (0.25, 0, 0))
    for x, y in given:
        assert np.hypot(*(curve - (x + 0.25, y)).T).min() < 1e-9
    assert np.hypot(*np.diff(curve, axis=0).T).max() < 0.2
    assert len(points(write("points: [[0, 0], [0.05, 0]]"))) == 2


def test_it_is_seen_and_touches_nothing(write):
    model = read_line(write("points: [[-1, 0], [1, 0]]\nwidth: 0.1")).compile()
    assert not any([*model.geom_contype, *model.geom_conaffinity])
    np.testing.assert_allclose(model.geom_size[:, 1:], [[0.05, HEIGHT / 2]] * model.ngeom)


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("points: [[0, 0]]", "line 1: points: expected a list of length >= 2."),
        ("pionts: [[0, 0], [1, 0]]", "line 1: unknown key 'pionts'. Did you mean 'points'?"),
        ("points:\n- [0, 0]\n- [.nan, 1]", "line 3: points[1][0]: "),
        ("points:\n- [0, 0]\n- [1, 0]\n- [1, 0]", "line 4: this point repeats the previous one. Leave it out."),
        ("points:\n- [0, 0]\n- [3.05, 0]", "line 3: the line leaves the floor near this point, at (3.05, 0.00)."),
        ("points:\n- [0, 0]\n- [0, -3]", "Keep x within 3 m and y within 2.5 m of the centre of the laboratory."),
        ("points:\n- [0, -2.4]\n- [2.9, -2.4]\n- [2.9, -2.1]", "line 2: the line leaves the floor near this point"),
        ("points: [[0, 0], [1, 0]]\nwidth: 3", "line 2: width: expected a number <= 0.2."),
    ],
)
def test_a_mistake_is_reported_with_its_line(write, text, said):
    with pytest.raises(TutorialError, match=re.escape(said)):
        read_line(write(text))


@pytest.mark.parametrize("layout", LAYOUTS, ids=lambda path: path.stem)
def test_each_layout_begins_at_the_tank_and_ends_beside_the_rail(layout):
    project = Project.load(original() / "project" / "race.yaml").with_model("Line", layout)
    model = compose([each.placement for each in project.bodies], project.time_step)
    data = mujoco.MjData(model)
    mujoco.mj_kinematics(model, data)
    line = line_points(model, data)
    np.testing.assert_allclose(line[0], data.body("Tank/CHASSIS").xpos[:2])
    rail = data.geom("Labo/RAIL").xpos[:2]
    assert 0.15 < rail[0] - line[-1][0] < 0.3
    assert abs(rail[1] - line[-1][1]) < 0.5
