"""Links and commands in the README, the book and the notebooks: links lead somewhere, and commands are valid."""

import ast
import json
import re
import shlex
import subprocess
import sys
from contextlib import ExitStack
from itertools import dropwhile, takewhile
from pathlib import Path

import click
import pytest

from tutorial.commands.tank import tank
from tutorial.system.paths import HOME, find_drive, find_launch_file, find_model, find_project

NOTEBOOKS = sorted((HOME / "notebooks").glob("[0-9]*_*.ipynb"))
POCKET = HOME / "tutorial/ros/pocket/README.md"
PAGES = [HOME / name for name in ("README.md", "CONTRIBUTING.md", ".ci/README.md", "tests/README.md")]
PAGES += sorted({*HOME.glob("book/*.md"), *HOME.glob("tutorial/**/README.md")} - {POCKET})
FOREIGN = r"\.|bash|cd|colcon|curl|docker|export|helm|pixi|python3?|ros2|rviz2|source|sudo|uv|\.venv/bin/.*"
"""Programs that don't belong to the tutorial. For these, only files in the arguments have to exist."""
FINDERS = {"project": find_project, "step": find_launch_file, "drive": find_drive, "model": find_model}


def name(path):
    return path.relative_to(HOME).as_posix()


def read(path):
    return path.read_text(encoding="utf-8")


@pytest.mark.parametrize("page", PAGES, ids=name)
def test_commands_on_the_pages_are_valid(page, monkeypatch):
    monkeypatch.chdir(HOME)
    # click must accept paths that only the reader has
    monkeypatch.setattr(click.Path, "convert", lambda self, path, *_: self.coerce_path_result(path))
    blocks = re.findall(r"^```console\n(.*?)^```", read(page), re.MULTILINE | re.DOTALL)
    for line in re.findall(r"^\$ (.*)", "\n".join(blocks), re.MULTILINE):
        words = shlex.split(line, comments=True)
        program, *arguments = dropwhile(lambda word: re.fullmatch(r"[A-Z_]+=\S*", word), words)
        if program == "tank":
            is_understood(arguments)
        elif program == "make":
            assert re.search(rf"^{arguments[0]}:", read(HOME / "Makefile"), re.MULTILINE), line
        else:
            assert re.fullmatch(FOREIGN, program), line
        for word in arguments:
            if "/" in word and not word.startswith(("/", ".venv/")) and (HOME / Path(word).parts[0]).is_dir():
                assert (HOME / word).exists(), line


def is_understood(arguments):
    """Let the command line parse it, without running anything."""
    rest = list(takewhile(lambda word: word not in ("--ros-args", ">"), arguments))
    command, context = tank, click.Context(tank, info_name="tank")
    while isinstance(command, click.Group):
        name, command, rest = command.resolve_command(context, rest)
        context = click.Context(command, parent=context, info_name=name)
    values = command.make_context(command.name, rest, parent=context.parent).params
    for option, find in FINDERS.items():
        if values.get(option, "mine") not in ("mine", None):  # a file that the reader writes
            find(values[option])


@pytest.mark.parametrize("page", [*PAGES, *NOTEBOOKS, POCKET], ids=name)
def test_every_link_leads_somewhere(page):
    text = read(page)
    if page in NOTEBOOKS:
        cells = [cell for cell in json.loads(text)["cells"] if cell["cell_type"] == "markdown"]
        text = "\n".join("".join(cell["source"]) for cell in cells)
    prose = re.sub(r"^```.*?^```", "", text, flags=re.MULTILINE | re.DOTALL)
    for link in re.findall(r"\]\((?!https?://)([^)\s]+)\)", prose):
        target, _, anchor = link.partition("#")
        path = (page.parent / target if target else page).resolve()
        if page.parent.name == "book" and target.startswith("notebooks/"):  # the book has a copy of the notebooks
            path = HOME / target
        assert path.exists(), link
        assert not anchor or anchor in anchors(read(path)), link


def anchors(text):
    """Return the possible targets of links within a page: its headings, and the glossary's terms."""
    glossary = "".join(re.findall(r"^```\{glossary\}\n(.*?)^```", text, re.MULTILINE | re.DOTALL))
    terms = re.findall(r"^(\w.*)$", glossary, re.MULTILINE)
    headings = re.findall(r"^#+ (.+)", text, re.MULTILINE)
    slugs = {re.sub(r"[^\w\s-]", "", heading.lower()).strip().replace(" ", "-") for heading in headings}
    return slugs | {f"term-{term.replace(' ', '-')}" for term in terms}


def test_the_tables_of_steps_are_up_to_date(monkeypatch):
    monkeypatch.syspath_prepend(HOME / "book")
    from step_tables import pages

    assert {page: read(page) for page in pages()} == pages()


@pytest.mark.parametrize("page", ["README.md", "book/index.md"])
def test_the_lines_of_step_3_match_the_library(page):
    def statements(source):
        functions = [node for node in ast.walk(ast.parse(source)) if isinstance(node, ast.FunctionDef)]
        return {(function.name, ast.unparse(line)) for function in functions for line in function.body}

    (block,) = re.findall(r"^```python\n(.*?)^```", read(HOME / page), re.MULTILINE | re.DOTALL)
    assert statements(block) <= statements(read(HOME / "tutorial/controllers/joint_state_subscriber.py"))


@pytest.mark.process
def test_the_pocket_readmes_programs_hear_each_other(domain):
    programs = re.findall(r"^```python\n(.*?)^```", read(POCKET), re.MULTILINE | re.DOTALL)
    with ExitStack() as stack:
        talker, listener = (
            stack.enter_context(subprocess.Popen([sys.executable, "-c", program], stdout=subprocess.PIPE, text=True))
            for program in programs
        )
        stack.callback(talker.kill)
        stack.callback(listener.kill)
        assert listener.stdout.readline() == "I heard hello\n"
