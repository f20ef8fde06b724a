"""Write the files of the page `drive`: the course's code and models, and Python and MuJoCo compiled for the browser.

The page runs the course's controllers unchanged. ``drive/python`` replaces the parts that a browser lacks: Cyclone DDS
and the simulation's thread.
"""

import json
import shutil
import subprocess
from functools import cache
from importlib.metadata import distribution
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import mujoco

from pocket_ros2 import PATH as POCKET
from tutorial.body import Body
from tutorial.model.actuators import effort_command
from tutorial.program.project import Project
from tutorial.system.paths import HOME, find_project
from tutorial.view.assets import VIEW, read_static
from tutorial.view.bodies import View
from tutorial.view.scene import Record, Scene, unpack_command, unpack_records
from tutorial.world import compose, world_spec

HERE = Path(__file__).parent / "drive"
FETCHED = Path(__file__).parent / "_build" / "npm"

PACKAGES = {
    "@mujoco/mujoco@3.14.0": ("mujoco.js", "mujoco.wasm"),
    "pyodide@314.0.7": ("pyodide.mjs", "pyodide.asm.mjs", "pyodide.asm.wasm", "python_stdlib.zip"),
}
"""The files that the page needs from npm packages, by package. These packages are not in the repository."""

IDL = ("__init__", "_builder", "_machinery", "_main", "_support", "_type_helper", "_type_normalize", "types")
CYCLONE = [f"cyclonedds/idl/{name}.py" for name in IDL]
"""The files of the codec that the pocket ROS 2 uses, from the package ``cyclonedds``."""

LOCK = "pyodide-lock.json"
"""The list of packages that Pyodide can load; the page provides none of them."""

MODULES = (
    *("controller", "errors", "handoff", "joints", "program/__init__", "program/controller_files"),
    *("ros/__init__", "ros/joy", "system/__init__", "system/paths"),
)
"""The modules of ``tutorial`` that the page needs, besides the controllers."""

PROGRAMS = {
    "simulation": ("step2", "TankController", "tank_controller.py"),
    "viewer": ("step3", "JointStateSubscriber", "joint_state_subscriber.py"),
}
"""For each of the page's programs: its project, and the class and file of the controller that the visitor edits."""


@cache
def fetch() -> Path | None:
    """Return the folder of the npm packages, fetching them first if necessary; None if npm is missing or fails."""
    marker = FETCHED / "fetched.json"
    if marker.is_file() and json.loads(marker.read_text()) == [*PACKAGES]:
        return FETCHED / "node_modules"
    npm = shutil.which("npm")
    if npm is None:
        return None
    options = ("--no-save", "--no-package-lock", "--no-audit", "--no-fund", "--ignore-scripts", "--loglevel=error")
    try:
        FETCHED.mkdir(parents=True, exist_ok=True)
        subprocess.run([npm, "install", "--prefix", FETCHED, *options, *PACKAGES], check=True, timeout=600)
    except (subprocess.SubprocessError, OSError):
        return None
    marker.write_text(json.dumps([*PACKAGES]))
    return FETCHED / "node_modules"


def write_python(folder: Path) -> None:
    """Write the page's Python code into a folder: the course and the pocket ROS 2, adapted for the browser."""
    course = [HOME / "tutorial" / f"{name}.py" for name in MODULES]
    files = {path: path.relative_to(HOME) for path in (*course, *(HOME / "tutorial/controllers").glob("*.py"))}
    cyclone = Path(str(distribution("cyclonedds").locate_file("")))
    files |= {cyclone / name: Path(name) for name in CYCLONE}
    for root in (POCKET, HERE / "python"):  # files from the second folder replace files from the first
        files |= {path: path.relative_to(root) for path in root.rglob("*") if path.suffix in (".py", ".json")}
    for path, name in files.items():
        if name.parts[0] != "launch":
            (folder / name).parent.mkdir(parents=True, exist_ok=True)
            shutil.copyfile(path, folder / name)


