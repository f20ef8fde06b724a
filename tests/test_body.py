"""A body: its joints by name, and whose it is."""

from __future__ import annotations

import math
import threading
from pathlib import Path

import numpy as np
import pytest

from tutorial.body import Body
from tutorial.errors import TutorialError, WrongThreadError
from tutorial.world import Placement

MODELS = Path(__file__).parent.parent / "project" / "models"


@pytest.fixture
def tank():
    return Body.displayed(Placement("Tank", MODELS / "tank.xml", (-2.0, -0.5, 0.1)))


def test_the_tanks_joints_are_its_turrets(tank):
    assert tank.joint_names == ("TURRET_Y", "TURRET_P")
    assert tank.joint_ranges["TURRET_P"] == pytest.approx((math.radians(-10), math.radians(45)))


def test_another_name_changes_no_joints_name():
    other = Body.displayed(Placement("Panzer", MODELS / "tank.xml"))
    assert other.joint_names == ("TURRET_Y", "TURRET_P")


def test_another_model_has_its_own_joints():
    crane = Body.displayed(Placement("Crane", MODELS / "crane.xml"))
    assert len(crane.joint_names) == 3
    assert not set(crane.joint_names) & {"TURRET_Y", "TURRET_P"}


def test_positions_are_set_by_name_and_the_links_follow(tank):
    before = tank.data.xquat.copy()
    tank.set_joint_positions({"TURRET_P": 0.25})
    tank.calc_forward_kinematics()
    assert tank.joint("TURRET_P").position == 0.25
    assert tank.joint("TURRET_Y").position == 0.0
    assert not (tank.data.xquat == before).all()


@pytest.mark.parametrize(("model", "root"), [("tank", "CHASSIS"), ("crane", "BASE")])
def test_its_position_is_its_roots_whether_that_is_free_or_fixed(model, root):
    body = Body.displayed(Placement("Robot", MODELS / f"{model}.xml", (1.0, 2.0, 3.0)))
    assert body.position.tolist() == body.data.body(f"Robot/{root}").xpos.tolist() == [1.0, 2.0, 3.0]
    before = body.data.xpos[1:].copy()
    body.position += (0.5, 0.0, -0.25)
    assert (body.data.xpos[1:] == before).all()
    body.calc_forward_kinematics()
    assert body.data.xpos[1:] - before == pytest.approx(np.tile([0.5, 0.0, -0.25], (len(before), 1)))


@pytest.mark.parametrize("model", ["tank", "crane"])
def test_its_orientation_is_its_roots_and_in_mujocos_order(model):
    quarter = (math.sqrt(0.5), 0.0, 0.0, math.sqrt(0.5))  # to the left; w comes first
    body = Body.displayed(Placement("Robot", MODELS / f"{model}.xml", (1.0, 2.0, 3.0), quarter))
    assert body.orientation_wxyz.tolist() == pytest.approx(quarter)
    body.orientation_wxyz = (0.0, 0.0, 0.0, 1.0)
    body.calc_forward_kinematics()
    assert body.data.xmat[1].reshape(3, 3)[:, 0] == pytest.approx([-1.0, 0.0, 0.0])
    assert body.data.xpos[1].tolist() == body.position.tolist() == [1.0, 2.0, 3.0]


def test_its_twist_is_along_its_own_axes(tank):
    tank.orientation_wxyz = (math.sqrt(0.5), 0.0, 0.0, math.sqrt(0.5))
    tank.data.qvel[:6] = (0.0, 2.0, 3.0, 0.1, 0.2, 0.3)  # north in the world is ahead of who looks there
    assert tank.twist == pytest.approx([2.0, 0.0, 3.0, 0.1, 0.2, 0.3])
    assert not Body.displayed(Placement("Crane", MODELS / "crane.xml")).twist.any()


def test_a_body_without_links_stands_where_the_world_does(tmp_path):
    model = tmp_path / "floor.xml"
    model.write_text("<mujoco><worldbody><geom type='plane' size='1 1 1'/></worldbody></mujoco>")
    assert Body.displayed(Placement("Floor", model)).position.tolist() == [0.0, 0.0, 0.0]


