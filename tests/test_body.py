"""A body: its joints by name, and the thread that owns it."""

import math
from pathlib import Path

import mujoco
import numpy as np
import pytest
from scenes import raised_elsewhere

from tutorial.body import Body
from tutorial.errors import TutorialError, WrongThreadError
from tutorial.world import Placement, compose

MODELS = Path(__file__).parent.parent / "project" / "models"
LEFT = (math.sqrt(0.5), 0.0, 0.0, math.sqrt(0.5))  # a quarter turn; w first


def displayed(model, *where):
    return Body.displayed(Placement("Robot", MODELS / f"{model}.xml", *where))


@pytest.fixture
def tank():
    return Body.displayed(Placement("Tank", MODELS / "tank.xml", (-2.0, -0.5, 0.1)))


def test_a_body_has_its_models_joints_whatever_its_name(tank):
    assert tank.joint_names == displayed("tank").joint_names == ("TURRET_Y", "TURRET_P")
    assert tank.joint_ranges["TURRET_P"] == pytest.approx((math.radians(-10), math.radians(45)))
    assert displayed("crane").joint_names == ("BRIDGE", "SLEW", "LUFF")


def test_positions_are_set_by_name_and_the_links_follow(tank):
    before = tank.data.xquat.copy()
    tank.set_joint_positions({"TURRET_P": 0.25})
    tank.calc_forward_kinematics()
    assert (tank.joint("TURRET_P").position, tank.joint("TURRET_Y").position) == (0.25, 0.0)
    assert not (tank.data.xquat == before).all()


@pytest.mark.parametrize(("model", "root"), [("tank", "CHASSIS"), ("crane", "BASE")])
def test_its_pose_is_the_roots(model, root):
    body = displayed(model, (1.0, 2.0, 3.0), LEFT)
    assert body.position.tolist() == body.data.body(f"Robot/{root}").xpos.tolist() == [1.0, 2.0, 3.0]
    assert body.orientation_wxyz.tolist() == pytest.approx(LEFT)
    before = body.data.xpos[1:].copy()
    body.position += (0.5, 0.0, -0.25)
    assert (body.data.xpos[1:] == before).all()
    body.calc_forward_kinematics()
    assert body.data.xpos[1:] - before == pytest.approx(np.tile([0.5, 0.0, -0.25], (len(before), 1)))
    body.orientation_wxyz = (0.0, 0.0, 0.0, 1.0)
    body.calc_forward_kinematics()
    assert body.data.xmat[1].reshape(3, 3)[:, 0] == pytest.approx([-1.0, 0.0, 0.0])
    assert body.data.xpos[1].tolist() == body.position.tolist() == [1.5, 2.0, 2.75]


def test_reset_puts_only_this_body_back_at_rest():
    model = compose([Placement(name, MODELS / "tank.xml", (x, 0.0, 0.2)) for name, x in (("A", -2.0), ("B", 2.0))])
    data = mujoco.MjData(model)
    a, b = (Body(name, model, data) for name in "AB")
    starts = a.qpos.copy()
    data.qpos[:] += 0.1
    data.qvel[:] = 1.0
    moved = b.qpos.copy()
    a.reset()
    assert a.qpos.tolist() == starts.tolist()
    assert a.position.tolist() == [-2.0, 0.0, 0.2]
    assert not a.twist.any()
    assert not any(joint.velocity for joint in a.joints)
    assert (b.qpos.tolist(), b.joint("TURRET_Y").velocity) == (moved.tolist(), 1.0)


def test_its_twist_is_along_its_own_axes(tank):
    tank.orientation_wxyz = LEFT
    tank.data.qvel[:6] = (0.0, 2.0, 3.0, 0.1, 0.2, 0.3)  # north in the world is ahead in the body
    assert tank.twist == pytest.approx([2.0, 0.0, 3.0, 0.1, 0.2, 0.3])
    assert not displayed("crane").twist.any()


def test_a_sensor_keeps_its_values_and_returns_copies(tank):
    sensor = tank.sensor("GYRO")
    assert sensor.value.tolist() == [0.0, 0.0, 0.0]
    sensor.value = (1.0, 2.0, 3.0)
    value = tank.sensor("GYRO").value
    assert value.tolist() == [1.0, 2.0, 3.0]
    value[0] = 9.0
    assert sensor.value[0] == 1.0


