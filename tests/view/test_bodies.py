"""The view draws MuJoCo's shapes where MuJoCo has them."""

import mujoco
import numpy as np
import pytest
from scenes import commands

from tutorial.errors import TutorialError
from tutorial.view.bodies import View
from tutorial.view.paint import STALE
from tutorial.view.scene import Record, Scene, unpack_records

POSE = 'pos="1 2 3" quat="0.5 0.5 -0.5 0.5"'
TURN = np.array([[0, -1, 0], [0, 0, -1], [1, 0, 0]])
"""Its rotation matrix."""

FALLING = """
<mujoco>
  <worldbody>
    <geom name="floor" type="plane" size="0 0 1"/>
    <body name="Tank/still" pos="0 1 1"><geom type="sphere" size="0.1"/></body>
    <body name="Tank/ball" pos="0 0 1"><freejoint/><geom name="Tank/skin" type="sphere" size="0.1"/></body>
    <body name="hidden" pos="0 0 3"><freejoint/><geom type="sphere" size="0.1" group="3"/></body>
  </worldbody>
</mujoco>
"""


class Eye:
    """The state that a scene shows: objects, transforms and properties by path, and the number of messages.

    Attributes:
        axes: by path, the objects that show frames; the others are in `objects`.
        moved: the paths of the transforms of the last message.
    """

    def __init__(self, scene):
        self.messages, self.objects, self.axes, self.transforms, self.properties = 0, {}, {}, {}, {}
        self.read(scene.snapshot())
        scene.attach(self.read)

    def read(self, message):
        self.messages += 1
        every = commands(message)
        drawn = {each["path"]: each["object"] for each in every if "object" in each}
        self.axes |= {path: each for path, each in drawn.items() if "/frames/" in path}
        self.objects |= {
            path: each for path, each in drawn.items() if path.startswith("/Bodies/") and path not in self.axes
        }
        self.properties |= {(each["path"], each["property"]): each["value"] for each in every if "property" in each}
        poses = {each["path"]: np.reshape(each["matrix"], (4, 4)).T for each in every if "matrix" in each}
        self.moved = list(poses)
        self.transforms |= poses


def drawn(**models):
    """Return a view with these models, and an `Eye` on it."""
    view = View(scene := Scene())
    for name, model in models.items():
        view.add(name, model)
    return view, Eye(scene)


def model_of(geom, assets=""):
    xml = f"<mujoco><asset>{assets}</asset><worldbody><body name='b'>{geom}</body></worldbody></mujoco>"
    return mujoco.MjModel.from_xml_string(xml)


SPHERE = model_of('<geom name="g" type="sphere" size="1"/>')


def drawing_of(geom, assets=""):
    """Return how one geom is drawn: (geometry, material, 4 x 4 pose in the body)."""
    _, eye = drawn(x=model_of(geom, assets))
    [drawing] = eye.objects.values()
    [geometry], [material] = drawing["geometries"], drawing["materials"]
    assert drawing["object"]["geometry"] == geometry["uuid"]
    assert drawing["object"]["material"] == material["uuid"]
    return geometry, material, np.reshape(drawing["object"]["matrix"], (4, 4)).T


def corners(geometry):
    """Return some points on the geometry's surface as three.js builds it, (n, 3)."""
    kind, turns = geometry["type"], ((1, 0), (0, 1), (-1, 0), (0, -1))
    if kind == "PlaneGeometry":
        return np.array([[x * geometry["width"], y * geometry["height"], 0] for x in (-0.5, 0.5) for y in (-0.5, 0.5)])
    if kind == "BoxGeometry":
        sides = [geometry[name] / 2 for name in ("width", "height", "depth")]
        return np.array(np.meshgrid(*[(-side, side) for side in sides])).reshape(3, -1).T
    if kind == "SphereGeometry":
        return np.vstack([np.eye(3), -np.eye(3)]) * geometry["radius"]
    if kind == "CylinderGeometry":
        radius, half = geometry["radiusTop"], geometry["height"] / 2
        assert radius == geometry["radiusBottom"]
        return np.array([[x * radius, y * half, z * radius] for x, z in turns for y in (-1, 1)])
    if kind == "LatheGeometry":
        return np.array([[p["x"] * x, p["y"], p["x"] * z] for p in geometry["points"] for x, z in turns])
    points = geometry["data"]["attributes"]["position"]
    assert points["itemSize"] == 3
    return points["array"].reshape(-1, 3)


