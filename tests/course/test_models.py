"""Physical behaviour that the models must show. No number in the models was tuned to pass these tests."""

import math
from pathlib import Path

import mujoco
import numpy as np
import pytest
from sensor_msgs.msg import Joy

from tutorial.controllers.tank_controller import TankController
from tutorial.handoff import Latest
from tutorial.simulation import Simulation
from tutorial.view.shapes import is_drawn
from tutorial.world import Placement, compose

MODELS = Path(__file__).parents[2] / "project" / "models"
START = (-2.0, -0.5, 0.1)
LEVEL = math.radians(5)
LOOK_EVERY = 0.005  # [s]


class Drive(Simulation):
    """The tank in the laboratory, with step 1's controller."""

    def __init__(self, position=START, heading_deg=0.0, *more):
        half = math.radians(heading_deg) / 2
        tank = Placement("Tank", MODELS / "tank.xml", position, (math.cos(half), 0, 0, math.sin(half)))
        self.controller = TankController()
        self.controller.joy = Latest(Joy())
        super().__init__([Placement("Labo", MODELS / "labo.xml"), tank, *more], [("Tank", self.controller)])
        self.chassis = self.world.data.body("Tank/CHASSIS")
        self.turret = self.bodies["Tank"].joint("TURRET_Y"), self.bodies["Tank"].joint("TURRET_P")
        self.steepest = 0.0

    def drive(self, seconds, v=0.0, h=0.0):
        """Hold the left stick at (v, h); the turret's reference does not change."""
        self.controller.joy.put(Joy(axes=[h, v]))
        for _ in range(round(seconds / LOOK_EVERY)):
            self.advance(LOOK_EVERY)
            self.steepest = max(self.steepest, math.acos(min(1.0, self.chassis.xmat[8])))  # angle from upright [rad]
        return self

    @property
    def position(self):
        return self.chassis.xpos.copy()

    @property
    def heading(self):
        return math.atan2(self.chassis.xmat[3], self.chassis.xmat[0])


# ----------------------------------------------------------------------------------------------- the files


@pytest.mark.parametrize(("file", "moves"), [("tank.xml", True), ("labo.xml", False), ("crane.xml", True)])
def test_each_file_compiles_without_a_warning_and_can_be_drawn(file, moves, tmp_path, monkeypatch, capfd):
    monkeypatch.chdir(tmp_path)  # MuJoCo writes its warnings to a file here
    model = mujoco.MjModel.from_xml_path(str(MODELS / file))
    data = mujoco.MjData(model)
    mujoco.mj_step(model, data, 100)
    assert (model.nv > 0) == moves
    assert not any(data.warning.number)
    assert not list(tmp_path.iterdir())
    assert all(is_drawn(model, geom) for geom in range(model.ngeom) if model.geom_group[geom] <= 2)
    assert capfd.readouterr() == ("", "")


def test_the_tank_matches_the_original():
    model = mujoco.MjModel.from_xml_path(str(MODELS / "tank.xml"))
    mass = {model.body(i).name: model.body_mass[i] for i in range(model.nbody)}
    assert mass["CHASSIS"] == 8
    for side in "LR":
        assert sum(m for name, m in mass.items() if name[:7] in (f"TRACK_{side}", f"WHEEL_{side}")) == 7
    assert (mass["TURRET_Y"], mass["TURRET_P"], mass["GUN"]) == (4, 3, 1)
    assert sum(mass.values()) == 30
    for name in ("TURRET_Y", "TURRET_P", "GUN"):
        np.testing.assert_allclose(model.body(name).inertia, 0.1)
    np.testing.assert_allclose(model.joint("TURRET_Y").axis, (0, 0, -1))
    np.testing.assert_allclose(model.joint("TURRET_P").axis, (0, -1, 0))
    np.testing.assert_allclose(np.degrees(model.joint("TURRET_Y").range), (-360, 360))
    np.testing.assert_allclose(np.degrees(model.joint("TURRET_P").range), (-10, 45))
    assert [model.actuator(i).name for i in range(model.nu)] == ["TRACK_L", "TRACK_R", "TURRET_Y", "TURRET_P", "RECOIL"]
    assert [model.tendon(i).name for i in range(model.ntendon)] == ["TRACK_L", "TRACK_R"]
    assert [model.sensor(i).name for i in range(model.nsensor)] == ["ACCEL_SENSOR", "GYRO"]
    assert [model.camera(i).name for i in range(model.ncam)] == ["CAMERA"]


# ------------------------------------------------------------------------------------------------- at rest


def test_rest_pose_and_effort_match_the_original():
    drive = Drive().drive(2)
    yaw, pitch = drive.turret
    assert pitch.position == pytest.approx(-0.00979, rel=0.01)
    assert pitch.effort == pytest.approx(1 * 9.80665 * 0.2, rel=0.01)
    assert (yaw.position, yaw.effort) == pytest.approx((0.0, 0.0), abs=1e-6)
    before = drive.position
    drive.drive(2)
    assert np.linalg.norm(drive.position - before) < 0.001 * 2


# ------------------------------------------------------------------------------------------------- driving


@pytest.mark.parametrize("v", [1.0, -0.5])
def test_straight(v):
    drive = Drive(START if v > 0 else (2.2, -0.5, 0.1)).drive(0.3)
    before = drive.position
    drive.drive(2, v=v)
    forward, sideways, _ = drive.position - before
    assert abs(sideways) < 0.02 * abs(forward)
    assert drive.world.data.qvel[0] == pytest.approx(2 * v, rel=0.03)
    assert abs(forward) > 0.85 * abs(2 * v) * 2


