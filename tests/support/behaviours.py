"""Snippets of rclpy programs: where they are kept, how they are run, and what of their outcome is compared."""

from __future__ import annotations

import json
import os
import re
import subprocess
import sys
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

from domains import reserved_domain

FOLDER = Path(__file__).parents[1] / "ros/underlay/behaviours"
"""One file a theme, one cell (``# %% what it shows``) a behaviour; ``prelude.py`` comes before each."""

RECORD = FOLDER.parent / "data/more_rclpy_behaviour.json"
"""What a real rclpy did with them; made by record_behaviours.py."""

TIME = re.compile(r"\[\d+\.\d+\]")
LOG_LINE = re.compile(r"\[[A-Z]+\] \[\d")
PLACE = re.compile(r"( \(unknown location\)| \(\S+\.py\)|(, at \S+\.c:\d+)+)$")
"""Where an error comes from, which recordings leave out: a module's file, or lines of rcl."""

# A process may run several snippets, one after the other, because starting Python takes longer than most of them.
# `exec` stands for the fresh process of the recording: ROS 2 is shut down between snippets.
RUNNER = """
import tutorial
import contextlib, gc, io, json, os, rclpy, sys, tempfile
prelude, snippets = json.load(sys.stdin)
exec(prelude, {})
gc.freeze()  # what is there now is not looked at again

@contextlib.contextmanager
def stderr_in(file):
    # also what C writes there, as a real rclpy does
    sys.stderr.flush()
    kept = os.dup(2)
    os.dup2(file.fileno(), 2)
    try:
        yield
    finally:
        sys.stderr.flush()
        os.dup2(kept, 2)
        os.close(kept)

results = []
for snippet in snippets:
    printed, logged, raised = io.StringIO(), tempfile.TemporaryFile("w+"), None
    scope = {}
    with contextlib.redirect_stdout(printed), stderr_in(logged):
        try:
            exec(prelude, scope)
            exec(snippet, scope)
        except BaseException as error:
            raised = [type(error).__module__ + "." + type(error).__name__, str(error)]
        rclpy.try_shutdown()
        for context in [value for value in scope.values() if isinstance(value, rclpy.Context)]:
            context.try_shutdown()
        scope.clear()
        gc.collect()  # in rclpy a shutdown alone leaves nodes in the graph, where the next snippet may see them
    logged.seek(0)
    results.append([printed.getvalue(), raised, logged.read()])
print(json.dumps(results))
"""


def prelude() -> str:
    """What comes before each behaviour of this folder."""
    return (FOLDER / "prelude.py").read_text(encoding="utf-8")


def behaviours() -> Iterator[tuple[str, str, str]]:
    """Every behaviour of this folder: its theme, what it shows, and its code."""
    for file in sorted(FOLDER.glob("*.py")):
        for cell in file.read_text(encoding="utf-8").split("# %% ")[1:]:
            title, _, code = cell.partition("\n")
            yield file.stem, title, code.strip()


def outcomes(prelude: str, snippets: Sequence[str]) -> list[dict[str, Any]]:
    """Run snippets in one process, in a domain of its own, and return of each what it printed, raised and logged."""
    with reserved_domain() as domain:
        done = subprocess.run(
            [sys.executable, "-c", RUNNER],
            env=os.environ | {"ROS_DOMAIN_ID": str(domain)},
            input=json.dumps([prelude, snippets]),
            capture_output=True,
            text=True,
            check=True,
            cwd=Path(__file__).parents[2],
            timeout=100,
        )
    return [_comparable(*outcome) for outcome in json.loads(done.stdout)]


def _comparable(printed: str, raised: list[str] | None, stderr: str) -> dict[str, Any]:
    """Leave out what differs from run to run: places in files, times of log lines, and their order."""
    raises = raised and {"type": raised[0], "text": PLACE.sub("", raised[1])}
    logged = sorted(TIME.sub("[T]", line) for line in stderr.splitlines() if LOG_LINE.match(line))
    return {"printed": printed, "raises": raises, "logged": logged}
