"""The command that prints a robot's description."""

from __future__ import annotations

import pytest
from click.testing import CliRunner

from tutorial.body import Body
from tutorial.commands.tank import tank
from tutorial.description.urdf import robot_description
from tutorial.errors import TutorialError
from tutorial.paths import HOME
from tutorial.world import Placement

MODELS = HOME / "project" / "models"


@pytest.mark.parametrize("given", ["crane", "Crane", str(MODELS / "crane.xml")])
def test_it_prints_what_the_controller_publishes(given):
    done = CliRunner().invoke(tank, ["urdf", given])
    assert done.exit_code == 0, done.output
    assert done.output == robot_description(Body.displayed(Placement("Crane", MODELS / "crane.xml")))


@pytest.mark.parametrize(
    ("text", "said"),
    [
        (None, "there is no model 'tnak'. Did you mean 'tank'? Known are 'crane', 'labo', 'tank'."),
        ("<mujoco><worldbody><body><geom/></body></worldbody></mujoco>", "MuJoCo says: "),
        ("<mujoco><worldbody><body pos='1e99 0 0'><geom size='1'/></body></worldbody></mujoco>", "has a body_pos"),
    ],
)
def test_a_model_that_is_none_is_said(text, said, tmp_path):
    given = "tnak"
    if text is not None:
        given = str(tmp_path / "mine.xml")
        (tmp_path / "mine.xml").write_text(text, encoding="utf-8")
    done = CliRunner().invoke(tank, ["urdf", given])
    assert isinstance(done.exception, TutorialError)
    assert said in str(done.exception)
