"""The robot description: MuJoCo, which also reads URDF, builds the original model from it."""

import re
from pathlib import Path
from xml.etree import ElementTree

import mujoco
import numpy as np
import pytest
import yaml

from tutorial.body import Body
from tutorial.description.poses import pose
from tutorial.description.urdf import robot_description
from tutorial.system.paths import HOME
from tutorial.world import Placement

MODELS = HOME / "project" / "models"
TETRAHEDRON = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n"
"""A mesh whose centre is not its file's origin."""

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
          <geom type="box" size="0.1 0.2 0.3" pos="0.1 0 0" euler="10 20 30" contype="0" conaffinity="0"/>
          <body name="HAND" pos="0 0.2 0"><joint axis="0 0 1"/><geom type="cylinder" size="0.05 0.1" group="3"/></body>
        </body>
      </body>
    </body>
    <body name="LOST" pos="3 0 0"><freejoint/><geom size="0.1"/><body name="WITH_IT"><geom size="0.1"/></body></body>
    <body name="POST" pos="4 0 0"><geom size="0.1"/></body>
  </worldbody>
</mujoco>
"""
"""Special cases: an axis beside its body's frame, several joints in a body, a 0, missing and duplicate names."""

LIMITED = """
<mujoco>
  <worldbody>
    <body name="ARM">
      <freejoint/>
      <geom size="0.1"/>
      <body name="A"><joint name="A" range="-1 2" damping="3" frictionloss="0.5" user="4.5"/><geom size="0.1"/></body>
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


COMPILER = """
<mujoco><compiler
  angle="radian" fusestatic="false" discardvisual="false" strippath="false" boundmass="1e-9" boundinertia="1e-12"
/></mujoco>
</robot>"""
"""Makes MuJoCo keep every shape, and every link, even one without a mass."""


class Robot:
    """A URDF document.

    Attributes:
        text: the document.
        links: the elements by name.
        joints: the same for joints.
        comment: the first comment, or None.
    """

    def __init__(self, text):
        builder = ElementTree.TreeBuilder(insert_comments=True)
        robot = ElementTree.fromstring(text, ElementTree.XMLParser(target=builder))
        self.text = text
        self.links = {link.get("name"): link for link in robot.findall("link")}
        self.joints = {joint.get("name"): joint for joint in robot.findall("joint")}
        self.comment = next((each.text for each in robot if each.tag is ElementTree.Comment), None)
        assert len(self.links) == len(robot.findall("link"))
        assert len(self.joints) == len(robot.findall("joint"))

    def read(self):
        """Return MuJoCo's model of the document, without the shapes' names, which need not be unique in URDF."""
        text = re.sub(r'<(visual|collision) name="[^"]*"', r"<\1", self.text)
        return mujoco.MjModel.from_xml_string(text.replace("</robot>", COMPILER))


def body_of(model, name="Robot"):
    return Body.displayed(Placement(name, Path(model), position=(1.0, -2.0, 0.5)))


@pytest.fixture
def described(tmp_path):
    """Make a body from a model's text, and read its description."""

    def describe(text, name="Robot"):
        path = tmp_path / "model.xml"
        path.write_text(text, encoding="utf-8")
        body = body_of(path, name)
        return body, Robot(robot_description(body))

    return describe


def assert_same_robot(body, model, names):
    """Check that each link has its body's mass, inertia and place, to a micrometre, at any joint positions.

    Args:
        body: the body, in its model's initial pose.
        model: the description's model; its world frame is the body's root.
        names: the links' names, by MuJoCo's body numbers.
    """
    own = body.model
    for number, name in names.items():
        found = model.body(name).id
        assert model.body_mass[found] == pytest.approx(own.body_mass[number], rel=1e-9)
        np.testing.assert_allclose(model.body_ipos[found], own.body_ipos[number], atol=1e-9)
        np.testing.assert_allclose(inertia(model, found), inertia(own, number), rtol=1e-9, atol=1e-11)
    generator, data = np.random.default_rng(17), mujoco.MjData(model)
    root = pose(body.data.xpos[1], body.data.xquat[1])
    for _ in range(100):
        for name, (lower, upper) in body.joint_ranges.items():  # at most four turns [rad] or metres from 0
            position = float(generator.uniform(max(lower, -25.0), min(upper, 25.0)))
            data.joint(name).qpos = body.joint(name).position = position
        body.calc_forward_kinematics()
        mujoco.mj_kinematics(model, data)
        for number, name in names.items():
            found = root @ pose(data.body(name).xpos, data.body(name).xquat)
            np.testing.assert_allclose(found, pose(body.data.xpos[number], body.data.xquat[number]), atol=1e-6)


