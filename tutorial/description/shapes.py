"""MuJoCo's geoms as URDF shapes: the visible and the colliding parts of links."""

from pathlib import Path
from xml.etree.ElementTree import Element, SubElement

import mujoco
import numpy as np

from tutorial.description.colour import colour_of, is_seen, takes_material
from tutorial.description.poses import Matrix, add_origin, numbers, pose, shift

Shape = tuple[str, dict[str, str], Matrix]
"""A shape in a URDF: its tag, its attributes, and its pose relative to the geom."""

MESH_FILES = {".dae", ".obj", ".stl"}
"""The mesh formats that rviz2 reads."""

Geom = mujoco.mjtGeom


def add_shapes(link: Element, model: mujoco.MjModel, geom: int) -> str:
    """Add a geom to a link: as a ``<visual>`` if MuJoCo's viewer shows it, and as a ``<collision>`` if it can collide.

    Returns:
        The shapes that URDF cannot express, such as ``"ellipsoid shapes"``; empty if URDF can express the geom.
    """
    seen = is_seen(model, geom)
    touches = model.geom_contype[geom] or model.geom_conaffinity[geom]
    if not (seen or touches):
        return ""
    kind = Geom(model.geom_type[geom])
    shapes = _shapes(model, geom, kind)
    for shape in shapes if seen else ():
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
    """Return the material's name or a name made from the geom's own colour, so that equal names mean equal colours."""
    if takes_material(model, geom):
        return str(model.material(model.geom_matid[geom]).name.partition("/")[2])
    return "rgba_" + "".join(f"{round(255 * part):02x}" for part in colour_of(model, geom).clip(0, 1).tolist())


def _shapes(model: mujoco.MjModel, geom: int, kind: mujoco.mjtGeom) -> list[Shape]:
    """Return a geom's URDF shapes, such as a cylinder and two spheres for a capsule; empty if there are none."""
    size, middle = model.geom_size[geom], np.eye(4)
    ball = {"radius": numbers(size[:1])}
    cylinder = ("cylinder", {**ball, "length": numbers(2 * size[1:2])}, middle)
    match kind:
        case Geom.mjGEOM_BOX:
            return [("box", {"size": numbers(2 * size)}, middle)]
        case Geom.mjGEOM_SPHERE:
            return [("sphere", ball, middle)]
        case Geom.mjGEOM_CYLINDER:
            return [cylinder]
        case Geom.mjGEOM_CAPSULE:
            return [cylinder, *(("sphere", ball, shift((0.0, 0.0, end))) for end in (size[1], -size[1]))]
        case Geom.mjGEOM_MESH:
            return _mesh(model, geom)
    return []


def _mesh(model: mujoco.MjModel, geom: int) -> list[Shape]:
    """Return the mesh as a reference to its file, if it has a file in a format that other programs read.

    MuJoCo moves a mesh so that its centre and principal axes become the geom's frame; this function reverses that move.
    An additional offset (``refpos``, ``refquat``) is ignored, because a compiled model does not store it.
    """
    mesh = model.geom_dataid[geom]
    start = model.mesh_pathadr[mesh]
    if start < 0:  # the vertices are in the model itself
        return []
    path = Path(model.paths[start:].partition(b"\0")[0].decode(errors="surrogateescape")).absolute()
    if path.suffix.lower() not in MESH_FILES:
        return []
    attributes = {"filename": path.as_uri(), "scale": numbers(model.mesh_scale[mesh])}
    return [("mesh", attributes, np.linalg.inv(pose(model.mesh_pos[mesh], model.mesh_quat[mesh])))]