def test_an_unknown_joint_is_named_with_the_nearest(tank):
    with pytest.raises(TutorialError, match=r"the body 'Tank' has no joint 'TURET_Y'\. Did you mean 'TURRET_Y'\?"):
        tank.joint("TURET_Y")
    with pytest.raises(TutorialError, match="no joint 'X'"):
        tank.set_joint_positions({"X": 0.0})


def test_an_unknown_actuator_is_named_with_the_nearest(tank):
    with pytest.raises(TutorialError, match=r"no actuator 'TRACK_X'\. Did you mean 'TRACK_[LR]'\?"):
        tank.actuator("TRACK_X")


def test_observers_hear_of_a_change(tank):
    heard = []
    tank.on_change(heard.append)
    tank.notify_change()
    assert heard == [None]


@pytest.mark.parametrize(
    ("action", "touch"),
    [
        ("set_joint_positions", lambda body: body.set_joint_positions({"TURRET_Y": 1.0})),
        ("calc_forward_kinematics", lambda body: body.calc_forward_kinematics()),
        ("notify_change", lambda body: body.notify_change()),
        ("Joint.position", lambda body: setattr(body.joint("TURRET_Y"), "position", 1.0)),
        ("Body.position", lambda body: setattr(body, "position", (1.0, 0.0, 0.0))),
        ("Body.orientation_wxyz", lambda body: setattr(body, "orientation_wxyz", (0.0, 0.0, 0.0, 1.0))),
    ],
)
def test_another_thread_may_not_touch_it(tank, action, touch):
    errors = []

    def callback():
        try:
            touch(tank)
        except WrongThreadError as error:
            errors.append(str(error))

    thread = threading.Thread(target=callback, name="executor")
    thread.start()
    thread.join()
    assert errors == [
        f"{action} was called on the thread 'executor', but the body 'Tank' belongs to the thread 'MainThread'. "
        "Post the call instead: call_later(f, message)."
    ]
    assert tank.joint("TURRET_Y").position == 0.0


def test_a_model_that_does_not_load_says_what_mujoco_says(tmp_path):
    model = tmp_path / "broken.xml"
    model.write_text("<mujoco><worldbody><geom type='cube'/></worldbody></mujoco>")
    with pytest.raises(TutorialError, match=r"broken\.xml' does not load\. MuJoCo says: .*cube"):
        Body.displayed(Placement("Broken", model))


def test_a_joint_without_a_motor_says_so(tmp_path):
    model = tmp_path / "door.xml"
    model.write_text("<mujoco><worldbody><body><joint name='HINGE'/><geom size='.1'/></body></worldbody></mujoco>")
    door = Body.displayed(Placement("Door", model))
    with pytest.raises(TutorialError, match="the joint 'HINGE' has no motor"):
        door.joint("HINGE").effort = 1.0
    assert door.joint("HINGE").range == (-math.inf, math.inf)


def test_a_sensor_is_found_by_name_and_holds_what_was_set(tank):
    sensor = tank.sensor("GYRO")
    assert sensor.value.tolist() == [0.0, 0.0, 0.0]
    sensor.value = (1.0, 2.0, 3.0)
    value = tank.sensor("GYRO").value
    assert value.tolist() == [1.0, 2.0, 3.0]
    value[0] = 9.0
    assert sensor.value[0] == 1.0


def test_an_unknown_sensor_is_named_with_the_nearest(tank):
    with pytest.raises(TutorialError, match=r"no sensor 'GYRO_'\. Did you mean 'GYRO'\?"):
        tank.sensor("GYRO_")


def test_a_displayed_sensor_belongs_to_the_main_thread(tank):
    errors = []

    def touch():
        try:
            tank.sensor("GYRO").value = (1.0, 0.0, 0.0)
        except WrongThreadError as error:
            errors.append(str(error))

    thread = threading.Thread(target=touch, name="executor")
    thread.start()
    thread.join()
    assert errors[0].startswith("Sensor.value was called on the thread 'executor'")