@pytest.mark.parametrize("h", [1.0, -0.5])
def test_on_the_spot(h):
    drive = Drive().drive(0.3)
    before = drive.position
    headings = [drive.heading, *(drive.drive(0.1, h=h).heading for _ in range(20))]
    np.testing.assert_allclose(drive.world.data.sensor("Tank/GYRO").data, drive.world.data.qvel[3:6], atol=0.01)
    turned = np.unwrap(headings)[-1] - headings[0]
    assert np.linalg.norm((drive.position - before)[:2]) < 0.1
    assert turned * h > 0, "positive h is to the left"
    # The tracks are 0.44 m apart, so without slip it would turn by 2 |h| / 0.44 m each second. A tank slips.
    without_slip = 2 * abs(h) / 0.44 * 2
    assert 0.25 * without_slip < abs(turned) < without_slip


@pytest.mark.parametrize(
    ("position", "heading", "v"),
    [
        ((2, -1.5, 0.1), -45, 1),
        ((-0.45, 0.9, 0.1), 90, 1),
        ((-1, -1.2, 0.1), -35, 1),
        ((-2, -1.5, 0.1), 45, -1),
    ],
    ids=["corner", "edge of a rack", "oblique", "backwards into the corner"],
)
def test_full_speed_into_a_wall_for_5_s_does_not_climb(position, heading, v):
    drive = Drive(position, heading).drive(0.1).drive(5, v=v)
    assert drive.steepest < LEVEL
    assert drive.position[2] < 0.12


@pytest.mark.parametrize("friction", [0.2, 1.0])
@pytest.mark.parametrize("x", [-0.2, 0.3])
def test_it_does_not_climb_a_wall_that_a_learner_adds(x, friction, tmp_path):
    wall = tmp_path / "wall.xml"
    wall.write_text(
        "<mujoco><worldbody><body>"
        f"<geom type='box' pos='0 0 0.3' size='0.05 1 0.3' friction='{friction} 0.005 0.0001'/>"
        "</body></worldbody></mujoco>"
    )
    drive = Drive(START, 0, Placement("Wall", wall, (x, -0.5, 0))).drive(0.1).drive(3, v=1)
    assert drive.position[0] < x - 0.3
    assert drive.steepest < LEVEL


@pytest.mark.parametrize("v", [1.0, 0.5])
def test_straight_ahead_from_the_start_the_rail_lifts_the_barrel(v):
    """The course's demonstration: drive straight ahead from the start pose until the tracks meet the wall."""
    drive = Drive().drive(1.5)
    barrel = drive.turret[1]
    rest = barrel.position
    drive.drive(2.5 / v + 0.5, v=v)
    assert drive.steepest < LEVEL
    drive.drive(1)
    assert barrel.position > rest + 0.01, "it rests on the rail"
    drive.drive(1, v=-v).drive(1)
    assert barrel.position == pytest.approx(rest, rel=0.02), "it comes down again"


def test_a_minute_of_random_driving():
    drive = Drive()
    random = np.random.default_rng(7)
    model, data = drive.model, drive.world.data
    for _ in range(150):
        v, h = random.uniform(-1, 1, 2)
        data.ctrl[:4] = 2 * v - h, 2 * v + h, random.uniform(-20, 20), random.uniform(-3, 7)
        mujoco.mj_step(model, data, 400)
        x, y, z = drive.position
        assert abs(x) < 3
        assert abs(y) < 2.5
        assert 0.09 < z < 0.15
    assert np.isfinite(data.qpos).all()
    assert not any(data.warning.number)


# ----------------------------------------------------------------------------------------------- the crane


def test_the_crane_keeps_its_pose_and_obeys_its_motors():
    model = compose([Placement("Labo", MODELS / "labo.xml"), Placement("Crane", MODELS / "crane.xml", (1, 1, 0))])
    data = mujoco.MjData(model)
    mujoco.mj_step(model, data, 2000)
    np.testing.assert_allclose(data.qpos, 0, atol=1e-3)
    for name, force in (("BRIDGE", 30), ("SLEW", 3), ("LUFF", 3)):
        data.ctrl[:] = 0
        data.actuator(f"Crane/{name}").ctrl = force
        before = data.joint(f"Crane/{name}").qpos[0]
        mujoco.mj_step(model, data, 500)
        assert data.joint(f"Crane/{name}").qpos[0] > before + 0.01


# ---------------------------------------------------------------------------------------------------- a shot


@pytest.mark.parametrize("yaw_deg", [0, 90])
def test_a_shot_jolts_the_tank_away_from_its_barrel_and_it_comes_to_rest_upright(yaw_deg):
    drive = Drive()
    drive.controller.joy.put(Joy(axes=[0.0, 0.0, -1.0, 0.0]))
    drive.advance(math.radians(yaw_deg) / 2 + 0.001)  # the stick turns the turret by 2 rad/s
    drive.drive(2)
    before, recoil = drive.position, drive.bodies["Tank"].actuator("RECOIL")
    recoil.ctrl = 40_000.0
    drive.advance(0.001)
    recoil.ctrl = 0.0
    drive.drive(2)
    back = drive.position - before
    yaw = -drive.turret[0].position
    assert 0.05 < -(back[0] * math.cos(yaw) + back[1] * math.sin(yaw)) < 0.3
    assert drive.steepest < math.radians(20)
    assert drive.chassis.xmat[8] > math.cos(LEVEL)
