"""What the README and the pages around it tell a reader to type, to click and to look up: all of it is there."""

from __future__ import annotations

import ast
import json
import re
import shlex
import shutil
import subprocess
import sys
import tomllib
from functools import cache
from itertools import dropwhile, takewhile
from pathlib import Path

import click
import pytest
from PIL import Image
from steps import BESIDE

from tutorial.commands.tank import tank
from tutorial.paths import HOME, find_drive, find_launch_file, find_model, find_project

NOTEBOOKS = sorted((HOME / "notebooks").glob("[0-9]_*.ipynb"))
PAGES = [HOME / "README.md", HOME / "CONTRIBUTING.md", *sorted((HOME / "book").glob("*.md"))]

FOREIGN = {".", "bash", "cd", "colcon", "export", "pixi", "python", "python3", "ros2", "rviz2", "source", "sudo"}
"""Programs that are not the tutorial's: of their commands only the files that they name are looked for."""

READERS_OWN = "mine"
"""How a file is called that the reader is asked to write."""

STEPS = {
    "notebook": "notebooks/[0-9]_*.ipynb",
    "controller": "tutorial/controllers/[a-z]*.py",
    "check": "tutorial/checks/[a-z]*.py",
    "project": "project/step*.yaml",
    "launch file": "launch_py/step*.launch.py",
}
"""What a step consists of, by the column of the tables."""

NO_STEPS = {f"tutorial/checks/{name}.py" for name in ("catalogue", "exercise", "overview", "progress")}
NO_STEPS |= {f"tutorial/controllers/{name}.py" for name in BESIDE}
"""What all exercises have in common, and what no notebook builds."""

TABLES = [
    *(("README.md", column, STEPS[column]) for column in ("notebook", "controller", "project", "launch file")),
    *(("CONTRIBUTING.md", column, STEPS[column]) for column in STEPS),
    ("book/index.md", "step", STEPS["notebook"]),
]


def commands(page):
    """What stands behind a ``$`` in a page's console blocks: a list of words for each, without comments."""
    for block in re.findall(r"^```console\n(.*?)^```", page.read_text(encoding="utf-8"), re.MULTILINE | re.DOTALL):
        for line in block.splitlines():
            if line.startswith("$ "):
                words = shlex.split(line.removeprefix("$ "), comments=True)
                yield list(dropwhile(lambda word: re.fullmatch(r"[A-Z_]+=\S*", word), words))


def each_command():
    found = {(page.name, shlex.join(words)): words for page in PAGES for words in commands(page) if words}
    return [pytest.param(words, id=f"{name}: {text}") for (name, text), words in found.items()]


@pytest.mark.parametrize("words", each_command())
def test_a_command_that_the_reader_is_told_to_type_works(words, monkeypatch):
    monkeypatch.chdir(HOME)
    program, *arguments = words
    if program == "tank":
        is_understood(arguments)
    elif program == "make":
        has_recipe(arguments)
    elif program.startswith(".venv/bin/"):
        assert Path(program).name in {requirement for extra in extras().values() for requirement in extra}
    else:
        assert program in FOREIGN, f"{program!r} is no command of the tutorial's. If it is another's, add it to FOREIGN"
    if arguments[:3] == ["-m", "pip", "install"]:
        is_installable(arguments[3:])
    for word in arguments:
        if "/" in word and not word.startswith(("/", ".venv/")) and (HOME / Path(word).parts[0]).is_dir():
            assert (HOME / word).exists(), word


def is_understood(arguments):
    """Have the command line parse it, and run nothing."""
    rest = list(takewhile(lambda word: word not in ("--ros-args", ">"), arguments))
    command, context = tank, click.Context(tank, info_name="tank")
    while isinstance(command, click.Group):
        name, command, rest = command.resolve_command(context, rest)
        context = click.Context(command, parent=context, info_name=name)
    values = command.make_context(command.name, rest, parent=context.parent).params
    for option, find in (
        ("project", find_project),
        ("step", find_launch_file),
        ("drive", find_drive),
        ("model", find_model),
    ):
        if values.get(option, READERS_OWN) not in (READERS_OWN, None):
            find(values[option])


