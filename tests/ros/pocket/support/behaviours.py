"""Snippets of rclpy programs: their files, how to run them, and which parts of the outcome are compared."""

import ast
import gc
import json
import os
import re
import subprocess
import sys
import warnings
from collections.abc import Iterator, Sequence
from contextlib import contextmanager, redirect_stderr, redirect_stdout
from io import StringIO
from pathlib import Path
from tempfile import TemporaryFile
from typing import IO, Any
from unittest.mock import patch

from domains import reserved_domain

FOLDER = Path(__file__).parents[1] / "behaviours"
"""Snippets that log, or are more than an expression. A file is a topic, a cell (``# %% what it shows``) a behaviour.
``prelude.py`` comes before each of them, and so does the code above the file's first cell."""

RECORD = FOLDER.parent / "data/more_rclpy_behaviour.json"
"""The results of the real rclpy; written by record_behaviours.py."""

OLDER_RECORD = FOLDER.parent / "data/rclpy_behaviour.json"
"""Older snippets, with the results of the real rclpy."""

EXPRESSIONS = FOLDER.parent / "data/rclpy_expressions.json"
"""Expressions with the results of the real rclpy, in groups that share their first lines."""

NEWER = FOLDER.parent / "data/rclpy_newer.json"
"""Expressions with a different result in a later patch release of Jazzy, because of its message generator."""

TIME = re.compile(r"\[\d+\.\d+\]")
LOG_LINE = re.compile(r"\[[A-Z]+\] \[\d")
PLACE = re.compile(r"( \(unknown location\)| \(\S+\.py\)|(, at \S+\.c:\d+)+)$")
"""The origin of an error, which recordings leave out: a module's file, or lines of rcl."""


@contextmanager
def stderr_in(file: IO[str]) -> Iterator[None]:
    """Redirect stderr to a file, even what C code writes there, as the real rclpy does."""
    kept = os.dup(2)
    os.dup2(file.fileno(), 2)
    try:
        with redirect_stderr(file):
            yield
    finally:
        os.dup2(kept, 2)
        os.close(kept)


def snippets(group: dict[str, Any]) -> list[str]:
    """Return a group's expressions as snippets that print values or exceptions; a tuple prints several values."""
    made = []
    for code in group["expressions"]:
        several = isinstance(ast.parse(code, mode="eval").body, ast.Tuple)
        shown = f"' | '.join(map(str, ({code})))" if several else code
        made.append("\n".join([*group["setup"], f"attempt(lambda: {shown})"]))
    return made


def outcome(prelude: str, snippet: str) -> dict[str, Any]:
    """Run a snippet, shut ROS 2 down, and return what the snippet printed, raised and logged.

    Leave out everything that differs from run to run: source locations, times of log lines, and their order.
    """
    import rclpy

    scope: dict[str, Any] = {}
    raises, printed = None, StringIO()
    with (
        TemporaryFile("w+") as logged,
        redirect_stdout(printed),
        stderr_in(logged),
        patch.dict(os.environ),
        warnings.catch_warnings(),
    ):
        warnings.simplefilter("default")
        try:
            exec(prelude, scope)
            exec(snippet, scope)
        except BaseException as error:  # noqa: BLE001
            place = f"{type(error).__module__}.{type(error).__name__}"
            raises = {"type": place, "text": PLACE.sub("", str(error))}
        rclpy.try_shutdown()
        for context in [value for value in scope.values() if isinstance(value, rclpy.Context)]:
            context.try_shutdown()
        scope.clear()
        gc.collect()  # in rclpy a shutdown alone leaves nodes in the graph, where the next snippet may see them
        logged.flush()
        logged.seek(0)
        lines = [TIME.sub("[T]", line) for line in logged.read().splitlines() if LOG_LINE.match(line)]
    return {"printed": printed.getvalue(), "raises": raises, "logged": sorted(lines)}


def prelude() -> str:
    """Return the code that comes before each behaviour in this folder."""
    return (FOLDER / "prelude.py").read_text(encoding="utf-8")


def behaviours() -> Iterator[tuple[str, str, str]]:
    """Yield every behaviour in this folder: its topic, what it shows, and its code."""
    for file in sorted(FOLDER.glob("*.py")):
        opening, *cells = file.read_text(encoding="utf-8").split("# %% ")
        for cell in cells:
            title, _, code = cell.partition("\n")
            yield file.stem, title, (opening.strip() + "\n" + code.strip()).strip()


def recorded() -> list[dict[str, Any]]:
    """Return a row for each snippet that the real rclpy has run: its prelude, its code, and its outcome."""
    older = json.loads(OLDER_RECORD.read_text(encoding="utf-8"))
    rows = [row | {"prelude": older["prelude"]} for row in older["rows"]]
    codes = {(about, shows): code for about, shows, code in behaviours()}
    for row in json.loads(RECORD.read_text(encoding="utf-8"))["rows"]:
        rows.append(row | {"prelude": prelude(), "code": codes.get((row["about"], row["shows"]), "")})
    for group in json.loads(EXPRESSIONS.read_text(encoding="utf-8"))["groups"]:
        for (code, printed), snippet in zip(group["expressions"].items(), snippets(group), strict=True):
            row = {"about": group["about"], "shows": code, "printed": f"{printed}\n"}
            rows.append(row | {"prelude": prelude(), "code": snippet})
    return rows


def outcomes(prelude: str, snippets: Sequence[str]) -> list[dict[str, Any]]:
    """Run snippets one after another in a separate process and domain."""
    with reserved_domain() as domain:
        done = subprocess.run(
            [sys.executable, __file__],
            env=os.environ | {"ROS_DOMAIN_ID": str(domain), "PYTHONPATH": os.pathsep.join(sys.path)},
            input=json.dumps([prelude, snippets]),
            capture_output=True,
            text=True,
            check=True,
            timeout=500,
        )
    found: list[dict[str, Any]] = json.loads(done.stdout)
    return found


if __name__ == "__main__":
    import pocket_ros2  # noqa: F401

    given, several = json.load(sys.stdin)
    print(json.dumps([outcome(given, snippet) for snippet in several]))
