"""The arrows of inertial sensors: their directions, when they appear, and their line."""

import math

import numpy as np
import pytest
from scenes import commands

from tutorial.body import Body
from tutorial.system.paths import HOME
from tutorial.view.animation import Animation
from tutorial.view.bodies import View
from tutorial.view.scene import Scene
from tutorial.view.shapes import draw_arrow
from tutorial.world import Placement

RED, BLUE = "/Bodies/Tank/acceleration", "/Bodies/Tank/angular velocity"
FRAMES = 40  # enough for a smoothed arrow to come to rest


class Stage:
    """A displayed tank, turned by 90 degrees to the left, in a view."""

    def __init__(self):
        half = math.sqrt(0.5)
        model = HOME / "project" / "models" / "tank.xml"
        self.body = Body.displayed(Placement("Tank", model, (1.0, 2.0, 0.1), (half, 0.0, 0.0, half)))
        self.scene = Scene()
        self.view = View(self.scene)
        self.view.add("Tank", self.body.model)
        self.messages = []
        self.scene.attach(self.messages.append)

    def measure(self, acceleration=(0.0, 0.0, 9.80665), velocity=(0.0, 0.0, 0.0), frames=FRAMES):
        self.body.sensor("ACCEL_SENSOR").value = acceleration
        self.body.sensor("GYRO").value = velocity
        self.view.update("Tank", self.body.data)
        for _ in range(frames):
            self.view.flush()

    def arrows(self, path):
        """Return the matrices that were sent."""
        sent = [each for each in commands(b"".join(self.messages)) if each["path"] == path]
        return [np.array(each["matrix"]).reshape(4, 4).T for each in sent if each["type"] == "set_transform"]


@pytest.fixture
def stage():
    return Stage()


def test_without_measurements_there_is_no_arrow(stage):
    stage.view.update("Tank", stage.body.data)
    stage.view.flush()
    assert stage.arrows(RED) + stage.arrows(BLUE) == []
    assert stage.view.readings("Tank") == []


def test_at_rest_gravity_is_subtracted(stage):
    stage.measure()
    assert not stage.arrows(RED)
    said = ("Tank", "acceleration", "0.00", "0.00", "9.81", "m/s²", "red arrow: without gravity")
    assert stage.view.readings("Tank") == [said]


def test_arrows_start_above_the_sensor_and_turn_with_the_body(stage):
    stage.measure((4.0, 0.0, 9.80665), (0.0, 0.0, -2.0))
    red, blue = stage.arrows(RED)[-1], stage.arrows(BLUE)[-1]
    assert red[:3, 3] == pytest.approx([1.0, 2.0, 0.1 + 0.35])
    assert blue[:3, 3] == pytest.approx([1.0, 2.0, 0.1 + 0.45])
    assert red[:3, 2] == pytest.approx([0.0, 0.2, 0.0], abs=1e-9)  # forward is y, with 0.05 m per m/s^2
    assert blue[:3, 2] == pytest.approx([0.0, 0.0, -0.2], abs=1e-9)
    said = ("Tank", "angular velocity", "0.00", "0.00", "-2.00", "rad/s", "blue arrow")
    assert stage.view.readings("Tank")[1] == said


def test_an_arrow_changes_smoothly_and_follows_the_body(stage):
    stage.measure((10.0, 0.0, 9.80665))
    stage.measure(frames=1)
    stage.measure(frames=FRAMES)
    lengths = [np.linalg.norm(matrix[:3, 2]) for matrix in stage.arrows(RED)]
    top = lengths.index(max(lengths))
    assert max(lengths) == pytest.approx(0.5)
    assert lengths == sorted(lengths[: top + 1]) + sorted(lengths[top + 1 :], reverse=True)
    assert np.abs(np.diff(lengths)).max() < 0.2
    assert lengths[-1] < 0.01  # too short to be drawn
    sent = len(stage.messages)
    stage.view.flush()
    assert len(stage.messages) == sent  # and nothing is sent for it
    stage.body.position = (0.0, 0.0, 0.5)
    stage.body.calc_forward_kinematics()
    stage.measure()
    assert len(stage.arrows(RED)) == len(lengths)


@pytest.mark.parametrize("value", [1e300, -1e300, math.inf, math.nan])
def test_no_message_makes_an_endless_arrow(stage, value):
    stage.measure((value, 0.0, 0.0), (0.0, value, 0.0))
    for matrix in stage.arrows(RED) + stage.arrows(BLUE):
        assert np.isfinite(matrix).all()
        assert np.linalg.norm(matrix[:3, 2]) <= 1.0 + 1e-9
    assert all(len(cell) < 30 for row in stage.view.readings("Tank") for cell in row)


def test_an_arrow_is_a_metre_long_along_z_and_coloured():
    arrow = draw_arrow("x", 0xD0342C)
    [outline], [material] = arrow["geometries"], arrow["materials"]
    points = np.array([(point["x"], point["y"]) for point in outline["points"]])  # across and along the axis
    assert points.min(axis=0).tolist() == [0.0, 0.0]
    assert points[points[:, 1].argmax()].tolist() == [0.0, 1.0], "the tip"
    assert points[:, 0].max() < 0.05
    stood = np.reshape(arrow["object"]["matrix"], (4, 4)).T @ (0.0, 1.0, 0.0, 1.0)
    assert stood == pytest.approx([0.0, 0.0, 1.0, 1.0]), "three.js turns it about y"
    assert material["color"] == 0xD0342C


def test_a_replay_has_the_arrows_length(stage):
    stage.measure((10.0, 0.0, 9.80665))
    animation = Animation()
    animation.add(0.0, b"".join(stage.messages))
    stage.messages.clear()
    stage.measure(frames=3)
    animation.add(1.0, b"".join(stage.messages))
    clips = {each["path"]: each["clip"] for each in commands(animation.finish())[-1]["animations"]}
    scales = next(track["values"] for track in clips[RED]["tracks"] if track["name"] == ".scale")
    lengths = scales.reshape(-1, 3)[:, 2]
    assert lengths[0] == pytest.approx(0.05 * 3.0, rel=1e-3)
    assert lengths.max() == pytest.approx(0.5, rel=1e-3)
