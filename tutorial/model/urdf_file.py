"""Reads URDF files as MuJoCo models: adds compiler settings, and finds the meshes."""

import os
from collections.abc import Iterator
from pathlib import Path
from urllib.parse import unquote
from xml.etree import ElementTree
from xml.etree.ElementTree import Element, SubElement

import mujoco

from tutorial.errors import TutorialError

MESH_FILES = (".msh", ".obj", ".stl")
"""The mesh formats that MuJoCo reads."""

NO_MASS = 1e-9  # [kg]
"""The mass given to a link that has none in the file: MuJoCo requires a mass for each moving link."""

SETTINGS = {
    "discardvisual": "false",
    "fusestatic": "false",
    "strippath": "false",
    "balanceinertia": "true",
    "boundmass": str(NO_MASS),
    "boundinertia": "1e-12",
}
"""These settings keep all links and shapes, and correct physically impossible inertias."""

VISUAL, HIDDEN = 1, 3
"""The group that MuJoCo assigns to a URDF's visuals, and a group that viewers hide."""

PACKAGE = ("package", "model")
"""URL schemes of files in a package's folder."""


def read_urdf(path: Path) -> mujoco.MjSpec | None:
    """Read a robot description. The view shows the robot's visual shapes or, if there are none, its collision shapes.

    A mesh's ``filename`` can begin with ``package://``. This function looks for the package's folder, first by name and
    by ``package.xml`` in the file's folder and all folders above it, then by name in the folders of AMENT_PREFIX_PATH.

    Args:
        path: the file, whatever its suffix.

    Returns:
        The model; None if the file is not a URDF.

    Raises:
        TutorialError: the file is a xacro file, or a mesh is missing or in a format that MuJoCo cannot read.
        ValueError: MuJoCo rejects the file.
    """
    robot = _parse(path)
    if robot is None:
        return None
    meshdir = _apply_settings(robot)
    for mesh in robot.iterfind("link/*/geometry/mesh[@filename]"):
        mesh.set("filename", str(_find_mesh(mesh.get("filename", ""), path, meshdir)))
    _drop_repeated_names(robot)
    spec = mujoco.MjSpec.from_string(ElementTree.tostring(robot, encoding="unicode"))
    _show_visuals(spec)
    return spec


def _parse(path: Path) -> Element | None:
    """Parse a file whose root is ``<robot>``; return None for any other file, which is left to MuJoCo."""
    try:
        content = path.read_bytes()
    except (OSError, ValueError):
        return None
    if b"<robot" not in content:
        return None
    try:
        root = ElementTree.fromstring(content)
        is_xacro = any("xacro}" in str(each.tag) for each in root.iter())
    except ElementTree.ParseError as error:
        root, is_xacro, problem = None, b"<xacro:" in content, error
    if is_xacro or path.suffix == ".xacro":
        urdf = path.name.partition(".")[0] + ("_.urdf" if path.suffix == ".urdf" else ".urdf")
        raise TutorialError(
            f"the model {str(path)!r} is a xacro file. Convert it to URDF, on a machine with ROS 2: "
            f"xacro {path.name} > {urdf}"
        )
    if root is None:
        raise TutorialError(f"the model {str(path)!r} is not XML: {problem}.")
    return root if root.tag == "robot" else None


def _apply_settings(robot: Element) -> str | None:
    """Add the settings to the robot's ``<mujoco>`` element. Return the mesh folder specified there, if any."""
    extension = robot.find("mujoco")
    extension = SubElement(robot, "mujoco") if extension is None else extension
    compiler = extension.find("compiler")
    compiler = SubElement(extension, "compiler") if compiler is None else compiler
    compiler.attrib.update(SETTINGS)
    return compiler.attrib.pop("meshdir", None)


def _find_mesh(given: str, path: Path, meshdir: str | None) -> Path:
    """Find the mesh file.

    Args:
        given: the mesh's ``filename`` in the robot description.
        path: the path of the robot description.
        meshdir: the mesh folder that the description specifies, relative to the description's folder; None if the
            description specifies none.
    """
    folder = path.absolute().parent
    scheme, _, rest = given.rpartition("://")
    if scheme in PACKAGE:
        package, _, inside = rest.partition("/")
        candidates = [place / inside for place in _package_folders(package, folder)]
        missing = (
            f"No folder {package!r} above or beside the model, or in AMENT_PREFIX_PATH, contains it. "
            "Put the package's folder beside the model, or write the mesh's path into the model."
        )
    else:
        address = unquote(rest) if scheme == "file" else given
        candidates = [folder / address]
        missing = "There is no such file."
        if not Path(address).is_absolute():
            missing = "There is no such file: a path in a URDF is relative to the URDF's folder."
    if meshdir is not None:
        candidates += [folder / meshdir / given, folder / meshdir / Path(given).name]
    found = next((each for each in candidates if _is_file(each)), None)
    if found is None:
        raise TutorialError(f"the model {str(path)!r} needs the mesh {given!r}. {missing}")
    if found.suffix.lower() not in MESH_FILES:
        raise TutorialError(
            f"the model {str(path)!r} needs the mesh {given!r}. MuJoCo reads {', '.join(MESH_FILES)}: convert the "
            "mesh, for instance with Blender, and write the new file's name into the model."
        )
    return found


def _package_folders(package: str, folder: Path) -> Iterator[Path]:
    """Yield the possible folders of a ROS package that a file in `folder` refers to."""
    for parent in (folder, *folder.parents):
        yield parent / package
        if f"<name>{package}</name>" in _read_text(parent / "package.xml"):
            yield parent
    for prefix in filter(None, os.environ.get("AMENT_PREFIX_PATH", "").split(os.pathsep)):
        yield Path(prefix) / "share" / package


def _read_text(path: Path) -> str:
    return path.read_text(encoding="utf-8", errors="replace") if _is_file(path) else ""


def _is_file(path: Path) -> bool:
    return os.path.isfile(path)  # noqa: PTH113 - pathlib raises an error for an invalid path


def _drop_repeated_names(robot: Element) -> None:
    """Make the shapes' names unique: URDF lets visual and collision shapes share a name, but MuJoCo doesn't."""
    taken = set[str]()
    for shape in (*robot.iterfind("link/visual"), *robot.iterfind("link/collision")):
        name = shape.attrib.pop("name", "")
        if name and name not in taken:
            shape.set("name", name)
            taken.add(name)


def _show_visuals(spec: mujoco.MjSpec) -> None:
    """Hide the collision shapes if there are visual shapes. Allow purely visual meshes that do not enclose a volume."""
    seen = [geom for geom in spec.geoms if geom.group == VISUAL]
    touching = [geom for geom in spec.geoms if geom.group != VISUAL]
    for geom in touching if seen else ():
        geom.group = HIDDEN
    for name in {geom.meshname for geom in seen} - {geom.meshname for geom in touching}:
        if mesh := spec.mesh(name):
            mesh.inertia = mujoco.mjtMeshInertia.mjMESH_INERTIA_SHELL