def inertia(model, number):
    """Return the inertia about the centre of mass, along the link's axes, 3 x 3 [kg.m^2]."""
    axes = pose((0, 0, 0), model.body_iquat[number])[:3, :3]
    return axes @ np.diag(model.body_inertia[number]) @ axes.T


@pytest.mark.parametrize(("file", "links"), [("tank", 20), ("crane", 8)])
def test_links_joints_masses_and_inertias_are_mujocos(file, links):
    body = body_of(MODELS / f"{file}.xml")
    robot = Robot(robot_description(body))
    model, own = robot.read(), body.model
    assert len(robot.links) == links
    assert [model.joint(number).name for number in range(model.njnt)] == list(body.joint_names)
    for name, ends in body.joint_ranges.items():
        assert model.joint(name).range == pytest.approx(ends)
    assert robot.links["base_link"].find("inertial") is None  # KDL rejects a root with inertia
    assert set(robot.links).isdisjoint(robot.joints)
    names = {i: own.body(i).name.removeprefix("Robot/") for i in range(1, own.nbody)}
    names = {i: f"{name}_link" if name in body.joint_names else name for i, name in names.items()}
    if file == "tank":
        body.orientation_wxyz = 0.5, 0.5, -0.5, 0.5  # the robot lies on its side
        body.calc_forward_kinematics()
    assert_same_robot(body, model, names)


@pytest.mark.parametrize("file", ["tank", "crane"])
def test_sensors_and_cameras_have_links_and_cameras_look_along_z(file):
    own = body_of(MODELS / f"{file}.xml").model
    model = Robot(robot_description(body_of(MODELS / f"{file}.xml"))).read()
    expected, data = mujoco.MjData(own), mujoco.MjData(model)
    mujoco.mj_forward(own, expected)
    mujoco.mj_forward(model, data)
    root, camera, optical = expected.body(1), expected.camera("Robot/CAMERA"), data.body("CAMERA_optical")
    assert root.xmat.tolist() == np.eye(3).ravel().tolist()
    for sensor in ("ACCEL_SENSOR", "GYRO"):
        np.testing.assert_allclose(root.xpos + data.body(sensor).xpos, expected.site("Robot/IMU").xpos)
    np.testing.assert_allclose(root.xpos + optical.xpos, camera.xpos)
    right, up, back = camera.xmat.reshape(3, 3).T
    np.testing.assert_allclose(optical.xmat.reshape(3, 3).T, (right, -up, -back), atol=1e-9)


def test_every_link_of_an_unusual_model_is_where_mujoco_has_it(described):
    body, robot = described(CURIOUS)
    names = {1: "body_1_", 2: "base_link_", 3: "body_1", 4: "HAND", 7: "POST"}
    assert_same_robot(body, robot.read(), names)
    assert {"LOST", "WITH_IT"}.isdisjoint(robot.links)


FIXED = (
    "ball joints, which become fixed (1); unnamed joints, which become fixed (1); "
    "bodies that move freely relative to the root (1)"
)


