"""MuJoCo's geoms as objects for meshcat's viewer, in three.js's JSON format.

This module does not use ``meshcat.geometry``, because it has no capsules, planes or lights, and imports ZMQ, IPython
and Pillow, which takes 0.3 s and causes a deprecation warning.
"""

from typing import Any

import mujoco
import numpy as np
from numpy.typing import NDArray

from tutorial.description.colour import colour_of, is_seen
from tutorial.description.poses import Matrix, pose, shift, turn

Json = dict[str, Any]
Array = NDArray[np.float64]

Geom = mujoco.mjtGeom
NOT_DRAWN = (Geom.mjGEOM_HFIELD, Geom.mjGEOM_SDF)

ENDLESS = 20.0
"""The length and width [m] of a plane that is infinite in MuJoCo (size 0)."""

FRONT, BOTH = 0, 2
"""The three.js constants that select which sides of a surface are drawn."""

_BALL = {"type": "SphereGeometry", "widthSegments": 32, "heightSegments": 16}

LABEL = 0.28
"""The width of a frame's label, as a fraction of the distance to the camera."""

THICKNESS = 0.02
"""The radius of a frame's axes, as a fraction of their length."""

AXES = {
    "x": (turn((0.0, 1.0, 0.0), np.pi / 2), 0xE0241B),
    "y": (turn((1.0, 0.0, 0.0), -np.pi / 2), 0x1FA32C),
    "z": (np.eye(4), 0x2456E6),
}
"""The rotation from z to each axis, and the axis's colour as 0xRRGGBB."""

ON_TOP = {"depthTest": False, "transparent": True}
"""Settings for a material that is drawn on top of everything else."""

_Y_TO_Z = np.array([[1.0, 0.0, 0.0, 0.0], [0.0, 0.0, -1.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 0.0, 1.0]])
"""The axis of a cylinder is y in three.js, but z in MuJoCo."""


def is_drawn(model: mujoco.MjModel, geom: int) -> bool:
    """Return whether a geom is in a visible group, is not fully transparent, and has a supported shape."""
    return is_seen(model, geom) and Geom(model.geom_type[geom]) not in NOT_DRAWN


def draw_geom(model: mujoco.MjModel, geom: int, uuid: str) -> Json:
    """Return a geom as the object of a ``set_object`` command.

    Args:
        model: the geom's model.
        geom: the geom's id.
        uuid: a unique name for the object.

    Returns:
        The object, placed at the geom's pose relative to its MuJoCo body [m].
    """
    geometry, basis = _geometry(model, geom)
    place = pose(model.geom_pos[geom], model.geom_quat[geom]) @ basis
    return _mesh_object(uuid, geometry, _material(model, geom), place)


