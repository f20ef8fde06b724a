"""What is installed: Python, MuJoCo, the packages that the notebooks need."""

from __future__ import annotations

import shlex
import sys
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import TYPE_CHECKING

from tutorial.commands.doctor.contained import Ask, UnansweredError
from tutorial.commands.doctor.finding import Finding

if TYPE_CHECKING:
    from packaging.requirements import Requirement

__all__ = ["jupyter", "mujoco", "packages", "python", "python_home", "rendering"]

VersionOf = Callable[[str], str | None]

OLDEST, NEWEST = (3, 11), (3, 13)
GL = ("cgl", "glfw") if sys.platform == "darwin" else ("egl", "osmesa", "glfw")
FOR_WHAT = (
    "The tutorial itself needs it for nothing: the browser draws its 3D view. A mujoco.Renderer of your own does."
)
PIP = "python -m pip install"
SHOWN = ("jupyterlab", "ipykernel", "ipywidgets", "anywidget")
LAB_EXTENSIONS = {"@jupyter-widgets/jupyterlab-manager": "jupyterlab_widgets", "anywidget": "anywidget"}


def python(version: tuple[int, int, int], executable: str, home: str) -> Iterator[Finding]:
    """Say which Python this is.

    Args:
        version: its version.
        executable: its path.
        home: in what kind of environment it is, as `python_home` says it; empty for the system's own.
    """
    text = f"{'.'.join(map(str, version))}, {executable}, {home or 'not in a virtual environment'}"
    if not OLDEST <= version[:2] <= NEWEST:
        text = f"{text}; the tutorial is made for 3.11 to 3.13"
        yield Finding("Python", "problem", text, "python3.12 -m venv .venv, or 3.11, or 3.13")
    elif not home:
        mend = "to keep the tutorial's packages apart from the system's: make install, and . .venv/bin/activate"
        yield Finding("Python", "note", text, mend)
    else:
        yield Finding("Python", "ok", text)


def python_home(prefix: str, base_prefix: str) -> str:
    """Say in what kind of environment a Python is; empty when in none."""
    if prefix != base_prefix:
        return "in a virtual environment"
    return "in a conda environment" if (Path(prefix) / "conda-meta").is_dir() else ""


def mujoco(environment: Mapping[str, str], ask: Ask) -> Iterator[Finding]:
    """Say which MuJoCo there is, and whether it can be imported."""
    try:
        yield Finding("MuJoCo", "ok", ask("mujoco", environment))
    except UnansweredError as error:
        mend = "unset MUJOCO_GL" if "MUJOCO_GL" in str(error) else f"{PIP} --force-reinstall mujoco"
        yield Finding("MuJoCo", "problem", f"it cannot be imported: {error}", mend)


def rendering(environment: Mapping[str, str], ask: Ask, backends: Sequence[str] = GL) -> Iterator[Finding]:
    """Say with which of OpenGL's backends MuJoCo draws off the screen, each tried in a process of its own."""

    def works(backend: str) -> bool:
        try:
            return bool(ask("rendering", {**environment, "MUJOCO_GL": backend}))
        except UnansweredError:
            return False

    with ThreadPoolExecutor() as pool:
        good = [backend for backend, is_good in zip(backends, pool.map(works, backends)) if is_good]
    chosen = environment.get("MUJOCO_GL", "").strip().lower()
    if not good:
        text = f"none of {', '.join(backends)} draws off the screen. {FOR_WHAT}"
        yield Finding("rendering", "note", text, "on Debian or Ubuntu: sudo apt install libegl1 libgl1-mesa-dri")
        return
    text = f"off the screen with {', '.join(good)} of {', '.join(backends)}"
    if chosen in backends and chosen not in good:
        text = f"{text}, but MUJOCO_GL is {chosen}. {FOR_WHAT}"
        yield Finding("rendering", "note", text, f"export MUJOCO_GL={good[0]}")
    else:
        yield Finding("rendering", "ok", f"{text}; MUJOCO_GL is {chosen or 'not set'}. {FOR_WHAT}")


def packages(requirements: Iterable[str] | None, version_of: VersionOf) -> Iterator[Finding]:
    """Say which packages are missing or too old.

    Args:
        requirements: what the tutorial requires, as its metadata have it; None where it is not installed.
        version_of: the installed version of a package; None where there is none.
    """
    from packaging.requirements import Requirement  # noqa: PLC0415 - where it is missing, the rest goes on

    if requirements is None:
        text = "this Python has the tutorial's files, but they are not installed, so what they need is not known"
        yield Finding("packages", "note", text, f"in the tutorial's folder: {PIP} -e '.[gamepad]'")
        return
    wanted = [Requirement(text) for text in requirements]
    needed = [each for each in wanted if _applies(each)]
    lacking = [each for each in needed if not _is_met(each, version_of)]
    if lacking:
        text = f"missing or too old: {', '.join(_state(each, version_of) for each in lacking)}"
        yield Finding("packages", "problem", text, _install(lacking))
    else:
        yield Finding("packages", "ok", f"all {len(needed)} that the tutorial requires")
    gamepad = [e for e in wanted if _applies(e, "gamepad") and not _applies(e) and not _is_met(e, version_of)]
    if gamepad:
        yield Finding("packages", "note", "without pygame-ce tank joy knows no gamepad, only drives", _install(gamepad))


def jupyter(version_of: VersionOf, folders: Iterable[Path]) -> Iterator[Finding]:
    """Say which JupyterLab there is, and whether the page gets what shows the widgets.

    Args:
        version_of: the installed version of a package; None where there is none.
        folders: where JupyterLab looks for extensions.
    """
    versions = {name: version_of(name) for name in SHOWN}
    text = ", ".join(f"{name} {number}" for name, number in versions.items() if number)
    missing = [name for name, number in versions.items() if number is None]
    found = {name for folder in folders for name in LAB_EXTENSIONS if (folder / name).is_dir()}
    bare = [package for name, package in LAB_EXTENSIONS.items() if name not in found]
    if missing:
        yield Finding("JupyterLab", "problem", f"missing: {', '.join(missing)}", f"{PIP} {' '.join(missing)}")
    elif bare:
        text = f"{text}; but the page will show no widgets: JupyterLab does not find its part of {', '.join(bare)}"
        yield Finding("JupyterLab", "problem", text, f"{PIP} --force-reinstall {' '.join(bare)}")
    else:
        yield Finding("JupyterLab", "ok", text)


def _applies(requirement: Requirement, extra: str = "") -> bool:
    return requirement.marker is None or requirement.marker.evaluate({"extra": extra})


def _is_met(requirement: Requirement, version_of: VersionOf) -> bool:
    number = version_of(requirement.name)
    return number is not None and requirement.specifier.contains(number, prereleases=True)


def _state(requirement: Requirement, version_of: VersionOf) -> str:
    number = version_of(requirement.name)
    return requirement.name if number is None else f"{requirement.name} {number} (needs {requirement.specifier})"


def _install(requirements: Iterable[Requirement]) -> str:
    return " ".join([PIP, *(shlex.quote(f"{each.name}{each.specifier}") for each in requirements)])
