"""What is said about a real ROS 2: the list of its packages."""

import re
import tomllib

from packaging.requirements import Requirement
from packaging.specifiers import SpecifierSet

from tutorial.paths import HOME

PROJECT = tomllib.loads((HOME / "pyproject.toml").read_text())["project"]


PIXI = tomllib.loads((HOME / "pixi.toml").read_text())


def test_what_both_require_can_be_had_at_once():
    wanted = {each.name: each.specifier for each in map(Requirement, PROJECT["dependencies"])}
    both = {name: SpecifierSet(spec) for name, spec in PIXI["dependencies"].items() if name in wanted}
    assert both
    assert both == {name: wanted[name] for name in both}
    assert PIXI["dependencies"]["python"].replace("*", "0") in SpecifierSet(PROJECT["requires-python"])


def test_every_message_package_that_the_tutorial_imports_is_listed():
    folders = ("controllers", "notebook", "notebook/widgets")
    texts = [path.read_text() for folder in folders for path in (HOME / "tutorial" / folder).glob("*.py")]
    imported = set(re.findall(r"^from (\w+_msgs)\.msg", "\n".join(texts), re.MULTILINE))
    assert imported
    assert {f"ros-jazzy-{name.replace('_', '-')}" for name in imported} <= set(PIXI["dependencies"])
