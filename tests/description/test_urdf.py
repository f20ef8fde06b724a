"""The robot description: another reading of it puts every link where MuJoCo has it."""

from __future__ import annotations

from pathlib import Path
from xml.etree import ElementTree

import mujoco
import numpy as np
import pytest
import yaml
from forward_kinematics import Robot, is_at, matrix_of, rotation_of

from tutorial.body import Body
from tutorial.description.urdf import robot_description
from tutorial.paths import HOME
from tutorial.world import Placement

MODELS = HOME / "project" / "models"
TETRAHEDRON = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n"
"""A mesh whose centre is not where its file has its origin."""

CURIOUS = """
<mujoco>
  <worldbody>
    <geom type="plane" size="1 1 1"/>
    <body pos="1 2 3" euler="10 20 30">
      <joint name="RAIL" type="slide" axis="1 1 0" ref="0.3"/>
      <joint name="YAW" axis="0 0 1" pos="0.1 0.2 0.3" ref="25" range="-90 90"/>
      <joint name="TILT" axis="0 1 1" pos="0 0 0.2"/>
      <geom type="capsule" size="0.02 0.1" euler="0 90 0" rgba="1 0 0 0.5"/>
      <geom type="ellipsoid" size="0.1 0.2 0.3" group="1"/>
      <body name="base_link" pos="0 0 0.5" euler="90 0 0">
        <joint name="SPIN" axis="1 0 0"/>
        <geom type="sphere" size="0.05" mass="2"/>
        <body name="body_1" pos="0.1 0 0" euler="0 90 0">
          <joint type="ball"/>
          <geom type="box" size="0.1 0.2 0.3" pos="0.1 0 0" euler="0 -90 0" contype="0" conaffinity="0"/>
          <body name="HAND" pos="0 0.2 0"><joint axis="0 0 1"/><geom type="cylinder" size="0.05 0.1" group="3"/></body>
        </body>
      </body>
    </body>
    <body name="LOST" pos="3 0 0"><freejoint/><geom size="0.1"/><body name="WITH_IT"><geom size="0.1"/></body></body>
    <body name="POST" pos="4 0 0"><geom size="0.1"/></body>
  </worldbody>
</mujoco>
"""
"""All at once: an axis beside its body's frame, several joints in a body, a 0 elsewhere, no names or a link's."""

LIMITED = """
<mujoco>
  <worldbody>
    <body name="ARM">
      <freejoint/>
      <geom size="0.1"/>
      <body name="A"><joint name="A" range="-1 2" damping="3" frictionloss="0.5"/><geom size="0.1"/></body>
      <body name="B"><joint name="B" axis="0 1 0"/><geom size="0.1"/></body>
      <body name="C"><joint name="C" range="0 1" actuatorfrcrange="-5 7"/><geom size="0.1"/></body>
      <body name="D"><joint name="D" type="slide"/><geom size="0.1"/></body>
    </body>
  </worldbody>
  <compiler angle="radian"/>
  <actuator>
    <motor joint="A" gear="10" ctrlrange="-2 3"/>
    <velocity joint="B" kv="4" gear="2" ctrlrange="-3 3" forcerange="-20 20"/>
    <motor joint="B" gear="-5" forcerange="-1 1"/>
    <motor joint="C"/>
  </actuator>
</mujoco>
"""


def body_of(model, name="Robot"):
    return Body.displayed(Placement(name, Path(model), position=(1.0, -2.0, 0.5)))


@pytest.fixture
def described(tmp_path):
    """Make a body of a model's text, and read its description."""

    def describe(text, name="Robot"):
        path = tmp_path / "model.xml"
        path.write_text(text, encoding="utf-8")
        body = body_of(path, name)
        return body, Robot(robot_description(body))

    return describe


def move(body, generator):
    """Put every joint somewhere within its range, at most four turns [rad] or metres from 0."""
    positions = {}
    for name, (lower, upper) in body.joint_ranges.items():
        positions[name] = float(generator.uniform(max(lower, -25.0), min(upper, 25.0)))
    body.set_joint_positions(positions)
    body.calc_forward_kinematics()
    return positions


