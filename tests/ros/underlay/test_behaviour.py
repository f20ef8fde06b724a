"""The underlay prints, raises and logs what a real rclpy did."""

from __future__ import annotations

import json
import subprocess
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from behaviours import RECORD, behaviours, outcomes, prelude

RECORDS = [json.loads(file.read_text()) for file in (Path(__file__).parent / "data/rclpy_behaviour.json", RECORD)]
ROWS = [row for record in RECORDS for row in record["rows"]]


@pytest.fixture(scope="module")
def seen(backend: str) -> dict[int, dict[str, Any]]:
    """What this ROS 2 does, by the row's id.

    A real one's graph lags behind, and some of the first snippets do not wait for it: what differs there is run again,
    up to five times, in a process of its own, as it was recorded.
    """
    results: dict[int, dict[str, Any]] = {}
    for record in RECORDS:
        done = outcomes(record["prelude"], [row["code"] for row in record["rows"]])
        for row, outcome in zip(record["rows"], done, strict=True):
            results[row["id"]] = outcome
            for _ in range(5 if backend == "rclpy" else 0):
                if results[row["id"]] != expected(row):
                    (results[row["id"]],) = outcomes(record["prelude"], [row["code"]])
    return results


def expected(row: dict[str, Any]) -> dict[str, Any]:
    """What a row has of the outcome; the order of log lines is left out."""
    return {"printed": row["printed"], "raises": row["raises"], "logged": sorted(row["logged"])}


def test_all_that_was_recorded_is_compared() -> None:
    assert len(RECORDS[0]["rows"]) == 85


def test_the_record_is_of_these_snippets() -> None:
    record = RECORDS[1]
    recorded = [(row["about"], row["shows"], row["code"]) for row in record["rows"]]
    assert (record["prelude"], recorded) == (prelude(), list(behaviours())), "run tests/support/record_behaviours.py"


@pytest.mark.parametrize("row", ROWS, ids=lambda row: f"{row['about']}-{row.get('shows', row['id'])}")
def test_same_as_rclpy(row: dict[str, Any], seen: dict[int, dict[str, Any]]) -> None:
    assert seen[row["id"]] == expected(row)


@pytest.mark.embedded
def test_what_is_not_there_says_what_to_do(start: Callable[[str], subprocess.Popen[str]]) -> None:
    process = start("from rclpy.action import ActionClient")
    _, errors = process.communicate(timeout=60)
    assert "A real ROS 2 Jazzy has" in errors