def draw_arrow(uuid: str, colour: int) -> Json:
    """Return an arrow, 1 m long along z, as the object of a ``set_object`` command.

    Args:
        uuid: a unique name for the object.
        colour: as 0xRRGGBB.
    """
    outline = ((0.0, 0.0), (0.012, 0.0), (0.012, 0.75), (0.035, 0.75), (0.0, 1.0))  # (radius, height) [m]
    material = {"type": "MeshPhongMaterial", "color": colour, "emissive": colour // 2 & 0x7F7F7F, "side": BOTH}
    return _mesh_object(uuid, _lathe(np.array(outline)), material, _Y_TO_Z)


def draw_axes(uuid: str, name: str, length: float, place: Matrix, label: tuple[float, float, float]) -> Json:
    """Return a frame's axes as the object of a ``set_object`` command: x red, y green and z blue, as in rviz2.

    The axes are visible through all other objects. The letters of the frame's name have the same apparent size at any
    distance.

    Args:
        uuid: a unique name for the object.
        name: the frame's name.
        length: the length of the axes [m].
        place: the frame's pose, (4, 4) [m].
        label: the position of the name in the frame, in units of the axes' length.
    """
    bar = {"type": "CylinderGeometry", "radiusTop": THICKNESS * length, "radiusBottom": THICKNESS * length}
    materials, parts = [], []
    for axis, (turned, colour) in AXES.items():
        own, along = f"{uuid} {axis}", turned @ shift((0.0, 0.0, length / 2)) @ _Y_TO_Z
        materials.append({"uuid": own, "type": "MeshBasicMaterial", "color": colour, **ON_TOP})
        mesh = {"uuid": f"{own} bar", "type": "Mesh", "geometry": f"{uuid} bar", "material": own, "renderOrder": 1}
        parts.append({**mesh, "matrix": _column_by_column(along)})
    text = {"uuid": f"{uuid} text", "type": "_text", "text": name, "font_size": 26, "font_face": "sans-serif"}
    paint = {"uuid": f"{uuid} paint", "type": "SpriteMaterial", "map": text["uuid"], "sizeAttenuation": False, **ON_TOP}
    sprite = {"uuid": f"{uuid} label", "type": "Sprite", "material": paint["uuid"], "renderOrder": 2}
    written = shift(length * np.array(label)) @ np.diag([LABEL, LABEL, 1.0, 1.0])
    return {
        "metadata": {"version": 4.5, "type": "Object"},
        "geometries": [{"uuid": f"{uuid} bar", **bar, "height": length, "radialSegments": 12}],
        "textures": [text],
        "materials": [*materials, paint],
        "object": {
            "uuid": uuid,
            "type": "Group",
            "matrix": _column_by_column(place),
            "children": [*parts, {**sprite, "matrix": _column_by_column(written)}],
        },
    }


def light(kind: str, position: tuple[float, float, float] = (0.0, 0.0, 0.0), **settings: Any) -> Json:
    """Return a light, for instance a ``"DirectionalLight"``, as the object of a ``set_object`` command.

    Args:
        kind: the light's class in three.js.
        position: the position [m]; a directional light shines from there towards the origin.
        settings: additional JSON fields of the light, for instance ``intensity``.
    """
    return {
        "metadata": {"version": 4.5, "type": "Object"},
        "object": {"uuid": kind, "type": kind, "matrix": _column_by_column(shift(position)), **settings},
    }


def _mesh_object(uuid: str, geometry: Json, material: Json, place: Matrix) -> Json:
    return {
        "metadata": {"version": 4.5, "type": "Object"},
        "geometries": [{"uuid": f"{uuid} geometry", **geometry}],
        "materials": [{"uuid": f"{uuid} material", **material}],
        "object": {
            "uuid": uuid,
            "type": "Mesh",
            "geometry": f"{uuid} geometry",
            "material": f"{uuid} material",
            "matrix": _column_by_column(place),
        },
    }


def _column_by_column(matrix: Matrix) -> list[float]:
    """Return the elements of a 4 x 4 matrix in three.js's order."""
    return list(matrix.T.ravel().tolist())


def _geometry(model: mujoco.MjModel, geom: int) -> tuple[Json, Matrix]:
    """Return the geometry's JSON, and the 4 x 4 matrix that transforms it into the geom's frame."""
    x, y, z = model.geom_size[geom].tolist()
    basis = np.eye(4)
    geometry: Json
    match Geom(model.geom_type[geom]):
        case Geom.mjGEOM_PLANE:
            geometry = {"type": "PlaneGeometry", "width": 2 * x or ENDLESS, "height": 2 * y or ENDLESS}
        case Geom.mjGEOM_BOX:
            geometry = {"type": "BoxGeometry", "width": 2 * x, "height": 2 * y, "depth": 2 * z}
        case Geom.mjGEOM_SPHERE:
            geometry = {**_BALL, "radius": x}
        case Geom.mjGEOM_ELLIPSOID:
            geometry, basis = {**_BALL, "radius": 1.0}, np.diag([x, y, z, 1.0])
        case Geom.mjGEOM_CYLINDER:
            ends = {"radiusTop": x, "radiusBottom": x}
            geometry, basis = {"type": "CylinderGeometry", **ends, "height": 2 * y, "radialSegments": 32}, _Y_TO_Z
        case Geom.mjGEOM_CAPSULE:
            geometry, basis = _capsule(x, y), _Y_TO_Z
        case _:
            geometry = _mesh(model, geom)
    return geometry, basis


def _capsule(radius: float, half: float) -> Json:
    """Revolve a capsule's outline, because meshcat's three.js is older than CapsuleGeometry."""
    angles = np.linspace(-np.pi / 2, np.pi / 2, 18)  # an even number of angles, half of them for each end
    across = np.abs(radius * np.cos(angles))
    along = radius * np.sin(angles) + np.where(angles > 0, half, -half)
    return _lathe(np.column_stack([across, along]))


def _lathe(outline: Array) -> Json:
    """Return the surface generated by revolving an outline of shape (n, 2) about its second axis."""
    points = [{"x": x, "y": y} for x, y in outline.tolist()]
    return {"type": "LatheGeometry", "points": points, "segments": 24, "phiStart": 0.0, "phiLength": 2 * np.pi}


def _mesh(model: mujoco.MjModel, geom: int) -> Json:
    """Return a mesh with MuJoCo's own normals, which keep sharp edges sharp.

    The geom's pose already includes the mesh's pose.
    """
    mesh = model.geom_dataid[geom]
    faces = slice(model.mesh_faceadr[mesh], model.mesh_faceadr[mesh] + model.mesh_facenum[mesh])
    corners = model.mesh_vert[model.mesh_vertadr[mesh] + model.mesh_face[faces]]
    normals = model.mesh_normal[model.mesh_normaladr[mesh] + model.mesh_facenormal[faces]]
    attributes = {"position": _floats(corners), "normal": _floats(normals)}
    return {"type": "BufferGeometry", "data": {"attributes": attributes}}


def _floats(rows: NDArray[np.float32]) -> Json:
    return {"itemSize": 3, "type": "Float32Array", "array": rows, "normalized": False}


def _material(model: mujoco.MjModel, geom: int) -> Json:
    """Approximate MuJoCo's material: its colour, transparency, shininess and emission."""
    colour, material = colour_of(model, geom), model.geom_matid[geom]
    specular, shininess, emission = 0.5, 0.5, 0.0
    if material >= 0:
        look = model.material(material)
        specular, shininess, emission = look.specular[0], look.shininess[0], look.emission[0]
    return {
        "type": "MeshPhongMaterial",
        "color": _hexadecimal(colour[:3]),
        "emissive": _hexadecimal(colour[:3] * emission),
        "specular": _hexadecimal(np.full(3, specular / 2)),
        "shininess": 1 + 127 * float(shininess),
        "opacity": float(colour[3]),
        "transparent": bool(colour[3] < 1),
        "side": BOTH if model.geom_type[geom] == mujoco.mjtGeom.mjGEOM_PLANE else FRONT,
    }


def _hexadecimal(colour: Array) -> int:
    red, green, blue = (255 * colour.clip(0, 1)).round().astype(int).tolist()
    return int(red << 16 | green << 8 | blue)
