"""The Python that ``make install`` chooses, and its error if none is suitable. The programs on PATH are fakes."""

import shutil
import sys

import pytest
from shell import run_script, write_script

from tutorial.system.paths import HOME

TOOLS = ("chmod", "cp", "dirname", "mkdir", "mktemp", "rm")
VERSION = "import platform, sys; sys.version_info = {}, {}, 0; platform.python_version = lambda: '{}.{}.0'"
NEW, OLD = VERSION.format(3, 14, 3, 14), VERSION.format(3, 10, 3, 10)
NO_VENV = "import sys; sys.modules['ensurepip'] = None"
ARM = {"uname": "echo Linux aarch64"}
NO_UV = {"uv": "echo 'no network' >&2; exit 1"}
GIVEN = "/somewhere/python3.13"
UV = {"uv": f'[ "$*" = "python find 3.13" ] && echo {GIVEN}'}
UV_LATER = {"uv": f'case "$*" in *install*) : >"$0.done";; *) [ -e "$0.done" ] && echo {GIVEN};; esac'}

pytestmark = pytest.mark.process


def python(prelude="pass"):
    """Return a fake Python that runs a prelude before the code of `-c`, its only option."""
    return f'exec {sys.executable} -c "{prelude}; import sys; exec(sys.argv[1])" "$2"'


@pytest.fixture
def find_python(tmp_path):
    """Run .ci/find_python with the given programs on PATH. Without a fake `uname`, it sees Linux on x86-64."""

    def find(programs, *arguments, **environment):
        for name in TOOLS:
            (tmp_path / name).symlink_to(shutil.which(name))
        for name, script in {"uname": "echo Linux x86_64", **programs}.items():
            write_script(tmp_path / name, script)
        return run_script(HOME / ".ci/find_python", *arguments, PATH=str(tmp_path), TMPDIR=str(tmp_path), **environment)

    return find


@pytest.mark.parametrize(
    ("programs", "found"),
    [
        ({"python3.12": python(), "python3.11": python()}, "python3.12"),
        ({"python3": python(NEW), "python": python()}, "python"),
        ({"python3.13": python(NO_VENV), "python3.11": python()}, "python3.11"),
        ({"python3": python(NEW), **UV}, GIVEN),
        ({"python3": python(OLD), **UV_LATER}, GIVEN),
        ({"python3": python(NO_VENV), **UV}, GIVEN),
    ],
)
def test_finds(find_python, programs, found):
    done = find_python(programs)
    assert done.stdout == f"{found}\n"
    assert ("uv provides Python 3.13" in done.stderr) == (found == GIVEN)


@pytest.mark.parametrize(
    ("programs", "given", "said"),
    [
        ({"mine": python(OLD)}, "mine", "PYTHON=mine is Python 3.10.0, but the tutorial needs Python 3.11 to 3.13."),
        ({"mine": python(NEW)}, "mine", "PYTHON=mine is Python 3.14.0, "),
        ({}, "/a b/python", "PYTHON=/a b/python is not a working Python."),
        ({"mine": "exit 0"}, "mine", "PYTHON=mine is not a working Python."),
        ({"mine": python(NO_VENV)}, "mine", "PYTHON=mine has no venv or ensurepip"),
        ({"python3.13": python(), **ARM}, "", "this is Linux aarch64. Nothing was installed."),
        ({"mine": python(), **ARM}, "mine", "this is Linux aarch64"),
        ({"python3": python(NEW), **NO_UV}, "", "no network"),
        ({"python3": python(NEW), **NO_UV}, "", "Install one and run make again"),
        ({}, "", "Install one and run make again"),
    ],
)
def test_refuses(find_python, programs, given, said):
    done = find_python(programs, given)
    assert done.returncode == 1
    assert done.stdout == ""
    assert said in done.stderr


def test_bootstraps_uv(find_python, tmp_path):
    pip = f"echo '#!/bin/sh\necho {GIVEN}' >${{0%python}}uv; chmod +x ${{0%python}}uv"
    fake = f'case "$2" in venv) mkdir -p "$3/bin"; cp "$0" "$3/bin/python";; pip) {pip};; *) {python(OLD)};; esac'
    assert find_python({"python3.10": fake}).stdout == f"{GIVEN}\n"
    assert not list(tmp_path.glob("tmp*"))


def test_given_python(find_python):
    assert find_python({"my python": python()}, "my python").stdout == "my python\n"


def test_on_arm_with_ros(find_python):
    assert find_python({"python3": python(), **ARM}, ROS_DISTRO="jazzy").stdout == "python3\n"