@pytest.mark.parametrize(
    ("geom", "half"),
    [
        ('type="plane" size="0.3 0.4 1"', (0.3, 0.4, 0)),
        ('type="plane" size="0 0.4 1"', (10, 0.4, 0)),
        ('type="box" size="0.1 0.2 0.3"', (0.1, 0.2, 0.3)),
        ('type="sphere" size="0.2"', (0.2, 0.2, 0.2)),
        ('type="ellipsoid" size="0.1 0.2 0.3"', (0.1, 0.2, 0.3)),
        ('type="cylinder" size="0.1 0.3"', (0.1, 0.1, 0.3)),
        ('type="capsule" size="0.1 0.3"', (0.1, 0.1, 0.4)),
    ],
)
def test_each_shape_has_its_size_and_pose(geom, half):
    geometry, _, pose = drawing_of(f"<geom {geom} {POSE}/>")
    in_body = corners(geometry) @ pose[:3, :3].T + pose[:3, 3]
    in_geom = (in_body - [1, 2, 3]) @ TURN
    np.testing.assert_allclose(in_geom.max(axis=0), half, atol=1e-3)
    np.testing.assert_allclose(in_geom.min(axis=0), np.negative(half), atol=1e-3)


def test_a_mesh_is_at_its_vertices():
    vertices = "0 0 0  0.6 0 0  0 0.8 0  0 0 1"
    geometry, _, pose = drawing_of(f'<geom type="mesh" mesh="m" {POSE}/>', f'<mesh name="m" vertex="{vertices}"/>')
    in_body = corners(geometry) @ pose[:3, :3].T + pose[:3, 3]
    given = np.array(vertices.split(), float).reshape(-1, 3) @ TURN.T + [1, 2, 3]
    assert len(in_body) == 3 * 4  # four faces
    assert np.abs(in_body[:, None] - given).max(axis=2).min(axis=1).max() < 1e-5
    normals = geometry["data"]["attributes"]["normal"]["array"].reshape(-1, 3)
    np.testing.assert_allclose(np.linalg.norm(normals, axis=1), 1, atol=1e-5)


RED = '<material name="m" rgba="1 0 0 1" shininess="1" specular="0.5" emission="0.2"/>'


@pytest.mark.parametrize(
    ("look", "assets", "expected"),
    [
        ('rgba="1 0.5 0 1"', "", {"color": 0xFF8000, "opacity": 1, "transparent": False}),
        ('rgba="0 0 1 0.25"', "", {"color": 0x0000FF, "opacity": 0.25, "transparent": True}),
        ("", "", {"color": 0x808080}),
        ('material="m"', RED, {"color": 0xFF0000, "shininess": 128, "specular": 0x404040, "emissive": 0x330000}),
        ('material="m" rgba="0 0 1 1"', RED, {"color": 0x0000FF, "shininess": 128}),
    ],
)
def test_the_colour_is_mujocos(look, assets, expected):
    _, material, _ = drawing_of(f'<geom type="sphere" size="1" {look}/>', assets)
    assert {key: material[key] for key in expected} == expected


@pytest.mark.parametrize("look", ['group="3"', 'rgba="1 0 0 0"'])
def test_hidden_geoms_are_not_drawn(look):
    _, eye = drawn(x=model_of(f'<geom type="sphere" size="1" {look}/>'))
    assert eye.objects == {}


BALL, FLOOR, STILL = (f"/Bodies/world/{part}" for part in ("Tank.ball", "world", "Tank.still"))


