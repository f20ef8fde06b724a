"""Project files: the bodies of a program, their controllers, and the simulator."""

from __future__ import annotations

import math
import sys
from collections.abc import Callable, Container, Mapping
from dataclasses import dataclass, replace
from functools import partial
from itertools import groupby
from pathlib import Path
from typing import Annotated

import msgspec

from tutorial.controller import SimpleController
from tutorial.errors import TutorialError, did_you_mean
from tutorial.model.line_file import SUFFIX
from tutorial.model.yamlfile import YamlFile
from tutorial.program.controller_files import find_controller
from tutorial.system.paths import PACKAGE, is_file
from tutorial.world import Placement, compose

Coordinate = Annotated[float, msgspec.Meta(ge=-10_000, le=10_000)]  # [m]
Point = tuple[Coordinate, Coordinate, Coordinate]


class _Simulator(msgspec.Struct, forbid_unknown_fields=True):
    time_step: Annotated[float, msgspec.Meta(ge=0.0001, le=0.01)] = 0.001  # [s]
    clock: bool = False


class _Body(msgspec.Struct, forbid_unknown_fields=True):
    name: str
    model: str
    without: tuple[str, ...] = ()
    position: Point = (0.0, 0.0, 0.0)
    controllers: list[str] = []
    count: Annotated[int, msgspec.Meta(ge=1, le=1000)] | msgspec.UnsetType = msgspec.UNSET
    spacing: Annotated[float, msgspec.Meta(gt=0, le=100)] = 1.5  # [m]

    @property
    def names(self) -> list[str]:
        """The name of the body, or the names of a whole fleet: ``Tank_1``, ``Tank_2`` and so on."""
        return [self.name] if self.count is msgspec.UNSET else [f"{self.name}_{i + 1}" for i in range(self.count)]


class _ProjectFile(msgspec.Struct, forbid_unknown_fields=True):
    """The schema of a project file."""

    bodies: Annotated[list[_Body], msgspec.Meta(min_length=1)]
    simulator: _Simulator | msgspec.UnsetType = msgspec.UNSET


@dataclass(frozen=True)
class BodyItem:
    """One body of a project.

    Attributes:
        placement: the model and its position.
        controllers: the classes of its controllers, in execution order.
    """

    placement: Placement
    controllers: tuple[type[SimpleController], ...] = ()


@dataclass(frozen=True)
class Project:
    """The bodies and the simulator of one program.

    Attributes:
        path: the project file.
        bodies: the bodies.
        time_step: the simulation's time step [s]; None for a program without a simulation.
        clock: whether the simulation publishes its time on ``/clock``.
    """

    path: Path
    bodies: tuple[BodyItem, ...]
    time_step: float | None = None
    clock: bool = False

    @classmethod
    def load(cls, path: str | Path) -> Project:
        """Read and validate a project file.

        Args:
            path: the file; the paths of models are relative to its folder.

        Raises:
            TutorialError: the file is missing or malformed, or names a controller or a model that does not exist; the
                error message includes the line number and suggests a fix.
        """
        file = YamlFile(Path(path), _ProjectFile, "project")
        items: dict[str, BodyItem] = {}
        for i, body in enumerate(file.data.bodies):
            items |= _body_items(file, i, body, items)
        simulator = file.data.simulator
        if simulator is msgspec.UNSET:
            return cls(file.path, tuple(items.values()))
        return cls(file.path, tuple(items.values()), simulator.time_step, simulator.clock)

    def with_robot(self, model: Path) -> Project:
        """Return a copy of the project with a different model for the only body that has controllers.

        Args:
            model: the MJCF or URDF file; the body gets the file's name, capitalized.

        Raises:
            TutorialError: no body or several bodies have controllers, the model cannot be loaded, or the file's name
                is not valid for a body.
        """
        robots = [item for item in self.bodies if item.controllers]
        if len(robots) != 1:
            raise TutorialError(
                f"{self.path} has {len(robots)} bodies with controllers, so it is not clear which body to replace."
            )
        name = model.stem.capitalize()
        compose([Placement(name, model)])  # raises MuJoCo's error if the model cannot be loaded
        if unfit := _unfit(name):
            raise TutorialError(f"{model}: the body is named after the file, and {unfit}")
        swapped = replace(robots[0], placement=replace(robots[0].placement, name=name, model=model))
        return self._with(lambda item: swapped if item is robots[0] else item)

    def with_model(self, body: str, model: Path) -> Project:
        """Return a copy of the project with a different model for one body, such as a different course for the line.

        Args:
            body: the body's name.
            model: the path of the model, as in `Placement`.

        Raises:
            TutorialError: there is no such body, or the model cannot be loaded.
        """
        self._check_name(body)

        def swap(item: BodyItem) -> BodyItem:
            if item.placement.name != body:
                return item
            placement = replace(item.placement, model=model)
            compose([placement])  # raises an error if the model cannot be loaded
            return replace(item, placement=placement)

        return self._with(swap)

    def with_controllers(self, body: str, *classes: type[SimpleController]) -> Project:
        """Return a project where a body has these controllers instead of those in the project file.

        Args:
            body: the body's name.
            classes: the classes of its controllers, in execution order; can be empty.

        Raises:
            TutorialError: there is no such body, or an argument is not a controller class.
        """
        for given in classes:
            if not (isinstance(given, type) and issubclass(given, SimpleController)):
                raise TutorialError(f"{given!r} is not a controller. Give a class derived from SimpleController.")
        self._check_name(body)
        return self._with(lambda item: replace(item, controllers=classes) if item.placement.name == body else item)

    def with_own(self, classes: Mapping[str, type[SimpleController]]) -> Project:
        """Return a project where a user's controllers replace the controllers with the same names.

        Args:
            classes: the classes by name; those that are only base classes of others can have any name.

        Raises:
            TutorialError: a class's name is not that of a controller in the project; the error suggests the nearest
                name.
        """
        known = {controller.__name__ for item in self.bodies for controller in item.controllers}
        bases = {base.__name__ for controller in classes.values() for base in controller.__mro__[1:]}
        for name in classes.keys() - known - bases:
            why = "A class replaces the controller that has the same name."
            raise TutorialError(f"{self.path.name} has no controller {name!r}.{did_you_mean(name, known)} {why}")
        return self._with(
            lambda item: replace(item, controllers=tuple(classes.get(c.__name__, c) for c in item.controllers))
        )

    def tree(self) -> str:
        """Return the items as text, like the original tutorial's item tree; a fleet is one item."""
        indent = "" if self.time_step is None else "  "
        lines = []
        for _, alike in groupby(self.bodies, key=_fleet):
            first, *others = alike
            last = f" to {others[-1].placement.name}" if others else ""
            lines.append(f"{indent}+ {first.placement.name}{last}")
            lines += [f"{indent}  - {controller.__name__}{_origin(controller)}" for controller in first.controllers]
        if self.time_step is not None:
            lines = ["+ World", *lines, f"{indent}+ Simulator ({self.time_step * 1000:g} ms{', /clock' * self.clock})"]
        return "\n".join(lines)

    def _check_name(self, body: str) -> None:
        names = [item.placement.name for item in self.bodies]
        if body not in names:
            raise TutorialError(f"{self.path.name} has no body {body!r}.{did_you_mean(body, names)}")

    def _with(self, change: Callable[[BodyItem], BodyItem]) -> Project:
        return replace(self, bodies=tuple(map(change, self.bodies)))