def assert_same_places(body, robot, positions, names):
    """Each link is where MuJoCo has the body, as seen from the root: to a micrometre and a microradian."""
    found, root = robot.link_poses(positions), 1
    base = matrix_of(rotation_of(*body.model.body_quat[root]), body.model.body_pos[root])
    if body.model.body(root).jntnum and body.model.jnt_type[body.model.body_jntadr[root]] == mujoco.mjtJoint.mjJNT_FREE:
        base = matrix_of(body.data.xmat[root].reshape(3, 3), body.data.xpos[root])
    for number, name in names.items():
        assert is_at(base @ found[name], body.data, number), name


def plain_names(body):
    return {i: body.model.body(i).name.removeprefix(f"{body.name}/") for i in range(1, body.model.nbody)}


@pytest.mark.parametrize(("model", "links"), [("tank", 17), ("crane", 5)])
def test_links_joints_masses_and_inertias_are_mujocos(model, links):
    body, generator = body_of(MODELS / f"{model}.xml"), np.random.default_rng(17)
    robot = Robot(robot_description(body))
    assert len(robot.links) == links
    assert [name for name, joint in robot.joints.items() if joint.get("type") != "fixed"] == list(body.joint_names)
    for name, ends in body.joint_ranges.items():
        limit = robot.joints[name].find("limit")
        assert (float(limit.get("lower")), float(limit.get("upper"))) == pytest.approx(ends)
    assert robot.links["base_link"].find("inertial") is None  # KDL knows no root that has one
    for number, name in plain_names(body).items():
        inertial = robot.links[name].find("inertial")
        assert float(inertial.find("mass").get("value")) == pytest.approx(body.model.body_mass[number], rel=1e-9)
        np.testing.assert_allclose(robot.center_of_mass(name), body.model.body_ipos[number], atol=1e-9)
        axes = rotation_of(*body.model.body_iquat[number])
        expected = axes @ np.diag(body.model.body_inertia[number]) @ axes.T
        np.testing.assert_allclose(robot.inertia(name), expected, rtol=1e-9, atol=1e-11)
    body.qpos[3:7] = body.qpos[3:7] if model == "crane" else (0.5, 0.5, -0.5, 0.5)  # the tank lies on its side
    for _ in range(100):
        assert_same_places(body, robot, move(body, generator), plain_names(body))


def test_every_link_of_a_curious_model_is_where_mujoco_has_it(described):
    body, robot = described(CURIOUS)
    names = {1: "body_1_", 2: "base_link_", 3: "body_1", 4: "HAND", 7: "POST"}
    generator = np.random.default_rng(17)
    for _ in range(100):
        assert_same_places(body, robot, move(body, generator), names)
    assert {"LOST", "WITH_IT"}.isdisjoint(robot.links)


FIXED = (
    "ball joints that are fixed (1), joints without a name that are fixed (1), "
    "bodies that move freely beside others (1)"
)


def test_what_is_not_as_in_the_model_is_said_at_the_top_and_what_moves_otherwise_in_the_log(described, caplog):
    top = " Other than in the MuJoCo model are "
    assert Robot(robot_description(body_of(MODELS / "tank.xml"))).comment == (
        f"{top}tendons (2), equalities (8), joints of hidden groups that are fixed (10), ellipsoid shapes (10) "
    )
    assert Robot(robot_description(body_of(MODELS / "crane.xml"))).comment is None
    assert caplog.records == []
    _, robot = described(CURIOUS)
    assert robot.comment == f"{top}shapes in no body (1), ellipsoid shapes (1), {FIXED} "
    said = [record.getMessage() for record in caplog.records]
    assert said == [f"the robot description of Robot does not move as the robot does: {FIXED}"]


def test_a_limit_says_what_the_actuators_can_do(described):
    _, robot = described(LIMITED)
    limits = {name: dict(robot.joints[name].find("limit").attrib) for name in "ABCD"}
    many = "1000000000"
    assert limits == {
        "A": {"lower": "-1", "upper": "2", "effort": "30", "velocity": many},
        "B": {"effort": "45", "velocity": many},
        "C": {"lower": "0", "upper": "1", "effort": "7", "velocity": many},
        "D": {"lower": f"-{many}", "upper": many, "effort": many, "velocity": many},
    }
    assert [robot.joints[name].get("type") for name in "ABCD"] == ["revolute", "continuous", "revolute", "prismatic"]
    assert robot.joints["A"].find("dynamics").attrib == {"damping": "3", "friction": "0.5"}
    assert robot.joints["B"].find("dynamics") is None


