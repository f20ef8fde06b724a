"""Who opens ``tutorial/`` sees the lesson and what it stands on; the pages that show the layout follow it."""

from __future__ import annotations

import re
import tomllib
from itertools import pairwise

import pytest

from tutorial.paths import HOME

TUTORIAL, TESTS = HOME / "tutorial", HOME / "tests"
WINGS = {"controllers", "description", "ros", "view", "notebook", "checks", "commands"}
SMALL_LIBRARY = ("controller", "handoff", "trace", "joints", "body", "world", "simulation")
OUTSIDE = {"MuJoCo", "meshcat", "rclpy"}


def modules():
    return {path.stem for path in TUTORIAL.glob("*.py")}


def visible():
    """What a reader tells apart: the modules, and the wings with a slash."""
    return {name for name in modules() if not name.startswith("__")} | {f"{name}/" for name in WINGS}


def test_seven_wings_and_few_modules_are_all_there_is():
    assert len(modules()) <= 16
    assert {path.name for path in TUTORIAL.iterdir() if path.is_dir() and path.name[0] not in "._"} == WINGS


def test_the_small_library_is_small():
    lines = [len((TUTORIAL / f"{name}.py").read_text(encoding="utf-8").splitlines()) for name in SMALL_LIBRARY]
    assert sum(lines) < 1700


def test_the_tests_mirror_the_tree():
    own = {"course", "house"}
    folders = {path.parent.relative_to(TESTS) for path in TESTS.rglob("test_*.py")}
    assert [folder for folder in folders if not own & set(folder.parts) and not (TUTORIAL / folder).is_dir()] == []


def test_contributing_names_what_is_there():
    text = (HOME / "CONTRIBUTING.md").read_text(encoding="utf-8")
    table = re.search(r"^\| in `tutorial/` .*\n(?:\|.*\n)+", text, re.MULTILINE)[0]
    first, *others = zip(*(row.split("|")[1:-1] for row in table.splitlines()[2:]))
    assert sorted(re.findall(r"`(.+?)(?:\.py)?`", " ".join(first))) == sorted(visible())
    inner = {name for cells in others for name in re.findall(r"`(\w+)/`", " ".join(cells))}
    assert inner == {path.name for wing in WINGS for path in (TUTORIAL / wing).glob("[!_]*") if path.is_dir()}


@pytest.fixture
def layers():
    """By name, how far down the linter's contract has a module or a wing."""
    settings = tomllib.loads((HOME / "pyproject.toml").read_text(encoding="utf-8"))["tool"]["importlinter"]
    return {name: i for i, layer in enumerate(settings["contracts"][0]["layers"]) for name in layer.split(" | ")}


def test_the_picture_of_the_modules_has_the_linters_layers(layers):
    picture = (HOME / "book" / "images" / "modules.svg").read_text(encoding="utf-8")
    *rows, outside = (re.findall(r'class="name"[^>]*>(.+?)<', row) for row in picture.split("<g ")[1:])
    assert sorted(name for row in rows for name in row) == sorted(visible())
    assert set(outside) == OUTSIDE
    depths = [[layers[name.rstrip("/")] for name in row] for row in rows]
    assert all(max(upper) < min(lower) for upper, lower in pairwise(depths))
