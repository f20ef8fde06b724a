"""What is installed from a wheel: it has all that is needed, and works where there is no checkout."""

from __future__ import annotations

import os
import re
import tarfile
import zipfile
from pathlib import Path

import pytest
from packages import run

from tutorial.paths import PACKAGE

CHECKOUT = PACKAGE.parent
COURSE = ("launch_py", "notebooks", "project")
PAGES = ("bags", "comparison", "fleet", "glossary", "own_package", "teaching", "tools")
JUNK = {"__pycache__", ".ipynb_checkpoints", "MUJOCO_LOG.TXT"}
NO_OTHER = """
import sys
from pathlib import Path
sys.path[:] = [entry for entry in sys.path if entry == {site!r} or not (Path(entry) / "tutorial/__init__.py").exists()]
"""

pytestmark = pytest.mark.build


def build(kind, source, target):
    """Build one distribution, and return its file."""
    target.mkdir(exist_ok=True)
    code = f"import sys; from hatchling.build import *; print(build_{kind}(sys.argv[1]))"
    return target / run("-c", code, target, cwd=source).strip()


@pytest.fixture(scope="module")
def wheel(tmp_path_factory):
    return build("wheel", CHECKOUT, tmp_path_factory.mktemp("wheel"))


@pytest.fixture
def installed(wheel, tmp_path, monkeypatch, domain):
    """The environment of a process that finds the wheel's tutorial, and is started where there is no checkout."""
    here, site, without = (tmp_path / name for name in ("here", "site", "without_checkout"))
    here.mkdir()
    without.mkdir()
    with zipfile.ZipFile(wheel) as archive:
        archive.extractall(site)
    (without / "sitecustomize.py").write_text(NO_OTHER.format(site=str(site)))
    monkeypatch.chdir(here)
    return {"PYTHONPATH": f"{site}{os.pathsep}{without}"}


def contents(wheel):
    """Name the files in a wheel, and say what they hold."""
    with zipfile.ZipFile(wheel) as archive:
        return {name: archive.read(name) for name in archive.namelist()}


def files(wheel):
    """Those that do not tell of the wheel itself."""
    return {name: data for name, data in contents(wheel).items() if ".dist-info/" not in name}


def test_it_holds_the_package_and_the_course_and_nothing_else(wheel):
    expected = {}
    for part in ("tutorial", *COURSE, *(f"book/{page}.md" for page in PAGES)):
        to = "" if part == "tutorial" else "tutorial/_files/"
        for path in (CHECKOUT / part, *(CHECKOUT / part).rglob("*")):
            if path.is_file() and not JUNK & set(path.parts):
                expected[to + path.relative_to(CHECKOUT).as_posix()] = path.read_bytes()
    found = files(wheel)
    assert found.keys() == expected.keys()
    assert found == expected


def test_the_sdist_has_what_the_wheel_is_built_from_and_the_tests(wheel, tmp_path):
    sdist = build("sdist", CHECKOUT, tmp_path)
    with tarfile.open(sdist) as archive:
        archive.extractall(tmp_path, filter="data")
    unpacked = tmp_path / sdist.name.removesuffix(".tar.gz")
    assert contents(build("wheel", unpacked, tmp_path / "wheel")) == contents(wheel)
    for name in ("README.md", "LICENSE", "Makefile", "constraints.txt", "tests/house/test_wheel.py"):
        assert (unpacked / name).read_bytes() == (CHECKOUT / name).read_bytes()


def test_an_editable_install_takes_the_course_from_the_checkout(tmp_path):
    assert files(build("editable", CHECKOUT, tmp_path)) == {"_tank_tutorial.pth": str(CHECKOUT).encode()}


def test_the_demo_runs(installed, program):
    running = program("demo", "--headless", "--duration", 5, environment=installed)
    assert running.ends() == 0, running.output
    assert "/Tank/joint_state" in running.output


def test_a_learners_course_has_what_its_notebooks_refer_to(installed, tmp_path):
    code = "from tutorial.paths import *; from tutorial.commands.lab import own_course; print(HOME, own_course())"
    home, course = map(Path, run("-c", code, cwd=".", **installed).split())
    assert home == tmp_path / "site" / "tutorial" / "_files"
    texts = [path.read_text("utf-8") for path in course.glob("notebooks/*.ipynb")]
    links = {link for text in texts for link in re.findall(r"\]\((\.\./[^)#]+)", text)}
    assert "../tutorial/controllers" in links
    for link in links:
        assert (course / "notebooks" / link).exists(), link
    code = "from tutorial.paths import *; print(HOME, find_project('step1'))"
    assert run("-c", code, cwd=course / "notebooks", **installed) == f"{course} {course / 'project' / 'step1.yaml'}\n"