def test_differences_from_the_model_are_reported(described, caplog):
    top = " Differences from the MuJoCo model are "
    assert Robot(robot_description(body_of(MODELS / "tank.xml"))).comment == (
        f"{top}tendons (2); equalities (8); joints in hidden groups, which become fixed (10); ellipsoid shapes (10) "
    )
    assert Robot(robot_description(body_of(MODELS / "crane.xml"))).comment is None
    assert caplog.records == []
    _, robot = described(CURIOUS)
    assert robot.comment == f"{top}shapes outside of bodies (1); ellipsoid shapes (1); {FIXED} "
    said = [record.getMessage() for record in caplog.records]
    assert said == [f"the robot description of Robot does not reproduce all movements of the robot: {FIXED}"]


def test_limits_come_from_the_actuators(described):
    _, robot = described(LIMITED)
    limits = {name: dict(robot.joints[name].find("limit").attrib) for name in "ABCD"}
    many = "1000000000"
    assert limits == {
        "A": {"lower": "-1", "upper": "2", "effort": "30", "velocity": "4.5"},
        "B": {"effort": "45", "velocity": many},
        "C": {"lower": "0", "upper": "1", "effort": "7", "velocity": many},
        "D": {"lower": f"-{many}", "upper": many, "effort": many, "velocity": many},
    }
    assert [robot.joints[name].get("type") for name in "ABCD"] == ["revolute", "continuous", "revolute", "prismatic"]
    assert robot.joints["A"].find("dynamics").attrib == {"damping": "3", "friction": "0.5"}
    assert robot.joints["B"].find("dynamics") is None


COUPLED = """
<mujoco>
  <compiler angle="radian"/>
  <worldbody><body name="PALM">
    <geom size="0.1"/>
    <body name="A"><joint name="A" type="slide" ref="0.1" range="0 1"/><geom size="0.1"/></body>
    <body name="B"><joint name="B" type="slide" ref="0.2" group="3"/><geom size="0.1"/></body>
    <body name="C"><joint name="C" axis="0 1 0" ref="-0.3"/><geom size="0.1"/></body>
    <body name="D"><joint name="D" axis="1 0 0"/><geom size="0.1"/></body>
  </body></worldbody>
  <equality>
    <joint joint1="C" joint2="B" polycoef="0.5 3 0 0 0"/>
    <joint joint1="B" joint2="A" polycoef="0.1 -2 0 0 0"/>
    <joint joint1="D" joint2="A" active="false"/>
    EQUALITY
  </equality>
</mujoco>
"""


def test_mimic(described, caplog):
    body, robot = described(COUPLED.replace("EQUALITY", ""))
    mimics = {name: joint.find("mimic") for name, joint in robot.joints.items() if joint.find("mimic") is not None}
    assert {name: mimic.get("joint") for name, mimic in mimics.items()} == {"B": "A", "C": "A"}
    assert robot.comment == " Differences from the MuJoCo model are equalities (1) "
    assert caplog.records == []
    model = robot.read()
    data = mujoco.MjData(model)
    body.set_joint_positions({"A": 0.7})
    body.calc_forward_kinematics()
    data.joint("A").qpos = 0.7
    for name, mimic in mimics.items():
        data.joint(name).qpos = 0.7 * float(mimic.get("multiplier")) + float(mimic.get("offset"))
    mujoco.mj_kinematics(model, data)
    for link in ("A_link", "B_link", "C_link"):
        own, root = body.data.body(f"Robot/{link[0]}"), body.data.body("Robot/PALM")
        np.testing.assert_allclose(data.body(link).xpos, own.xpos - root.xpos, atol=1e-9)
        np.testing.assert_allclose(data.body(link).xmat, own.xmat, atol=1e-9)


@pytest.mark.parametrize("equality", ['<joint joint1="D" joint2="A" polycoef="0 0 1 0 0"/>', '<weld body1="D"/>'])
def test_coupling_without_mimic(described, caplog, equality):
    described(COUPLED.replace("EQUALITY", equality))
    said = (
        "the robot description of Robot does not reproduce all movements of the robot: equalities that move joints (1)"
    )
    assert caplog.messages == [said]


COLLISION, VISUAL = 0, 1  # MuJoCo's groups for the shapes that it reads from URDF


