"""MuJoCo's geoms as the objects that meshcat's viewer draws: three.js in JSON.

Written out here rather than with ``meshcat.geometry``, which has no capsules, planes or lights, and whose
import brings ZMQ, IPython and Pillow along (0.3 s and a deprecation warning).
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import mujoco
import numpy as np
from numpy.typing import NDArray

from tutorial.description.colour import colour_of

__all__ = ["draw_arrow", "draw_geom", "is_drawn", "light"]

Json = dict[str, Any]
Array = NDArray[np.float64]

DRAWN_GROUPS = 3
"""Geoms of groups 0 to 2 are drawn. As in MuJoCo's own viewer, 3 to 5 hold what only touches."""

ENDLESS = 20.0
"""A plane of size 0 is endless in MuJoCo; here it is this long and wide [m]."""

FRONT, BOTH = 0, 2
"""Which sides of a surface three.js draws."""

_BALL = {"type": "SphereGeometry", "widthSegments": 32, "heightSegments": 16}

_AS_IT_IS = np.eye(3)
_Y_TO_Z = np.array([[1.0, 0.0, 0.0], [0.0, 0.0, -1.0], [0.0, 1.0, 0.0]])
"""Three.js stands its cylinders along y, MuJoCo along z."""


def is_drawn(model: mujoco.MjModel, geom: int) -> bool:
    """Say whether a geom is in a visible group, not fully transparent and of a shape that can be drawn."""
    visible = model.geom_group[geom] < DRAWN_GROUPS and colour_of(model, geom)[3] > 0
    return bool(visible and int(model.geom_type[geom]) in _SHAPES)


def draw_geom(model: mujoco.MjModel, geom: int, uuid: str) -> Json:
    """Write one geom as the object of a ``set_object`` command.

    Args:
        model: the geom's model.
        geom: its number.
        uuid: a name for the object that nothing else in the scene has.

    Returns:
        The object, placed as the geom is in its MuJoCo body [m].
    """
    geometry, basis = _SHAPES[int(model.geom_type[geom])](model, geom)
    rotation = np.empty(9)
    mujoco.mju_quat2Mat(rotation, model.geom_quat[geom])
    matrix = _matrix(rotation.reshape(3, 3) @ basis, model.geom_pos[geom])
    return _mesh_object(uuid, geometry, _material(model, geom), matrix)


