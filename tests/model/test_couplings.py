"""Coupled joints: MuJoCo's equalities set the joints that no message names."""

import mujoco
import numpy as np
import pytest

from tutorial.model.couplings import Followers, not_computed

JOINTS = """
  <body><joint name="R/a" type="slide" ref="0.1"/><geom size="0.1"/></body>
  <body><joint name="R/b" type="slide"/><geom size="0.1"/></body>
  <body><joint name="R/c" axis="0 0 1" ref="-0.2"/><geom size="0.1"/></body>
  <body><freejoint/><geom size="0.1"/><body><joint name="R/d" group="3"/><geom size="0.1"/></body></body>
"""

B_FOLLOWS_A = '<joint joint1="R/b" joint2="R/a" polycoef="0.3 -2 0 0 0"/>'
C_FOLLOWS_B = '<joint joint1="R/c" joint2="R/b" polycoef="0 1 0.5 0.25 0.125"/>'
D_FOLLOWS_C = '<joint joint1="R/d" joint2="R/c"/>'


def model_of(*equalities, option=""):
    """Return the model of a body `R` with coupled joints."""
    return mujoco.MjModel.from_xml_string(
        f'<mujoco><compiler angle="radian"/>{option}<worldbody>{JOINTS}</worldbody>'
        f"<equality>{''.join(equalities)}</equality></mujoco>"
    )


class Robot:
    """A model's joint positions, with the followers."""

    def __init__(self, model):
        self.model, self.data = model, mujoco.MjData(model)
        self.followers = Followers(model, "R/")

    def set(self, **positions):
        for name, position in positions.items():
            self.data.joint(f"R/{name}").qpos = position
        self.followers.update(positions, self.data.qpos)
        return self

    def __getitem__(self, name):
        return self.data.joint(f"R/{name}").qpos[0]

    def error(self):
        """Return the largest violation of the equalities, according to MuJoCo."""
        mujoco.mj_forward(self.model, self.data)
        return np.abs(self.data.efc_pos[self.data.efc_type == mujoco.mjtConstraint.mjCNSTR_EQUALITY]).max(initial=0.0)


@pytest.mark.parametrize(
    ("named", "equalities"),
    [
        ({"a": 0.7}, [B_FOLLOWS_A]),
        ({"a": 0.7}, [C_FOLLOWS_B, D_FOLLOWS_C, B_FOLLOWS_A]),
        ({"b": 0.7}, [B_FOLLOWS_A, C_FOLLOWS_B]),
        ({"d": 0.7}, [D_FOLLOWS_C]),
        ({"a": 0.7}, [B_FOLLOWS_A, '<joint joint1="R/c" polycoef="0.4 7"/>']),
        ({"a": 0.7}, ['<joint joint1="R/b" joint2="R/a"/>', '<joint joint1="R/a" joint2="R/b"/>']),
        ({"a": 0.7, "b": -0.9}, [B_FOLLOWS_A, D_FOLLOWS_C]),
    ],
    ids=["follower", "chain", "from either end", "hidden", "constant", "circle", "named itself"],
)
def test_equalities_hold(named, equalities):
    robot = Robot(model_of(*equalities))
    robot.followers.begin(robot.data.qpos)
    robot.set(**named)
    assert {name: robot[name] for name in named} == named
    assert robot.error() < 1e-12


def test_before_any_message():
    robot = Robot(model_of(B_FOLLOWS_A, C_FOLLOWS_B))
    assert robot.error() > 0.1
    robot.followers.begin(robot.data.qpos)
    assert robot.error() < 1e-12
    assert robot.followers.names == frozenset()


def test_named_joint():
    robot = Robot(model_of(B_FOLLOWS_A, C_FOLLOWS_B)).set(a=0.1)
    assert robot.followers.names == {"b", "c"}
    assert robot.set(b=5.0)["b"] == 5.0
    robot.set(a=0.2)
    assert (robot["b"], robot.followers.names) == (5.0, {"c"})


@pytest.mark.parametrize(
    ("equality", "option"),
    [
        (B_FOLLOWS_A.replace("/>", ' active="false"/>'), ""),
        (B_FOLLOWS_A, '<option><flag equality="disable"/></option>'),
        (C_FOLLOWS_B.replace("R/c", "R/a"), ""),
    ],
    ids=["inactive", "disabled", "no inverse"],
)
def test_no_follower(equality, option):
    robot = Robot(model_of(equality, option=option)).set(a=0.7)
    assert (robot["b"], robot.followers.names) == (0.0, frozenset())


def test_first_equality_wins():
    robot = Robot(model_of(B_FOLLOWS_A, '<joint joint1="R/b" joint2="R/c"/>')).set(a=0.1)
    assert robot["b"] == pytest.approx(0.3)
    assert robot["c"] == pytest.approx(0.3 - 0.2)


def test_not_computed():
    assert not_computed(model_of(B_FOLLOWS_A)) == []
    connect = '<connect name="k" body1="P" body2="Q" anchor="0 0 0"/><weld body1="P" active="false"/>'
    linked = mujoco.MjModel.from_xml_string(
        '<mujoco><worldbody><body name="P"><geom size="1"/></body><body name="Q"><joint/><geom size="1"/></body>'
        f"</worldbody><equality>{connect}</equality></mujoco>"
    )
    assert not_computed(linked) == ["connect"]