@pytest.fixture
def falling():
    """The falling body: (model, data, view, eye)."""
    model = mujoco.MjModel.from_xml_string(FALLING)
    return model, mujoco.MjData(model), *drawn(world=model)


def test_an_added_body_is_at_its_models_pose_under_a_readable_path(falling):
    *_, eye = falling
    assert sorted(eye.objects) == [f"{BALL}/Tank.skin", f"{STILL}/1", f"{FLOOR}/floor"]
    np.testing.assert_allclose(eye.transforms[BALL][:3, 3], [0, 0, 1])


def test_only_a_moving_body_is_sent_at_mujocos_pose(falling):
    model, data, view, eye = falling
    data.qvel[:6] = [1, 0, 0, 1, 2, 3]
    for _ in range(5):
        mujoco.mj_step(model, data, nstep=10)
        mujoco.mj_kinematics(model, data)
        for _ in range(2):  # the second time it does not move
            view.update("world", data)
            view.flush()
        pose = eye.transforms[BALL]
        np.testing.assert_allclose(pose[:3, :3], data.body("Tank/ball").xmat.reshape(3, 3), atol=1e-6)
        np.testing.assert_allclose(pose[:3, 3], data.body("Tank/ball").xpos, atol=1e-6)
        assert pose[3].tolist() == [0, 0, 0, 1]
        assert eye.moved == [BALL]
    assert eye.messages == 1 + 5
    late = Eye(view.scene)
    assert late.objects == eye.objects
    for path, transform in eye.transforms.items():
        np.testing.assert_array_equal(late.transforms[path], transform)


@pytest.mark.parametrize("far", [np.nan, np.inf, 1e300, -1e39])
def test_a_body_at_an_invalid_place_stays_and_the_rest_move(falling, far):
    model, data, view, eye = falling
    mujoco.mj_kinematics(model, data)
    for ball, still, moved in (([far, 0, 2], [0, 1, 2], STILL), ([0, 0, 3], [0, 1, 2], BALL)):
        data.xpos[model.body("Tank/ball").id], data.xpos[model.body("Tank/still").id] = ball, still
        view.update("world", data)
        view.flush()
        assert eye.moved == [moved]


def test_a_removed_body_disappears_and_can_be_added_again(falling):
    *_, view, _ = falling
    view.remove("world")
    assert Eye(view.scene).objects == {}
    view.add("world", SPHERE)
    assert list(Eye(view.scene).objects) == ["/Bodies/world/b/g"]


def test_the_grid_is_shown_until_there_is_a_floor():
    view, _ = drawn(ball=SPHERE)
    for change, arguments, visible in (
        (view.add, ("other", SPHERE), True),
        (view.add, ("room", mujoco.MjModel.from_xml_string(FALLING)), False),
        (view.remove, ("room",), True),
    ):
        change(*arguments)
        assert Eye(view.scene).properties["/Grid", "visible"] is visible


TURRET = """
<mujoco>
  <worldbody>
    <body name="Tank/chassis"><freejoint/><geom name="Tank/hull" type="box" size="1 1 1" rgba="0 1 0 1"/>
      <body name="Tank/turret"><joint name="Tank/YAW"/><geom name="Tank/tower" type="sphere" size="1" rgba="0 1 0 1"/>
        <body name="Tank/hatch"><geom name="Tank/lid" type="sphere" size="1" rgba="1 0 0 0.5"/></body>
        <body name="Tank/barrel">
          <joint name="Tank/PITCH"/><joint name="Tank/RECOIL" type="slide"/>
          <geom name="Tank/gun" type="sphere" size="1" rgba="0 0 1 1"/>
        </body>
      </body>
    </body>
  </worldbody>
</mujoco>
"""