def has_recipe(arguments):
    """Have make say what it would do, and do nothing."""
    done = subprocess.run(
        ["make", "-n", f"PYTHON={sys.executable}", *arguments], cwd=HOME, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr
    assert done.stdout


def is_installable(arguments):
    """The extras that are asked for are those that the project has."""
    asked = re.findall(r"\.\[(.+)\]", " ".join(arguments))
    assert asked
    assert set(asked[0].split(",")) <= set(extras())


def extras():
    """The names of the packages of every extra."""
    project = tomllib.loads((HOME / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    return {
        extra: [re.match(r"[\w-]+", requirement)[0] for requirement in requirements]
        for extra, requirements in project["optional-dependencies"].items()
    }


def prose(page):
    """A page without its blocks of code; of a notebook, its words."""
    text = page.read_text(encoding="utf-8")
    if page.suffix == ".ipynb":
        cells = json.loads(text)["cells"]
        text = "\n".join("".join(cell["source"]) for cell in cells if cell["cell_type"] == "markdown")
    return re.sub(r"^```.*?^```", "", text, flags=re.MULTILINE | re.DOTALL)


@pytest.mark.parametrize("page", [*PAGES, *NOTEBOOKS], ids=lambda page: page.name)
def test_every_link_leads_somewhere(page):
    for link in re.findall(r"\]\((?!https?://)([^)\s]+)\)", prose(page)):
        target, _, anchor = link.partition("#")
        path = (page.parent / target if target else page).resolve()
        if page.parent.name == "book" and target.startswith("notebooks/"):  # the book has a copy of them
            path = HOME / target
        assert path.exists(), link
        assert not anchor or anchor in anchors(path), f"{link}: there are {sorted(anchors(path))}"


@cache
def anchors(page):
    """What a link can lead to within a page: its headings, and the terms of the glossary."""
    text = page.read_text(encoding="utf-8")
    headings = re.findall(r"^#+ (.+)", text, re.MULTILINE)
    slugs = {re.sub(r"[^\w\s-]", "", heading.lower()).strip().replace(" ", "-") for heading in headings}
    return slugs | {f"term-{term.replace(' ', '-')}" for term in terms(text)}


def terms(text):
    """What a glossary explains."""
    glossary = "".join(re.findall(r"^```\{glossary\}\n(.*?)^```", text, re.MULTILINE | re.DOTALL))
    return re.findall(r"^(\w.*)$", glossary, re.MULTILINE)


def test_the_glossary_explains_every_term_once():
    words = terms((HOME / "book" / "glossary.md").read_text(encoding="utf-8"))
    assert len(words) > 30
    assert len(words) == len({word.lower() for word in words})


def test_the_picture_at_the_top_moves_and_is_soon_there():
    top = (HOME / "README.md").read_text(encoding="utf-8").partition("```")[0]
    (path,) = re.findall(r"^!\[[^]]{40,}\]\((.+)\)$", top, re.MULTILINE)  # with a text for those who don't see it
    with Image.open(HOME / path) as picture:
        assert picture.n_frames > 1
        assert picture.info["loop"] == 0, "it stops"
        assert 800 <= picture.width <= 1000
    assert (HOME / path).stat().st_size < 1_500_000


def steps(page):
    """The rows of a page's table of steps: by column, what is in the cell."""
    table = re.search(r"^\| step \|.*\n\|[-|]+\n(?:\|.*\n)+", (HOME / page).read_text(encoding="utf-8"), re.MULTILINE)
    assert table, f"{page} has no table of steps"
    head, _, *rows = ([cell.strip() for cell in line.strip("|").split("|")] for line in table[0].splitlines())
    return [dict(zip(head, row, strict=True)) for row in rows]


def links(cell):
    """What a cell of a table links to, one thing or several, each with the words of the link."""
    found = [re.fullmatch(r"\[`?(.+?)`?\]\((.+)\)", link) for link in cell.split(", ") if link]
    return [(link[2], link[1]) for link in found]


def linked(cell):
    """What a cell of a table links to first, and the words of the link."""
    return next(iter(links(cell)), (None, None))


def committed(pattern):
    """The files that the course has, so that a learner's own may lie beside them: those that git knows."""
    found = {path.relative_to(HOME).as_posix() for path in HOME.glob(pattern)}
    if shutil.which("git") is None:
        return found
    listing = subprocess.run(["git", "ls-files"], cwd=HOME, capture_output=True, text=True, check=False)
    return found & set(listing.stdout.splitlines()) if listing.stdout else found


@pytest.mark.parametrize(("page", "column", "pattern"), TABLES)
def test_the_tables_of_steps_have_all_files_and_no_others(page, column, pattern):
    named = [target for row in steps(page) for target, _ in links(row[column])]
    assert len(named) == len(set(named))
    assert committed(pattern) - NO_STEPS <= set(named)
    assert set(named) <= {path.relative_to(HOME).as_posix() for path in HOME.glob(pattern)}


@pytest.mark.parametrize("page", ["README.md", "CONTRIBUTING.md"])
def test_each_row_is_of_one_step(page):
    for number, row in enumerate(steps(page)):
        assert row["step"] == str(number)
        for column in STEPS.keys() & row.keys():
            for target, words in links(row[column]):
                assert words in (Path(target).name, Path(target).stem)
        name = linked(row["notebook"])[1].removeprefix(f"{number}_")
        for column, begins in (("controller", name), ("project", f"step{number}"), ("launch file", f"step{number}")):
            for _, words in links(row[column]):
                assert re.fullmatch(rf"{begins}(_\w+)?", words.partition(".")[0]), "a step may have two, of its name"
        others = [row[column] for column in STEPS.keys() & row.keys() - {"notebook"}]
        assert all(others) if number else not any(others), "step 0 builds nothing, the others have all files"


def test_a_steps_topic_is_its_controllers():
    shown = {row["step"].split("]")[0].removeprefix("[Step "): row["topic"] for row in steps("book/index.md")}
    for row in steps("README.md"):
        assert shown[row["step"]] == row["topic"]
        if row["topic"]:
            source = (HOME / linked(row["controller"])[0]).read_text(encoding="utf-8")
            assert f'{row["topic"].strip("`").rsplit("/")[-1]}"' in source, row["topic"]


@pytest.mark.parametrize("page", ["README.md", "book/index.md"])
def test_the_lines_of_step_3_are_the_librarys(page):
    (block,) = re.findall(r"^```python\n(.*?)^```", (HOME / page).read_text(encoding="utf-8"), re.MULTILINE | re.DOTALL)
    library = functions((HOME / "tutorial" / "controllers" / "joint_state_subscriber.py").read_text(encoding="utf-8"))
    shown = functions(block)
    assert len(shown) == 2
    assert shown == {name: library[name] for name in shown}


def functions(source):
    """By name, the arguments and statements of all functions, without docstrings and annotations."""
    found = {}
    for node in ast.walk(ast.parse(source)):
        if isinstance(node, ast.FunctionDef):
            body = node.body[1:] if ast.get_docstring(node) else node.body
            found[node.name] = [argument.arg for argument in node.args.args], [ast.unparse(each) for each in body]
    return found
