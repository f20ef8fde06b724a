"""The installed wheels are complete, and work without a checkout."""

import os
import re
import tarfile
import zipfile
from pathlib import Path

import pytest
from packages import run

from tutorial.system.paths import PACKAGE

CHECKOUT = PACKAGE.parent
POCKET = PACKAGE / "ros/pocket"
COURSE = ("launch_py", "notebooks", "project")
PAGES = (
    *("bags", "comparison", "fleet", "glossary", "nothing_arrives", "own_interfaces", "own_package", "real_ros2"),
    *("teaching", "tools"),
)
JUNK = {"__pycache__", ".ipynb_checkpoints", "MUJOCO_LOG.TXT"}
NO_OTHER = """
import sys
from pathlib import Path
checkout = {{entry for entry in sys.path for name in ("tutorial", "pocket_ros2") if (Path(entry) / name).is_dir()}}
sys.path[:] = [entry for entry in sys.path if entry == {site!r} or entry not in checkout]
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


@pytest.fixture(scope="module")
def pocket_wheel(tmp_path_factory):
    return build("wheel", POCKET, tmp_path_factory.mktemp("pocket_wheel"))


@pytest.fixture
def installed(wheel, pocket_wheel, tmp_path, monkeypatch, domain):
    """The environment of a process that has only the installed wheels, and starts outside the checkout."""
    here, site, without = (tmp_path / name for name in ("here", "site", "without_checkout"))
    here.mkdir()
    without.mkdir()
    for each in (wheel, pocket_wheel):
        with zipfile.ZipFile(each) as archive:
            archive.extractall(site)
    (without / "sitecustomize.py").write_text(NO_OTHER.format(site=str(site)))
    monkeypatch.chdir(here)
    return {"PYTHONPATH": f"{site}{os.pathsep}{without}"}


def contents(wheel):
    """Return the contents of a wheel's files by name."""
    with zipfile.ZipFile(wheel) as archive:
        return {name: archive.read(name) for name in archive.namelist()}


def files(wheel):
    """Return the contents of a wheel without its metadata."""
    return {name: data for name, data in contents(wheel).items() if ".dist-info/" not in name}


def checked_out(folder, *parts):
    """Return the contents of files in a checkout by name."""
    paths = [path for part in parts for path in (folder / part, *(folder / part).rglob("*"))]
    wanted = [path for path in paths if path.is_file() and not JUNK & set(path.parts)]
    return {path.relative_to(folder).as_posix(): path.read_bytes() for path in wanted}


def test_it_holds_exactly_the_package_and_the_course(wheel):
    course = checked_out(CHECKOUT, *COURSE, *(f"book/{page}.md" for page in PAGES))
    expected = {f"tutorial/_files/{name}": data for name, data in course.items()}
    package = checked_out(CHECKOUT, "tutorial")
    expected |= {name: data for name, data in package.items() if not name.startswith("tutorial/ros/pocket/")}
    found = files(wheel)
    assert found.keys() == expected.keys()
    assert found == expected


def test_the_pocket_ros_2_has_its_own_wheel(pocket_wheel):
    assert files(pocket_wheel) == checked_out(POCKET, "pocket_ros2")


@pytest.mark.parametrize(
    ("source", "names"),
    [
        (CHECKOUT, ["README.md", "LICENSE", "Makefile", "constraints.txt", "tests/house/test_wheel.py"]),
        (POCKET, ["README.md", "LICENSE", "CHANGELOG.md"]),
    ],
    ids=["tutorial", "pocket"],
)
def test_the_sdist_can_build_the_wheel_and_has_the_tests(source, names, tmp_path):
    sdist = build("sdist", source, tmp_path)
    with tarfile.open(sdist) as archive:
        archive.extractall(tmp_path, filter="data")
    unpacked = tmp_path / sdist.name.removesuffix(".tar.gz")
    assert contents(build("wheel", unpacked, tmp_path / "wheel")) == contents(build("wheel", source, tmp_path))
    for name in names:
        assert (unpacked / name).read_bytes() == (source / name).read_bytes()
    assert list(unpacked.glob("tests/**/test_*.py"))


def test_the_demo_runs(installed, program):
    running = program("demo", "--headless", "--duration", 5, environment=installed)
    assert running.ends() == 0, running.output
    assert "/Tank/joint_state" in running.output


def test_an_installed_course_has_the_files_that_it_links_to(installed, tmp_path):
    code = "from tutorial.commands.lab import HOME, own_course; print(HOME, own_course())"
    home, course = map(Path, run("-c", code, cwd=".", **installed).split())
    assert home == tmp_path / "site" / "tutorial" / "_files"
    texts = [path.read_text("utf-8") for path in course.glob("notebooks/*.ipynb")]
    links = {link for text in texts for link in re.findall(r"\]\(((?:\.\./|images/)[^)#]+)", text)}
    assert {"../tutorial/controllers", "images/frames.svg"} < links
    for link in links:
        assert (course / "notebooks" / link).exists(), link
