"""Who opens ``tutorial/`` sees the lesson and what it stands on."""

from __future__ import annotations

from tutorial.paths import HOME

TUTORIAL = HOME / "tutorial"
WINGS = {"controllers", "description", "ros", "view", "notebook", "checks", "commands"}
SMALL_LIBRARY = ("controller", "handoff", "trace", "joints", "body", "world", "stepped_world", "simulation")


def test_seven_wings_and_few_modules_are_all_there_is():
    assert len(list(TUTORIAL.glob("*.py"))) <= 21
    assert {path.name for path in TUTORIAL.iterdir() if path.is_dir() and path.name[0] not in "._"} == WINGS


def test_the_small_library_is_small():
    assert sum(len((TUTORIAL / f"{name}.py").read_text("utf-8").splitlines()) for name in SMALL_LIBRARY) < 1850
