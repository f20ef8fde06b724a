"""MuJoCo's geoms as the shapes of URDF: what is seen of a link, and what touches."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from xml.etree.ElementTree import Element, SubElement

import mujoco
import numpy as np
from numpy.typing import NDArray

from tutorial.body import SHOWN_GROUPS
from tutorial.description.colour import colour_of, takes_material
from tutorial.description.poses import add_origin, inverse, numbers, pose, shift

__all__ = ["add_shapes"]

Matrix = NDArray[np.float64]
Shape = tuple[str, dict[str, str], Matrix]
"""A tag of URDF, its attributes, and where it is within the geom."""

MESH_FILES = {".dae", ".obj", ".stl"}
"""What rviz2 reads."""

_IN_THE_MIDDLE = np.eye(4)


def add_shapes(link: Element, model: mujoco.MjModel, geom: int) -> str:
    """Add a geom to a link: as a ``<visual>`` if MuJoCo's viewer shows it, as a ``<collision>`` if it touches.

    Returns:
        What is missing then, such as ``"ellipsoid shapes"``; empty if nothing is.
    """
    is_seen = model.geom_group[geom] < SHOWN_GROUPS and colour_of(model, geom)[3] > 0
    touches = model.geom_contype[geom] or model.geom_conaffinity[geom]
    if not (is_seen or touches):
        return ""
    kind = mujoco.mjtGeom(model.geom_type[geom])
    shapes = _SHAPES.get(int(kind), _none)(model, geom)
    for shape in shapes if is_seen else ():
        material = SubElement(_add(link, "visual", model, geom, shape), "material", name=_material_name(model, geom))
        SubElement(material, "color", rgba=numbers(colour_of(model, geom).round(4)))
    for shape in shapes if touches else ():
        _add(link, "collision", model, geom, shape)
    return "" if shapes else f"{kind.name.removeprefix('mjGEOM_').lower()} shapes"


def _add(link: Element, tag: str, model: mujoco.MjModel, geom: int, shape: Shape) -> Element:
    kind, attributes, place = shape
    name = model.geom(geom).name.partition("/")[2]
    element = SubElement(link, tag, {"name": name} if name else {})
    add_origin(element, pose(model.geom_pos[geom], model.geom_quat[geom]) @ place)
    SubElement(SubElement(element, "geometry"), kind, attributes)
    return element


def _material_name(model: mujoco.MjModel, geom: int) -> str:
    """The material's; of a colour that is the geom's own, a name made from it, as equal names mean equal colours."""
    if takes_material(model, geom):
        return str(model.material(model.geom_matid[geom]).name.partition("/")[2])
    return "rgba_" + "".join(f"{round(255 * part):02x}" for part in colour_of(model, geom).clip(0, 1).tolist())


def _box(model: mujoco.MjModel, geom: int) -> list[Shape]:
    return [("box", {"size": numbers(2 * model.geom_size[geom])}, _IN_THE_MIDDLE)]


def _sphere(model: mujoco.MjModel, geom: int) -> list[Shape]:
    return [("sphere", {"radius": numbers(model.geom_size[geom, :1])}, _IN_THE_MIDDLE)]


def _cylinder(model: mujoco.MjModel, geom: int) -> list[Shape]:
    size = model.geom_size[geom]
    return [("cylinder", {"radius": numbers(size[:1]), "length": numbers(2 * size[1:2])}, _IN_THE_MIDDLE)]


def _capsule(model: mujoco.MjModel, geom: int) -> list[Shape]:
    """URDF has no capsules: a cylinder, and a sphere at each end."""
    ((_, ball, _),) = _sphere(model, geom)
    half = model.geom_size[geom, 1]
    return [*_cylinder(model, geom), *(("sphere", ball, shift((0.0, 0.0, end))) for end in (half, -half))]


def _mesh(model: mujoco.MjModel, geom: int) -> list[Shape]:
    """The file that MuJoCo has read, if there is one that others read, too.

    MuJoCo has moved the mesh, so that its centre and its principal axes are the geom's; in the file they are not. That
    a model moves it further (``refpos``, ``refquat``) is not kept in a compiled model, and not described.
    """
    mesh = model.geom_dataid[geom]
    start = model.mesh_pathadr[mesh]
    if start < 0:  # its vertices are written in the model
        return []
    path = Path(model.paths[start:].partition(b"\0")[0].decode(errors="surrogateescape")).absolute()
    if path.suffix.lower() not in MESH_FILES:
        return []
    attributes = {"filename": path.as_uri(), "scale": numbers(model.mesh_scale[mesh])}
    return [("mesh", attributes, inverse(pose(model.mesh_pos[mesh], model.mesh_quat[mesh])))]


def _none(_model: mujoco.MjModel, _geom: int) -> list[Shape]:
    """URDF has no such shape."""
    return []


_SHAPES: dict[int, Callable[[mujoco.MjModel, int], list[Shape]]] = {
    int(mujoco.mjtGeom.mjGEOM_BOX): _box,
    int(mujoco.mjtGeom.mjGEOM_SPHERE): _sphere,
    int(mujoco.mjtGeom.mjGEOM_CYLINDER): _cylinder,
    int(mujoco.mjtGeom.mjGEOM_CAPSULE): _capsule,
    int(mujoco.mjtGeom.mjGEOM_MESH): _mesh,
}