def test_the_parts_moved_by_stale_joints_are_grey():
    view, eye = drawn(Tank=mujoco.MjModel.from_xml_string(TURRET))

    def colours(*stale):
        eye.properties.clear()
        view.show_stale("Tank", stale)
        view.flush()
        return {path.split("/")[-2]: value for (path, key), value in eye.properties.items() if key == "color"}

    grey = STALE
    assert colours() == {}
    assert colours("YAW", "nonsense") == {"Tank.tower": [*grey, 1.0], "Tank.lid": [*grey, 0.5]}
    assert colours("YAW") == {}
    assert colours("PITCH") == {"Tank.tower": [0, 1, 0, 1], "Tank.lid": [1, 0, 0, 0.5], "Tank.gun": [*grey, 1.0]}
    assert colours("PITCH", "RECOIL") == {}
    assert colours("RECOIL") == {}
    assert Eye(view.scene).properties["/Bodies/Tank/Tank.barrel/Tank.gun/<object>", "color"] == [*grey, 1.0]
    assert colours() == {"Tank.gun": [0, 0, 1, 1]}


@pytest.mark.parametrize("size", [0.1, 2.0])
def test_a_close_ups_distance_fits_the_bodys_size(size):
    xml = f'<mujoco><worldbody><body pos="1 2 3"><geom type="sphere" size="{size}"/></body></worldbody></mujoco>'
    model = mujoco.MjModel.from_xml_string(xml)
    view, eye = drawn(Ball=model)
    view.look_at_bodies("Ball")
    view.flush()
    camera = [payload for kind, payload in unpack_records(view.scene.snapshot()) if kind is Record.CAMERA]
    numbers = np.frombuffer(camera[-1], dtype="<f8")
    assert numbers[3:] == pytest.approx([1, 2, 3])
    assert np.linalg.norm(numbers[:3] - numbers[3:]) == pytest.approx(np.sqrt(2) * model.stat.extent)
    assert eye.properties["/Grid", "scale"] == pytest.approx([model.stat.extent / 10] * 3)


ROBOT = """
<mujoco>
  <worldbody>
    <body name="Rover/BASE" pos="0 0 0.5">
      <freejoint/><inertial pos="0 0 0" mass="1" diaginertia="1 1 1"/>
      <body name="Rover/MAST"><joint name="Rover/MAST"/><geom size="0.1"/>
        <camera name="Rover/EYE" pos="0.1 0 0" xyaxes="0 -1 0 0 0 1"/>
      </body>
      <body name="Rover/WHEEL"><joint name="Rover/WHEEL" group="3"/><geom size="0.1"/></body>
    </body>
  </worldbody>
</mujoco>
"""


def shown_frames(eye):
    paths = {path.removesuffix("/axes") for path in eye.axes}
    return {path.rpartition("/")[2] for path in paths if eye.properties[path, "visible"]}


def test_frames_have_the_axes_of_tf_and_are_shown_by_name():
    view, eye = drawn(room=SPHERE, Rover=mujoco.MjModel.from_xml_string(ROBOT))
    assert view.frame_names == ("odom", "Rover/base_link", "Rover/MAST_link", "Rover/EYE_optical")
    assert shown_frames(eye) == set()
    view.show_frames("odom", "Rover/MAST_link")
    view.flush()
    assert shown_frames(eye) == {"odom", "Rover.MAST_link"}
    assert "/Bodies/Rover/Rover.BASE" in eye.transforms  # though the body has no geoms
    optical = eye.axes["/Bodies/Rover/Rover.MAST/frames/Rover.EYE_optical/axes"]["object"]["matrix"]
    turned = np.reshape(optical, (4, 4)).T
    assert turned @ (0, 0, 1, 0) == pytest.approx([1, 0, 0, 0])  # z ahead
    assert turned @ (0, 1, 0, 0) == pytest.approx([0, 0, -1, 0])  # y down
    with pytest.raises(TutorialError, match=r"no frame 'base_link'\. .*The frames are odom, Rover/base_link"):
        view.show_frames("base_link")
    view.remove("Rover")
    assert view.frame_names == ("odom",)
