"""What is installed from a wheel: it has all that is needed, and works where there is no checkout."""

from __future__ import annotations

import os
import re
import subprocess
import sys
import tarfile
import zipfile
from ast import literal_eval
from pathlib import Path

import pytest
from programs import answer

from tutorial.paths import PACKAGE

CHECKOUT = PACKAGE.parent
COURSE = ("launch_py", "notebooks", "project")
PAGES = tuple(
    f"book/{name}.md" for name in ("bags", "comparison", "fleet", "glossary", "own_package", "teaching", "tools")
)
JUNK = {"__pycache__", ".ipynb_checkpoints", "MUJOCO_LOG.TXT"}
LINK = re.compile(r"\]\((\.\.?/[^)#]+)")
NO_OTHER = """
import sys
from pathlib import Path
sys.path[:] = [entry for entry in sys.path if entry == {site!r} or not (Path(entry) / "tutorial/__init__.py").exists()]
"""


def build(kind, source, target):
    """Build one distribution, and return its file."""
    command = [sys.executable, "-m", "hatchling", "build", "-t", kind, "-d", str(target)]
    result = subprocess.run(command, cwd=source, capture_output=True, text=True, check=False)
    assert result.returncode == 0, result.stderr
    (built,) = target.iterdir()
    return built


@pytest.fixture(scope="module")
def wheel(tmp_path_factory):
    return build("wheel", CHECKOUT, tmp_path_factory.mktemp("wheel"))


@pytest.fixture(scope="module")
def site(wheel, tmp_path_factory):
    """A folder that the wheel is unpacked into, as pip does."""
    folder = tmp_path_factory.mktemp("site")
    with zipfile.ZipFile(wheel) as archive:
        archive.extractall(folder)
    return folder


@pytest.fixture
def installed(site, tmp_path, monkeypatch, domain):
    """The environment of a process that finds the wheel's tutorial, and is started where there is no checkout."""
    here, without = tmp_path / "here", tmp_path / "without_checkout"
    here.mkdir()
    without.mkdir()
    (without / "sitecustomize.py").write_text(NO_OTHER.format(site=str(site)))
    monkeypatch.chdir(here)
    return {"PYTHONPATH": f"{site}{os.pathsep}{without}"}


def contents(wheel):
    """Name the files in a wheel, and say what they hold."""
    with zipfile.ZipFile(wheel) as archive:
        return {name: archive.read(name) for name in archive.namelist()}


def files_of(folder):
    """Find the files of a folder that are made by people."""
    return [path for path in (CHECKOUT / folder).rglob("*") if path.is_file() and not JUNK & set(path.parts)]


def names_in(folder):
    return {path for path in folder.rglob("*") if "__pycache__" not in path.parts}


def run(code, environment, folder=None):
    """Run some lines of Python where the wheel is installed, and return what they print."""
    command = [sys.executable, "-c", code]
    return subprocess.run(
        command, env={**os.environ, **environment}, cwd=folder, capture_output=True, text=True, check=True
    ).stdout.strip()


def test_it_holds_the_package_and_the_course_and_nothing_else(wheel):
    expected = {path.relative_to(CHECKOUT).as_posix(): path.read_bytes() for path in files_of("tutorial")}
    for path in [*(path for part in COURSE for path in files_of(part)), *(CHECKOUT / page for page in PAGES)]:
        expected[f"tutorial/_files/{path.relative_to(CHECKOUT).as_posix()}"] = path.read_bytes()
    found = {name: data for name, data in contents(wheel).items() if ".dist-info/" not in name}
    assert found.keys() == expected.keys()
    assert found == expected


def test_the_sdist_has_what_the_wheel_is_built_from_and_the_tests(wheel, tmp_path):
    sdist = build("sdist", CHECKOUT, tmp_path / "sdist")
    with tarfile.open(sdist) as archive:
        archive.extractall(tmp_path, filter="data")
    unpacked = tmp_path / sdist.name.removesuffix(".tar.gz")
    again = build("wheel", unpacked, tmp_path / "wheel")
    assert contents(again) == contents(wheel)
    for name in ("README.md", "LICENSE", "Makefile", "constraints.txt", "tests/house/test_wheel.py"):
        assert (unpacked / name).read_bytes() == (CHECKOUT / name).read_bytes()


def test_an_editable_install_takes_the_course_from_the_checkout(tmp_path):
    code = "import sys; from hatchling.build import build_editable; build_editable(sys.argv[1])"
    subprocess.run([sys.executable, "-c", code, tmp_path], cwd=CHECKOUT, check=True)
    (built,) = tmp_path.iterdir()
    found = {name: data for name, data in contents(built).items() if ".dist-info/" not in name}
    assert found == {"_tank_tutorial.pth": str(CHECKOUT).encode()}


def test_its_files_are_found_within_the_package(installed, site):
    code = (
        "import sys; from tutorial.paths import *; print(HOME, find_drive('tour'), find_launch_file('step3'), sys.path)"
    )
    course = site / "tutorial" / "_files"
    home, drive, launch_file, path = run(code, installed).split(maxsplit=3)
    assert (home, drive) == (str(course), str(course / "project" / "drives" / "tour.yaml"))
    assert launch_file == str(course / "launch_py" / "step3.launch.py")
    assert str(CHECKOUT) not in literal_eval(path)


def test_the_demo_runs(installed, program):
    running = program("demo", "--headless", "--duration", 5, environment=installed)
    assert running.ends() == 0, running.output
    assert "/Tank/joint_state" in running.output


def test_the_lab_opens_a_course_of_the_learners_own(installed, site, program, tmp_path):
    folders = {f"JUPYTER_{name}_DIR": str(tmp_path / name) for name in ("CONFIG", "DATA", "RUNTIME")}
    folders["JUPYTERLAB_WORKSPACES_DIR"] = str(tmp_path / "workspaces")
    before = names_in(site)
    running = program("lab", "--", "--no-browser", "--ServerApp.port=0", environment={**installed, **folders})
    running.says("http://127.0.0.1:")
    course = Path.cwd() / "tank-tutorial"
    assert f"the course is now in {course}" in running.output
    address = re.search(r"http://127\.0\.0\.1:\S+", running.output).group()
    with answer(address) as page:
        assert page.status == 200
        assert "/lab/tree/notebooks/0_setup.ipynb" in page.url  # and not the page that asks for the token
    with answer(address.replace("/lab/tree/", "/files/")) as file:
        assert file.read() == (course / "notebooks" / "0_setup.ipynb").read_bytes()
    running.process.terminate()
    running.ends()
    running.leaves_nothing()
    assert names_in(site) == before


def test_a_learners_course_has_what_its_notebooks_refer_to(installed):
    course = Path(run("from tutorial.commands.lab import own_course; print(own_course())", installed))
    links = {link for path in course.glob("notebooks/*.ipynb") for link in LINK.findall(path.read_text("utf-8"))}
    assert "../tutorial/controllers" in links
    for link in links:
        assert (course / "notebooks" / link).exists(), link
    code = "from tutorial.paths import *; print(HOME, find_project('step1'))"
    assert run(code, installed, course / "notebooks") == f"{course} {course / 'project' / 'step1.yaml'}"
