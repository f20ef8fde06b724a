"""The command that prints a robot's description."""

from __future__ import annotations

import re

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


def test_a_model_that_is_none_is_said(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "mine.xml").write_text("<mujoco><worldbody><body><geom/></body></worldbody></mujoco>")
    for given, said in (("tnak", "there is no model 'tnak'. Did you mean 'tank'?"), ("mine.xml", "MuJoCo says")):
        with pytest.raises(TutorialError, match=re.escape(said)):
            CliRunner().invoke(tank, ["urdf", given], catch_exceptions=False)