def _origin(controller: type[SimpleController]) -> str:
    """Return the name of the file that defines a user's controller, in parentheses; empty for a library controller."""
    file = getattr(sys.modules.get(controller.__module__), "__file__", None)
    return "" if file is None or Path(file).is_relative_to(PACKAGE) else f" ({Path(file).name})"


def _fleet(item: BodyItem) -> tuple[object, ...]:
    """Return what all bodies of a fleet share: the name without its number, the model and the controllers."""
    stem, _, number = item.placement.name.rpartition("_")
    return (stem or number, number.isdecimal(), item.placement.model, item.controllers)


def _body_items(file: YamlFile[_ProjectFile], index: int, body: _Body, taken: Container[str]) -> dict[str, BodyItem]:
    """Return, by name, the body or bodies that an entry in a file describes. Errors include the line number."""
    at = partial(file.at, "bodies", index)
    with at("name"):
        if unfit := _unfit(body.name):
            raise TutorialError(unfit)
        if duplicates := [name for name in body.names if name in taken]:
            raise TutorialError(f"there is already a body {duplicates[0]!r}. Rename this one.")
    with at("model"):
        model = _find_model(file.path.parent, body.model)
    if body.without:
        with at("without"):
            compose([Placement("Model", model, without=body.without)])
    controllers = []
    for i, name in enumerate(body.controllers):
        with at("controllers", i):
            controllers.append(find_controller(name))
    places = _grid(len(body.names), body.position, body.spacing)
    placements = [Placement(name, model, place, without=body.without) for name, place in zip(body.names, places)]
    return {each.name: BodyItem(each, tuple(controllers)) for each in placements}


def _unfit(name: str) -> str:
    """Return why a body cannot have this name; empty if it can."""
    if not (name.isascii() and name.isidentifier() and name[0] != "_"):
        return f"{name!r} cannot be part of a topic name. Use letters, digits and _, starting with a letter."
    return ""


def _find_model(folder: Path, given: str) -> Path:
    """Find a model in the project's folder. Compile it now so that errors can point to the line in the project file."""
    if not is_file(folder / given):
        suffix = SUFFIX if given.endswith(SUFFIX) else ".xml"
        paths = (*folder.glob(f"*{suffix}"), *folder.glob(f"*/*{suffix}"))
        known = [str(path.relative_to(folder)) for path in paths]
        raise TutorialError(f"there is no model {given!r}.{did_you_mean(given, known)}")
    compose([Placement("Model", folder / given)])
    return folder / given


def _grid(count: int, middle: Point, spacing: float) -> list[Point]:
    """Return positions on a grid, row by row towards +x, and from left to right (facing +x) within each row."""
    columns = math.ceil(math.sqrt(count))
    rows = math.ceil(count / columns)
    x, y, z = middle
    places = [divmod(i, columns) for i in range(count)]
    return [
        (x + (row - (rows - 1) / 2) * spacing, y + ((columns - 1) / 2 - column) * spacing, z) for row, column in places
    ]