def shapes(model, link, group):
    """Describe a link's shapes by name, with MuJoCo's sizes and positions [m]."""
    mine = np.flatnonzero((model.geom_bodyid == model.body(link).id) & (model.geom_group == group)).tolist()
    return [
        (
            mujoco.mjtGeom(model.geom_type[geom]).name,
            model.geom_size[geom].round(9).tolist(),
            *model.geom_pos[geom].round(9),
        )
        for geom in mine
    ]


def test_visual_and_collision_shapes(described):
    model = described(CURIOUS)[1].read()
    ball = ("mjGEOM_SPHERE", [0.02, 0, 0])
    capsule = [("mjGEOM_CYLINDER", [0.02, 0.1, 0], 0, 0, 0), (*ball, 0.1, 0, 0), (*ball, -0.1, 0, 0)]
    assert shapes(model, "body_1_", VISUAL) == shapes(model, "body_1_", COLLISION) == capsule
    assert shapes(model, "body_1", VISUAL) == [("mjGEOM_BOX", [0.1, 0.2, 0.3], 0.1, 0, 0)]
    assert shapes(model, "body_1", COLLISION) == shapes(model, "HAND", VISUAL) == []
    assert shapes(model, "HAND", COLLISION) == [("mjGEOM_CYLINDER", [0.05, 0.1, 0], 0, 0, 0)]


def test_colours_come_from_the_material_or_the_geom(described):
    robot = Robot(robot_description(body_of(MODELS / "tank.xml")))
    hull = robot.links["CHASSIS"].find("visual[@name='HULL']/material")
    assert (hull.get("name"), hull.find("color").get("rgba")) == ("HULL", "0.42 0.52 0.36 1")
    _, curious = described(CURIOUS)
    red = curious.links["body_1_"].find("visual/material")
    assert (red.get("name"), red.find("color").get("rgba")) == ("rgba_ff000080", "1 0 0 0.5")


def test_a_mesh_is_the_models_file(described, tmp_path):
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
    assert robot.comment == " Differences from the MuJoCo model are mesh shapes (1) "
    (mesh,) = robot.links["M"].findall("visual/geometry/mesh")
    uri = (tmp_path / "a mesh.obj").as_uri()
    assert mesh.attrib == {"filename": uri, "scale": "2 -1 1"}
    robot.text = robot.text.replace(uri, str(tmp_path / "a mesh.obj"))  # MuJoCo reads no file:// addresses
    np.testing.assert_allclose(corners(robot.read()), corners(body.model), atol=1e-6)


def corners(model):
    """Return the corners of the first geom's mesh in its body's frame, sorted."""
    turned = pose((0, 0, 0), model.geom_quat[0])[:3, :3]
    return sorted((model.mesh_vert[:4] @ turned.T + model.geom_pos[0]).round(7).tolist())


def test_names_may_have_any_characters(described):
    body, robot = described(
        '<mujoco><worldbody><body name="Zürich &lt;&quot;&amp;&#x202e;"><geom size="0.1"/></body></worldbody></mujoco>'
    )
    assert list(robot.links) == ["base_link", 'Zürich <"&\u202e']
    assert robot_description(body).isascii()  # the same in any file, and harmless in a terminal


def test_a_root_that_is_called_base_link_is_the_root(described):
    _, robot = described(
        '<mujoco><worldbody><body name="base_link"><freejoint/><geom size="0.1"/></body></worldbody></mujoco>'
    )
    assert (list(robot.links), robot.joints) == (["base_link"], {})
    assert len(robot.links["base_link"].findall("visual")) == 1


def test_ros_2_accepts_it_as_a_parameter():
    text = robot_description(body_of(MODELS / "tank.xml", "Tank"))
    assert isinstance(yaml.safe_load(text), str)  # rcl reads it as YAML
    assert text.startswith('<?xml version="1.0"?>\n<robot name="Tank">\n')
    assert ElementTree.fromstring(text).get("name") == "Tank"
