"""URDF as a model: the displayed shapes, the search for meshes, and errors with advice."""

import os
import re

import mujoco
import numpy as np
import pytest

from tutorial.errors import TutorialError
from tutorial.model.urdf_file import read_urdf
from tutorial.view.shapes import is_drawn
from tutorial.world import Placement, compose

TETRAHEDRON = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n"
FLAT = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\nf 1 2 3\nf 2 4 3\n"
BOX = '<geometry><box size="2 4 6"/></geometry>'
BALL = '<geometry><sphere radius="0.5"/></geometry>'

ARM = f"""<?xml version="1.0"?>
<robot name="arm">
  <material name="blue"><color rgba="0 0 1 1"/></material>
  <link name="base">
    <visual name="shape">{BOX}<material name="blue"/></visual>
    <collision name="shape">{BALL}</collision>
  </link>
  <link name="arm">
    <inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="9" ixy="0" ixz="0" iyz="0"/></inertial>
    <visual><geometry><cylinder radius="0.03" length="0.4"/></geometry></visual>
  </link>
  <link name="tool"/><link name="finger"/>
  <joint name="shoulder" type="revolute"><parent link="base"/><child link="arm"/><axis xyz="0 1 0"/>
    <limit lower="-1" upper="1" effort="1" velocity="1"/></joint>
  <joint name="mount" type="fixed"><parent link="arm"/><child link="tool"/></joint>
  <joint name="grip" type="prismatic"><parent link="tool"/><child link="finger"/>
    <limit lower="-1" upper="1" effort="1" velocity="1"/><mimic joint="shoulder" multiplier="2" offset="0.1"/></joint>
  <gazebo><geometry><mesh><uri>model://elsewhere.dae</uri></mesh></geometry></gazebo>
</robot>"""


@pytest.fixture
def write(tmp_path):
    """Write a robot description into a subfolder of the package `arm_description`."""

    def write(text, name="arm.urdf"):
        path = tmp_path / "arm_description" / "urdf" / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text, encoding="utf-8")
        return path

    return write


def robot_of(mesh, kind="visual", more=""):
    shape = f'<{kind}><geometry><mesh filename="{mesh}"/></geometry></{kind}>'
    return f'<robot name="r">{more}<link name="a">{shape}</link></robot>'


@pytest.mark.parametrize("name", ["arm.urdf", "arm.xml"])
def test_links_and_visuals(write, capfd, name):
    model = compose([Placement("Arm", write(ARM, name))])
    assert [model.body(i).name for i in range(1, model.nbody)] == ["Arm/base", "Arm/arm", "Arm/tool", "Arm/finger"]
    drawn = [geom for geom in range(model.ngeom) if is_drawn(model, geom)]
    kinds = [mujoco.mjtGeom(model.geom_type[geom]).name for geom in drawn]
    assert kinds == ["mjGEOM_BOX", "mjGEOM_CYLINDER"]
    assert model.geom_rgba[drawn[0]].tolist() == [0, 0, 1, 1]
    assert model.ngeom == 3
    np.testing.assert_allclose(model.eq_data[0, :2], [0.1, 2])
    assert capfd.readouterr() == ("", "")


def test_collision_shapes_only(write):
    model = compose(
        [Placement("Arm", write(f'<robot name="r"><link name="a"><collision>{BALL}</collision></link></robot>'))]
    )
    assert is_drawn(model, 0)


@pytest.mark.parametrize(
    ("mesh", "at"),
    [
        ("../meshes/m.obj", "arm_description/meshes/m.obj"),
        ("package://arm_description/meshes/m.obj", "arm_description/meshes/m.obj"),
        ("package://hand/m.obj", "hand/m.obj"),
        ("model://hand/m.obj", "hand/m.obj"),
        ("package://renamed/m.obj", "arm_description/m.obj"),
        ("package://installed/a b.obj", "install/share/installed/a b.obj"),
        ("file://FOLDER/a%20b.obj", "a b.obj"),
        ("FOLDER/m.OBJ", "m.OBJ"),
    ],
)
def test_meshes_are_found(write, tmp_path, monkeypatch, mesh, at):
    monkeypatch.setenv("AMENT_PREFIX_PATH", f"{tmp_path / 'nowhere'}{os.pathsep}{tmp_path / 'install'}")
    path = write(robot_of(mesh.replace("FOLDER", str(tmp_path))))
    (tmp_path / "arm_description" / "package.xml").write_text("<package><name>renamed</name></package>")
    (tmp_path / at).parent.mkdir(parents=True, exist_ok=True)
    (tmp_path / at).write_text(TETRAHEDRON)
    assert compose([Placement("R", path)]).nmesh == 1


@pytest.mark.parametrize("kind", ["visual", "collision"])
def test_meshdir(write, tmp_path, kind):
    settings = '<mujoco><compiler meshdir="../assets" discardvisual="true" fusestatic="true"/></mujoco>'
    path = write(robot_of("package://gone/visual/m.obj", kind, settings))
    (tmp_path / "arm_description" / "assets").mkdir()
    (tmp_path / "arm_description" / "assets" / "m.obj").write_text(TETRAHEDRON)
    model = compose([Placement("R", path)])
    assert (model.nmesh, is_drawn(model, 0)) == (1, True)


def test_flat_visual(write, tmp_path):
    (tmp_path / "flat.obj").write_text(FLAT)
    assert compose([Placement("R", write(robot_of("../../flat.obj")))]).nmesh == 1


@pytest.mark.parametrize(
    ("text", "name", "said"),
    [
        (
            robot_of("package://gone/m.stl"),
            "r.urdf",
            "needs the mesh 'package://gone/m.stl'. No folder 'gone' above or beside",
        ),
        (
            robot_of("m.stl"),
            "r.urdf",
            "needs the mesh 'm.stl'. There is no such file: a path in a URDF is",
        ),
        (robot_of("x" * 300), "r.urdf", "There is no such file"),
        (
            robot_of("r.dae"),
            "r.dae",
            "needs the mesh 'r.dae'. MuJoCo reads .msh, .obj, .stl: convert the",
        ),
        (
            ARM,
            "arm.urdf.xacro",
            "is a xacro file. Convert it to URDF, on a machine with ROS 2: xacro arm.urdf.xacro > arm.urdf",
        ),
        ('<robot xmlns:xacro="http://wiki.ros.org/xacro"><xacro:x/></robot>', "r.urdf", "xacro r.urdf > r_.urdf"),
        ("<robot><xacro:x/></robot>", "r.xml", "is a xacro file."),
        ('<robot name="r"><link name="a"></robot>', "r.urdf", "is not XML: mismatched tag"),
        (robot_of("file:///nowhere/m.stl"), "r.urdf", "needs the mesh 'file:///nowhere/m.stl'. There is no such file."),
        ('<robot name="r"><joint name="j"/></robot>', "r.urdf", "does not load. MuJoCo reports: "),
    ],
)
def test_unreadable(write, text, name, said):
    path = write(text, name)
    with pytest.raises(TutorialError, match=f"^{re.escape(f'the model {str(path)!r} ')}.*{re.escape(said)}"):
        compose([Placement("R", path)])


@pytest.mark.parametrize("text", ["<mujoco/>", "<!-- <xacro:x/> --><mujoco/>", "no XML", ""])
def test_other_files(write, text):
    assert read_urdf(write(text)) is None
    assert read_urdf(write("").parent / "missing.urdf") is None