def script() -> str:
    """Return the page's script, including the code that it shares with the widgets."""
    sticks = read_static("make.js", "cell.js", "joystick.js").replace("\nexport default ", "\nreturn ")
    shared = read_static(*VIEW)
    page = (HERE / "drive.js").read_text(encoding="utf-8")
    text = f"{shared}\nconst joystick = (() => {{\n{sticks}\n}})();\n{page}".replace("\nexport ", "\n")
    return f"(() => {{\n{text}\n}})();\n"


def style() -> str:
    """Return the page's style sheet."""
    return read_static("scene_view.css", "joystick.css") + (HERE / "drive.css").read_text(encoding="utf-8")


def write_site(static: Path) -> None:
    """Write all files of the page into the book's folder of static files, if npm is available."""
    packages = fetch()
    if packages is None:
        return
    folder = static / "drive"
    folder.mkdir(parents=True, exist_ok=True)
    for package, names in PACKAGES.items():
        for name in names:
            shutil.copyfile(packages / package.rpartition("@")[0] / name, folder / name)
    lock = json.loads((packages / "pyodide" / LOCK).read_text(encoding="utf-8"))
    # If its lock file listed packages, Pyodide would load them from other sites.
    (folder / LOCK).write_text(json.dumps(lock | {"packages": {}}), encoding="utf-8")
    with TemporaryDirectory() as course:
        write_python(Path(course))
        shutil.make_archive(str(folder / "course"), "zip", course)
    setups = {}
    for name, (project, controller, file) in PROGRAMS.items():
        setups[name], scene = _program(name, Project.load(find_project(project)), controller, file)
        (folder / f"{name}.scene").write_bytes(scene)
    (folder / "world.json").write_text(json.dumps(setups), encoding="utf-8")
    shutil.copyfile(HERE / "worker.js", folder / "worker.js")
    (static / "drive.js").write_text(script(), encoding="utf-8")
    (static / "drive.css").write_text(style(), encoding="utf-8")


def _program(name: str, project: Project, controller: str, file: str) -> tuple[dict[str, Any], bytes]:
    """Return the setup of one of the page's programs, and the scene that its view shows first."""
    placements = [each.placement for each in project.bodies]
    spec = world_spec(placements)
    model = spec.compile()
    scene = Scene()
    view = View(scene)
    for placement in placements:
        view.add(placement.name, compose([placement]))
    if len(placements) == 1:
        view.look_at_bodies(placements[0].name)
    (tank,) = (each for each in project.bodies if each.placement.name == "Tank")
    body = Body("Tank", model, mujoco.MjData(model))
    motors = {joint.name: effort_command(model, model.joint(f"Tank/{joint.name}").id).adr for joint in body.joints}
    actuators = [model.actuator(i).name.removeprefix("Tank/") for i in range(model.nu)]
    setup = {
        "node": "tank" if project.time_step else "viewer",
        "simulates": project.time_step is not None,
        "xml": spec.to_xml().replace(' input="vel"', ""),  # MuJoCo 4 writes this, but the page's MuJoCo 3.14 rejects it
        "joints": [
            {"name": j.name, "limits": j.range, "qpos": j.qpos_adr, "dof": j._dof_adr, "ctrl": motors[j.name]}
            for j in body.joints
        ],
        "actuators": {each: i for i, each in enumerate(actuators) if each not in motors},
        "controller": controller,
        "file": file,
        "source": (HOME / "tutorial/controllers" / file).read_text(encoding="utf-8"),
        "others": [name for each in tank.controllers if (name := each.__name__) != controller],
        "paths": _paths(scene, model),
    }
    return setup, scene.snapshot()


def _paths(scene: Scene, model: mujoco.MjModel) -> dict[int, str]:
    """Return the scene path of each moving body, keyed by the body's MuJoCo ID."""
    records = unpack_records(scene.snapshot())
    commands = [unpack_command(payload) for kind, payload in records if kind is Record.COMMAND]
    paths = {each["path"] for each in commands if each["type"] == "set_transform"}
    names = {model.body(i).name.replace("/", "."): i for i in range(model.nbody) if model.body_weldid[i]}
    return {names[name]: path for path in sorted(paths) if (name := path.rpartition("/")[2]) in names}