def draw_arrow(uuid: str, colour: int) -> Json:
    """Write an arrow, 1 m long along z, as the object of a ``set_object`` command.

    Args:
        uuid: a name for the object that nothing else in the scene has.
        colour: as 0xRRGGBB.
    """
    outline = ((0.0, 0.0), (0.012, 0.0), (0.012, 0.75), (0.035, 0.75), (0.0, 1.0))  # from the axis, and along it [m]
    points = [{"x": x, "y": y} for x, y in outline]
    geometry = {"type": "LatheGeometry", "points": points, "segments": 24, "phiStart": 0.0, "phiLength": 2 * np.pi}
    material = {"type": "MeshPhongMaterial", "color": colour, "emissive": colour // 2 & 0x7F7F7F, "side": BOTH}
    return _mesh_object(uuid, geometry, material, _matrix(_Y_TO_Z, np.zeros(3)))


def light(kind: str, position: tuple[float, float, float] = (0.0, 0.0, 0.0), **settings: Any) -> Json:
    """Write a light, for instance a ``"DirectionalLight"``, as the object of a ``set_object`` command.

    Args:
        kind: the light's class in three.js.
        position: where it stands [m]; a directional light shines from there to the origin.
        settings: the light's JSON, for instance ``intensity``.
    """
    return {
        "metadata": {"version": 4.5, "type": "Object"},
        "object": {"uuid": kind, "type": kind, "matrix": _matrix(_AS_IT_IS, position), **settings},
    }


def _mesh_object(uuid: str, geometry: Json, material: Json, matrix: list[float]) -> Json:
    return {
        "metadata": {"version": 4.5, "type": "Object"},
        "geometries": [{"uuid": f"{uuid} geometry", **geometry}],
        "materials": [{"uuid": f"{uuid} material", **material}],
        "object": {
            "uuid": uuid,
            "type": "Mesh",
            "geometry": f"{uuid} geometry",
            "material": f"{uuid} material",
            "matrix": matrix,
        },
    }


def _matrix(rotation: Array, position: Any) -> list[float]:
    """A 4 x 4 matrix as three.js stores it: column by column."""
    matrix = np.eye(4)
    matrix[:3, :3] = rotation
    matrix[:3, 3] = position
    return [float(number) for number in matrix.T.flat]


def _plane(model: mujoco.MjModel, geom: int) -> tuple[Json, Array]:
    width, height = (float(2 * half) or ENDLESS for half in model.geom_size[geom, :2])
    return {"type": "PlaneGeometry", "width": width, "height": height}, _AS_IT_IS


def _box(model: mujoco.MjModel, geom: int) -> tuple[Json, Array]:
    width, height, depth = (float(2 * half) for half in model.geom_size[geom])
    return {"type": "BoxGeometry", "width": width, "height": height, "depth": depth}, _AS_IT_IS


def _sphere(model: mujoco.MjModel, geom: int) -> tuple[Json, Array]:
    return {**_BALL, "radius": float(model.geom_size[geom, 0])}, _AS_IT_IS


def _ellipsoid(model: mujoco.MjModel, geom: int) -> tuple[Json, Array]:
    return {**_BALL, "radius": 1.0}, np.diag(model.geom_size[geom])


def _cylinder(model: mujoco.MjModel, geom: int) -> tuple[Json, Array]:
    radius, half = (float(number) for number in model.geom_size[geom, :2])
    ends = {"radiusTop": radius, "radiusBottom": radius}
    return {"type": "CylinderGeometry", **ends, "height": 2 * half, "radialSegments": 32}, _Y_TO_Z


def _capsule(model: mujoco.MjModel, geom: int) -> tuple[Json, Array]:
    """Turn a capsule's outline about its axis: meshcat's three.js is older than CapsuleGeometry."""
    radius, half = (float(number) for number in model.geom_size[geom, :2])
    angles = np.linspace(-np.pi / 2, np.pi / 2, 18)  # an even number: half of them for each end
    across = np.abs(radius * np.cos(angles))
    along = radius * np.sin(angles) + np.where(angles > 0, half, -half)
    outline = [{"x": float(x), "y": float(y)} for x, y in zip(across, along)]
    turn = {"segments": 24, "phiStart": 0.0, "phiLength": 2 * np.pi}
    return {"type": "LatheGeometry", "points": outline, **turn}, _Y_TO_Z


def _mesh(model: mujoco.MjModel, geom: int) -> tuple[Json, Array]:
    """Take a mesh with MuJoCo's own normals, which keep sharp edges sharp.

    The geom's pose has the mesh's baked in.
    """
    mesh = model.geom_dataid[geom]
    faces = slice(model.mesh_faceadr[mesh], model.mesh_faceadr[mesh] + model.mesh_facenum[mesh])
    corners = model.mesh_vert[model.mesh_vertadr[mesh] + model.mesh_face[faces]]
    normals = model.mesh_normal[model.mesh_normaladr[mesh] + model.mesh_facenormal[faces]]
    attributes = {"position": _floats(corners), "normal": _floats(normals)}
    return {"type": "BufferGeometry", "data": {"attributes": attributes}}, _AS_IT_IS


def _floats(rows: NDArray[np.float32]) -> Json:
    return {"itemSize": 3, "type": "Float32Array", "array": rows, "normalized": False}


_SHAPES: dict[int, Callable[[mujoco.MjModel, int], tuple[Json, Array]]] = {
    int(mujoco.mjtGeom.mjGEOM_PLANE): _plane,
    int(mujoco.mjtGeom.mjGEOM_BOX): _box,
    int(mujoco.mjtGeom.mjGEOM_SPHERE): _sphere,
    int(mujoco.mjtGeom.mjGEOM_ELLIPSOID): _ellipsoid,
    int(mujoco.mjtGeom.mjGEOM_CYLINDER): _cylinder,
    int(mujoco.mjtGeom.mjGEOM_CAPSULE): _capsule,
    int(mujoco.mjtGeom.mjGEOM_MESH): _mesh,
}
"""Each writes the geometry's JSON and the 3 x 3 matrix that takes it into the geom's own frame."""


def _material(model: mujoco.MjModel, geom: int) -> Json:
    """Paint as MuJoCo does, roughly: its colour, transparency, gloss and glow."""
    colour, material = colour_of(model, geom), model.geom_matid[geom]
    specular, shininess, emission = (
        (model.mat_specular[material], model.mat_shininess[material], model.mat_emission[material])
        if material >= 0
        else (0.5, 0.5, 0.0)
    )
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
    red, green, blue = (round(255 * min(max(float(part), 0.0), 1.0)) for part in colour)
    return red << 16 | green << 8 | blue