def test_missing_parts_are_empty(tmp_path):
    floor, door = tmp_path / "floor.xml", tmp_path / "door.xml"
    floor.write_text("<mujoco><worldbody><geom type='plane' size='1 1 1'/></worldbody></mujoco>")
    door.write_text("<mujoco><worldbody><body><joint name='HINGE'/><geom size='.1'/></body></worldbody></mujoco>")
    assert Body.displayed(Placement("Floor", floor)).position.tolist() == [0.0, 0.0, 0.0]
    hinge = Body.displayed(Placement("Door", door)).joint("HINGE")
    assert hinge.range == (-math.inf, math.inf)
    with pytest.raises(TutorialError, match="the joint 'HINGE' has no motor"):
        hinge.effort = 1.0


@pytest.mark.parametrize(
    ("find", "said"),
    [
        (lambda body: body.joint("TURET_Y"), "joint 'TURET_Y'. Did you mean 'TURRET_Y'? Known: 'TURRET_P'"),
        (lambda body: body.set_joint_positions({"X": 0.0}), "joint 'X'. Known: 'TURRET_P', 'TURRET_Y'."),
        (lambda body: body.actuator("TRACK_RR"), "actuator 'TRACK_RR'. Did you mean 'TRACK_R'? Known: 'R"),
        (lambda body: body.sensor("GYRO_"), "sensor 'GYRO_'. Did you mean 'GYRO'? Known: 'ACC"),
    ],
)
def test_an_unknown_name_gets_a_suggestion(tank, find, said):
    with pytest.raises(TutorialError) as info:
        find(tank)
    assert str(info.value).startswith(f"the body 'Tank' has no {said}")


@pytest.mark.parametrize(
    ("action", "touch"),
    [
        ("set_joint_positions", lambda body: body.set_joint_positions({"TURRET_Y": 1.0})),
        ("reset", lambda body: body.reset()),
        ("calc_forward_kinematics", lambda body: body.calc_forward_kinematics()),
        ("notify_change", lambda body: body.notify_change()),
        ("Joint.position", lambda body: setattr(body.joint("TURRET_Y"), "position", 1.0)),
        ("Body.position", lambda body: setattr(body, "position", (1.0, 0.0, 0.0))),
        ("Body.orientation_wxyz", lambda body: setattr(body, "orientation_wxyz", (0.0, 0.0, 0.0, 1.0))),
        ("Sensor.value", lambda body: setattr(body.sensor("GYRO"), "value", (1.0, 0.0, 0.0))),
    ],
)
def test_another_thread_must_not_touch_it(tank, action, touch):
    error = raised_elsewhere(touch, tank)
    assert isinstance(error, WrongThreadError)
    assert str(error) == (
        f"{action} was called on the thread 'other_0', but the body 'Tank' belongs to the thread 'MainThread'. "
        "Post the call instead: call_later(f, message)."
    )
    assert tank.joint("TURRET_Y").position == 0.0


GRIPPER = """
<mujoco><worldbody><body name="PALM">
  <geom size="0.1"/>
  <body name="L"><joint name="L" type="slide"/><geom size="0.1"/></body>
  <body name="R"><joint name="R" type="slide"/><geom size="0.1"/></body>
</body></worldbody><equality><joint joint1="R" joint2="L" polycoef="0.1 -1 0 0 0"/></equality></mujoco>
"""


def test_coupled_joint(tmp_path):
    path = tmp_path / "gripper.xml"
    path.write_text(GRIPPER)
    gripper = Body.displayed(Placement("Gripper", path))
    right = gripper.joint("R")
    assert right.position == 0.1
    gripper.set_joint_positions({"L": 0.3})
    assert (right.position, gripper.followers) == (pytest.approx(-0.2), {"R"})
    gripper.set_joint_positions({"L": 0.4, "R": 0.5})
    gripper.set_joint_positions({"L": 0.6})
    assert (right.position, gripper.followers) == (0.5, set())
    gripper.qpos[:] = 0.7, 0.8  # as in a simulation
    gripper.calc_forward_kinematics()
    assert right.position == 0.8
