"""Project files: which bodies a program has, which controllers they carry, and whether it simulates."""

from __future__ import annotations

import pkgutil
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from importlib import import_module
from pathlib import Path
from typing import Any

from tutorial import controllers
from tutorial.controller import SimpleController
from tutorial.errors import TutorialError, did_you_mean
from tutorial.world import Placement
from tutorial.yamlfile import YamlFile

__all__ = ["BodyItem", "Camera", "Project", "controller_names", "find_controller"]

Point = tuple[float, float, float]

_NAME = {
    "type": "string",
    "pattern": "^[A-Za-z][A-Za-z0-9_]*$",
    "description": "a name of letters, digits and _",
}

_POINT = {
    "type": "array",
    "items": {"type": "number"},
    "minItems": 3,
    "maxItems": 3,
    "description": "three numbers [x, y, z] in metres",
}

SCHEMA: dict[str, Any] = {
    "type": "object",
    "description": "a mapping with the key 'bodies' and, if it simulates, 'simulator'",
    "required": ["bodies"],
    "additionalProperties": False,
    "properties": {
        "simulator": {
            "type": "object",
            "description": "a mapping, for instance {time_step: 0.001}",
            "additionalProperties": False,
            "properties": {
                "time_step": {
                    "type": "number",
                    "exclusiveMinimum": 0,
                    "maximum": 0.01,
                    "description": "a time step in seconds, such as 0.001",
                }
            },
        },
        "camera": {
            "type": "object",
            "description": "a mapping with 'position' and 'target'",
            "required": ["position", "target"],
            "additionalProperties": False,
            "properties": {"position": _POINT, "target": _POINT},
        },
        "bodies": {
            "type": "array",
            "minItems": 1,
            "description": "a list of bodies, each with 'name' and 'model'",
            "items": {
                "type": "object",
                "description": "a body with 'name' and 'model'",
                "required": ["name", "model"],
                "additionalProperties": False,
                "properties": {
                    "name": _NAME,
                    "model": {
                        "type": "string",
                        "description": "the path of a model, seen from the project file",
                    },
                    "position": _POINT,
                    "controllers": {
                        "type": "array",
                        "items": {"type": "string", "description": "the name of a controller"},
                        "description": "a list of controllers' names",
                    },
                },
            },
        },
    },
}


@dataclass(frozen=True)
class Camera:
    """From where the 3D view is looked at, to begin with.

    Attributes:
        position: of the camera [m], (x, y, z).
        target: what is in the middle of the picture [m], (x, y, z).
    """

    position: Point
    target: Point


@dataclass(frozen=True)
class BodyItem:
    """One body of a project.

    Attributes:
        placement: the model, and where it stands.
        controllers: the classes of its controllers, in the order in which they run.
    """

    placement: Placement
    controllers: tuple[type[SimpleController], ...] = ()


@dataclass(frozen=True)
class Project:
    """What one program consists of.

    Attributes:
        path: the file that it comes from.
        bodies: its bodies.
        time_step: of the simulation [s]; None for a program that only displays.
        camera: where the view begins; None to leave it to the view.
    """

    path: Path
    bodies: tuple[BodyItem, ...]
    time_step: float | None = None
    camera: Camera | None = None

    @classmethod
    def load(cls, path: str | Path) -> Project:
        """Read a project file and check it.

        Args:
            path: the file; models are looked for beside it.

        Raises:
            TutorialError: it is missing, malformed, or names a controller or a model that there is not; the text names
                the line and the mend.
        """
        file = YamlFile(Path(path), SCHEMA, "project")
        items = [_body_item(file, i, entry) for i, entry in enumerate(file.data["bodies"])]
        names = [item.placement.name for item in items]
        for i, name in enumerate(names):
            if name in names[:i]:
                raise file.error(
                    ("bodies", i, "name"), f"there is a body {name!r} already. Give this one another name."
                )
        simulator = file.data.get("simulator")
        time_step = None if simulator is None else float(simulator.get("time_step", 0.001))
        camera = file.data.get("camera")
        looks_from = None if camera is None else Camera(_point(camera["position"]), _point(camera["target"]))
        return cls(file.path, tuple(items), time_step, looks_from)

    def with_robot(self, model: Path, name: str | None = None) -> Project:
        """Put another model in the place of the body that carries the controllers.

        Args:
            model: its MJCF file.
            name: the body's name; None for the file's name, capitalised.

        Raises:
            TutorialError: no body, or more than one, has controllers.
        """
        robots = [item for item in self.bodies if item.controllers]
        if len(robots) != 1:
            raise TutorialError(
                f"{self.path} has {len(robots)} bodies with controllers, so it is not clear which to replace."
            )
        placement = replace(robots[0].placement, name=name or model.stem.capitalize(), model=model)
        swapped = replace(robots[0], placement=placement)
        return replace(self, bodies=tuple(swapped if item is robots[0] else item for item in self.bodies))

    def tree(self) -> str:
        """Draw the items, as the original's item tree shows them."""
        return "\n".join(self._tree_lines())

    def _tree_lines(self) -> Iterator[str]:
        indent = ""
        if self.time_step is not None:
            yield "+ World"
            indent = "  "
        for item in self.bodies:
            yield f"{indent}+ {item.placement.name}"
            for controller in item.controllers:
                yield f"{indent}  - {controller.__name__}"
        if self.time_step is not None:
            yield f"{indent}+ Simulator ({self.time_step * 1000:g} ms)"


def controller_names() -> dict[str, str]:
    """Map the names of the library's controllers to their modules: ``tank_controller.py`` holds ``TankController``."""
    modules = (module.name for module in pkgutil.iter_modules(controllers.__path__))
    return {
        "".join(word.capitalize() for word in name.split("_")): f"{controllers.__name__}.{name}" for name in modules
    }


def find_controller(name: str) -> type[SimpleController]:
    """Find one of the library's controllers by its class name.

    Raises:
        TutorialError: there is no such controller; the text names the nearest.
    """
    known = controller_names()
    if name not in known:
        raise TutorialError(f"there is no controller {name!r}.{did_you_mean(name, known)}")
    found: type[SimpleController] = getattr(import_module(known[name]), name)
    return found


def _body_item(file: YamlFile, index: int, entry: Mapping[str, Any]) -> BodyItem:
    model = file.path.parent / entry["model"]
    if not model.is_file():
        others = (
            [str(p.relative_to(file.path.parent)) for p in model.parent.glob("*.xml")] if model.parent.is_dir() else []
        )
        hint = did_you_mean(entry["model"], others)
        raise file.error(("bodies", index, "model"), f"there is no model {entry['model']!r}.{hint}")
    classes = []
    for i, name in enumerate(entry.get("controllers", ())):
        try:
            classes.append(find_controller(name))
        except TutorialError as error:
            raise file.error(("bodies", index, "controllers", i), str(error)) from None
    return BodyItem(Placement(entry["name"], model, _point(entry.get("position", (0, 0, 0)))), tuple(classes))


def _point(numbers: Sequence[float]) -> Point:
    x, y, z = map(float, numbers)
    return x, y, z