def shapes(link, tag):
    """Name the shapes of a link, with their attributes."""
    return [(each[0].tag, each[0].attrib) for each in link.findall(f"{tag}/geometry")]


def test_what_is_seen_and_what_touches(described):
    _, robot = described(CURIOUS)
    capsule = [("cylinder", {"radius": "0.02", "length": "0.2"}), *[("sphere", {"radius": "0.02"})] * 2]
    assert shapes(robot.links["body_1_"], "visual") == shapes(robot.links["body_1_"], "collision") == capsule
    places = np.array([robot.origin(each)[:3, 3] for each in robot.links["body_1_"].findall("visual")])
    np.testing.assert_allclose(places, [(0, 0, 0), (0.1, 0, 0), (-0.1, 0, 0)], atol=1e-9)
    assert shapes(robot.links["body_1"], "visual") == [("box", {"size": "0.2 0.4 0.6"})]
    assert shapes(robot.links["body_1"], "collision") == []
    assert shapes(robot.links["HAND"], "visual") == []
    assert shapes(robot.links["HAND"], "collision") == [("cylinder", {"radius": "0.05", "length": "0.2"})]


def test_colours_are_those_of_the_material_or_the_geoms_own(described):
    robot = Robot(robot_description(body_of(MODELS / "tank.xml")))
    hull = robot.links["CHASSIS"].find("visual[@name='HULL']/material")
    assert (hull.get("name"), hull.find("color").get("rgba")) == ("HULL", "0.42 0.52 0.36 1")
    _, curious = described(CURIOUS)
    red = curious.links["body_1_"].find("visual/material")
    assert (red.get("name"), red.find("color").get("rgba")) == ("rgba_ff000080", "1 0 0 0.5")


def test_a_mesh_is_the_models_file_where_mujoco_has_it(described, tmp_path):
    (tmp_path / "a mesh.obj").write_text(TETRAHEDRON, encoding="utf-8")
    body, robot = described("""
        <mujoco>
          <asset>
            <mesh name="M" file="a mesh.obj" scale="2 -1 1"/><mesh name="I" vertex="0 0 0 1 0 0 0 1 0 0 0 1"/>
          </asset>
          <worldbody><body name="M">
            <geom type="mesh" mesh="M" pos="1 2 3" euler="10 20 30"/><geom type="mesh" mesh="I"/>
          </body></worldbody>
        </mujoco>""")
    assert robot.comment == " Other than in the MuJoCo model are mesh shapes (1) "
    (visual,) = robot.links["M"].findall("visual")
    mesh = visual.find("geometry/mesh")
    assert mesh.attrib == {"filename": (tmp_path / "a mesh.obj").as_uri(), "scale": "2 -1 1"}
    corners = np.array([(0, 0, 0, 1), (2, 0, 0, 1), (0, -1, 0, 1), (0, 0, 1, 1)], dtype=float)
    model = body.model
    expected = model.mesh_vert[:4] @ rotation_of(*model.geom_quat[0]).T + model.geom_pos[0]
    np.testing.assert_allclose((robot.origin(visual) @ corners.T).T[:, :3], expected, atol=1e-6)


def test_names_may_have_any_characters(described):
    body, robot = described(
        '<mujoco><worldbody><body name="Zürich &lt;&quot;&amp;&#x202e;"><geom size="0.1"/></body></worldbody></mujoco>'
    )
    assert list(robot.links) == ["base_link", 'Zürich <"&\u202e']
    assert robot_description(body).isascii()  # so that it is the same in any file, and a terminal obeys nothing of it


def test_a_root_that_is_called_base_link_is_the_root(described):
    _, robot = described(
        '<mujoco><worldbody><body name="base_link"><freejoint/><geom size="0.1"/></body></worldbody></mujoco>'
    )
    assert (list(robot.links), robot.joints) == (["base_link"], {})
    assert len(robot.links["base_link"].findall("visual")) == 1


def test_it_is_one_document_and_ros_2_can_take_it_as_a_parameter():
    text = robot_description(body_of(MODELS / "tank.xml", "Tank"))
    assert isinstance(yaml.safe_load(text), str)  # as which rcl reads it
    assert text.startswith('<?xml version="1.0"?>\n<robot name="Tank">\n')
    assert ElementTree.fromstring(text).get("name") == "Tank"
