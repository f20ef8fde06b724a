"""The underlay prints, raises and logs what a real rclpy did."""

from __future__ import annotations

import json
import os
import re
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from domains import reserved_domain

RECORDED = json.loads((Path(__file__).parent / "data/rclpy_behaviour.json").read_text())

PLACE = re.compile(r"( \(unknown location\)| \(\S+\.py\)|(, at \S+\.c:\d+)+)$")
"""Where an error comes from, which recordings leave out: a module's file, or lines of rcl."""

# Each process runs several snippets, one after the other, because starting Python takes longer than most of them.
# `exec` stands for the fresh process of the recording: ROS 2 is shut down between snippets.
RUNNER = """
import contextlib, io, json, os, sys, tempfile
prelude, snippets = json.load(sys.stdin)

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
    with contextlib.redirect_stdout(printed), stderr_in(logged):
        import rclpy
        try:
            scope = {}
            exec(prelude, scope)
            exec(snippet, scope)
        except BaseException as error:
            raised = [type(error).__module__ + "." + type(error).__name__, str(error)]
        rclpy.try_shutdown()
        if "c" in scope and hasattr(scope["c"], "try_shutdown"):
            scope["c"].try_shutdown()
    logged.seek(0)
    results.append([printed.getvalue(), raised, logged.read()])
print(json.dumps(results))
"""


@pytest.fixture(scope="module")
def results() -> dict[int, list[Any]]:
    """What the underlay does, by the recording's row."""
    snippets = [row["code"] for row in RECORDED["rows"]]
    with reserved_domain() as domain:
        done = subprocess.run(
            [sys.executable, "-c", f"import tutorial\n{RUNNER}"],
            env=os.environ | {"ROS_DOMAIN_ID": str(domain)},
            input=json.dumps([RECORDED["prelude"], snippets]),
            capture_output=True,
            text=True,
            check=True,
            cwd=Path(__file__).parents[3],
            timeout=100,
        )
    return {row["id"]: result for row, result in zip(RECORDED["rows"], json.loads(done.stdout), strict=True)}


def test_all_that_was_recorded_is_compared() -> None:
    assert len(RECORDED["rows"]) == 85


@pytest.mark.parametrize("row", RECORDED["rows"], ids=lambda row: f"{row['about']}-{row['id']}")
def test_same_as_rclpy(row: dict[str, Any], results: dict[int, list[Any]]) -> None:
    printed, raised, logged = results[row["id"]]
    assert printed == row["printed"]
    if row["raises"] is None:
        assert raised is None
    else:
        assert raised is not None
        assert raised[0] == row["raises"]["type"]
        assert PLACE.sub("", raised[1]) == row["raises"]["text"]
    lines = [re.sub(r"\[\d+\.\d+\]", "[T]", line) for line in logged.splitlines() if re.match(r"\[[A-Z]+\] \[\d", line)]
    assert sorted(lines) == sorted(row["logged"])


@pytest.mark.embedded
def test_what_is_not_there_says_what_to_do(start: Callable[[str], subprocess.Popen[str]]) -> None:
    process = start("from rclpy.action import ActionClient")
    _, errors = process.communicate(timeout=60)
    assert "A real ROS 2 Jazzy has" in errors
