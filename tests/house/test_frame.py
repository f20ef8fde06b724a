"""What surrounds the project: workflows, hooks and the container name what there is, and agree with each other."""

from __future__ import annotations

import json
import re
import shlex
import tomllib

import pytest
import yaml
from browser import NAMES
from test_readme import commands, has_recipe

from tutorial.paths import HOME
from tutorial.view import web

WORKFLOWS = sorted((HOME / ".github" / "workflows").glob("*.yml"))
CONTAINER = HOME / ".devcontainer" / "devcontainer.json"
MAKEFILE = (HOME / "Makefile").read_text(encoding="utf-8")

OTHERS = {".", "apt-get", "python", "python3", "source", "tank"}
"""Programs that a workflow finds on its machine, or has installed."""

PAGE = HOME / "book" / "real_ros2.md"


def read(path):
    return yaml.safe_load(path.read_text(encoding="utf-8"))


def steps(path):
    return [step for job in read(path)["jobs"].values() for step in job["steps"]]


def lines(steps):
    """What steps type: a list of words for each line, without comments."""
    typed = [line for step in steps for line in step.get("run", "").splitlines()]
    return [words for words in (shlex.split(line, comments=True) for line in typed) if words]


def python_versions():
    """Those that the project is for."""
    project = tomllib.loads((HOME / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    lowest, below = re.fullmatch(r">=3\.(\d+),<3\.(\d+)", project["requires-python"]).groups()
    return [f"3.{minor}" for minor in range(int(lowest), int(below))]


@pytest.mark.parametrize("path", WORKFLOWS, ids=lambda path: path.name)
def test_what_a_workflow_runs_is_there(path):
    typed = lines(steps(path))
    assert typed
    for program, *arguments in typed:
        if program == "make":
            has_recipe(arguments)
        elif program == "bash":
            assert (HOME / arguments[0]).is_file()
        else:
            assert program in OTHERS


@pytest.mark.parametrize("path", WORKFLOWS, ids=lambda path: path.name)
def test_a_workflow_may_do_nothing_that_it_has_no_need_of(path):
    workflow = read(path)
    assert workflow["permissions"] == {"contents": "read"}
    for job in workflow["jobs"].values():
        uses = [step.get("uses", "").partition("@")[0] for step in job["steps"]]
        needs = {"pages": "write", "id-token": "write"} if "actions/deploy-pages" in uses else None
        assert job.get("permissions") == needs
    for step in steps(path):
        if step.get("uses", "").startswith("actions/checkout@"):
            assert step["with"] == {"persist-credentials": False}


def test_every_python_is_tested_and_it_is_the_one_that_make_takes():
    job = read(HOME / ".github" / "workflows" / "test.yml")["jobs"]["test"]
    assert job["strategy"]["matrix"]["python-version"] == python_versions()
    assert job["steps"][-1]["env"]["PYTHON"] == f"${{{{ steps.{job['steps'][1]['id']}.outputs.python-path }}}}"


def test_on_a_real_ros_2_it_does_what_the_page_says():
    typed = lines(read(HOME / ".github" / "workflows" / "test.yml")["jobs"]["real-ros2"]["steps"])
    told = list(commands(PAGE))
    (packages,) = (words[3:] for words in told if words[:3] == ["sudo", "apt", "install"])
    for words in typed:
        if words[0] == "apt-get":
            assert words[1:] in (["update"], ["install", "-y", *packages])
        else:
            assert any(words[: len(each)] == each for each in told), words


def test_the_container_is_of_a_python_that_the_project_is_for_and_forwards_its_ports():
    container = json.loads(CONTAINER.read_text(encoding="utf-8"))
    image, _, tag = container["image"].partition(":")
    assert image == "mcr.microsoft.com/devcontainers/python"
    assert tag in python_versions()
    program, *arguments = container["postCreateCommand"].split()
    assert program == "make"
    has_recipe(arguments)
    views = f"{web.FIRST_PORT}-{web.FIRST_PORT + web.PORTS_TRIED - 1}"
    assert container["portsAttributes"].keys() == {"8888", views}
    assert container["forwardPorts"] == [8888, web.FIRST_PORT, web.FIRST_PORT + 1]  # the demo has two views


def test_the_hooks_do_what_make_lint_does():
    hooks = [hook for repository in read(HOME / ".pre-commit-config.yaml")["repos"] for hook in repository["hooks"]]
    entries = {
        hook["entry"].replace(" --fix", "").replace(".venv/bin", "$(BIN)").removeprefix("env ") for hook in hooks
    }
    (recipe,) = re.findall(r"^lint:.*\n((?:\t.*\n)+)", MAKEFILE, re.MULTILINE)
    checks = {re.sub(r" (--check|\.github/\S+|\.)(?= |$)", "", line.strip()) for line in recipe.splitlines()}
    assert entries == checks


def test_ci_installs_no_browser_where_the_tests_find_one():
    words = re.findall(r"\w+(?:-\w+)*", (HOME / ".ci" / "run").read_text(encoding="utf-8"))
    assert set(NAMES) <= set(words)
