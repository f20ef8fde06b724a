"""``make install`` uses uv, and pip if uv fails. Both are fakes here."""

import shutil

import pytest
from shell import run_script, write_script

from tutorial.system.paths import HOME

pytestmark = pytest.mark.process


@pytest.fixture
def install(tmp_path):
    """Run .ci/install in a folder where uv exits with a status; return the result and the calls."""
    for folder in (".ci", ".venv/bin"):
        (tmp_path / folder).mkdir(parents=True)
    shutil.copy(HOME / ".ci/install", tmp_path / ".ci")
    calls = tmp_path / "calls"

    def call(status, **environment):
        write_script(tmp_path / ".venv/bin/python", f'echo "$@" >>{calls}; [ "$4" = config ] && echo "$INDEX"; true')
        write_script(tmp_path / ".venv/bin/uv", f'echo "uv $UV_DEFAULT_INDEX $@" >>{calls}; exit {status}')
        done = run_script(tmp_path / ".ci/install", "test", PATH="/usr/bin:/bin", **environment)
        return done, [line for line in calls.read_text().splitlines() if "config" not in line]

    return call


def test_uv_installs(install):
    done, (uv, editable) = install(0)
    assert (done.returncode, done.stderr) == (0, "")
    assert uv.endswith("-c constraints.txt uv")
    assert editable == "uv  pip install -q --python .venv -c constraints.txt -e .[test] -e tutorial/ros/pocket"


def test_pip_is_the_fallback(install):
    done, (*_, uv, pip) = install(1)
    assert (done.returncode, done.stderr.count("\n")) == (0, 1)
    assert "Trying again with pip" in done.stderr
    assert pip.startswith("-m pip")
    assert pip.split(" -c ")[1] == uv.split(" -c ")[1]


@pytest.mark.parametrize("variable", ["INDEX", "PIP_INDEX_URL", "UV_DEFAULT_INDEX"])
def test_uv_uses_pips_mirror(install, variable):
    _, (_, uv) = install(0, **{variable: "file:///mirror"})
    assert uv.startswith("uv file:///mirror pip")
