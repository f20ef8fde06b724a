"""The pocket ROS 2 prints, raises and logs the same as the real rclpy."""

import gc
import json
from typing import Any

import pytest
from behaviours import NEWER, RECORD, behaviours, outcome, outcomes, recorded

import pocket_ros2

ROWS = recorded()
IN_NEWER = json.loads(NEWER.read_text(encoding="utf-8"))["printed"]

pytestmark = [] if pocket_ros2.install() else [pytest.mark.process, pytest.mark.timeout(600)]
"""On a real ROS 2, the snippets run in separate processes, and the first test waits for all of them."""


def expected(row: dict[str, Any], printed: str | None = None) -> dict[str, Any]:
    """Return the outcome that a row expects, optionally with different output. The order of log lines is ignored."""
    logged = sorted(row.get("logged", ()))
    return {"printed": printed or row["printed"], "raises": row.get("raises"), "logged": logged}


def accepted(row: dict[str, Any]) -> list[dict[str, Any]]:
    """Return the accepted outcomes: one for most rows, two if a later patch release behaves differently."""
    newer = IN_NEWER.get(row.get("shows"))
    return [expected(row)] if newer is None else [expected(row), expected(row, newer)]


@pytest.fixture(scope="module")
def seen(backend):
    """The results of a real ROS 2, by prelude and code: all in one process, because a process for each would be slow.

    Its graph lags behind, and some of the first snippets do not wait for it. So snippets that differ run again, up to
    five times, each in a separate process, as when they were recorded.
    """
    results: dict[tuple[str, str], dict[str, Any]] = {}
    for given in dict.fromkeys(row["prelude"] for row in ROWS if backend == "rclpy"):
        rows = [row for row in ROWS if row["prelude"] == given]
        for row, result in zip(rows, outcomes(given, [row["code"] for row in rows]), strict=True):
            for _ in range(5):
                if result not in accepted(row):
                    (result,) = outcomes(given, [row["code"]])  # noqa: PLW2901
            results[given, row["code"]] = result
    return results


def test_every_snippet_is_recorded():
    rows = json.loads(RECORD.read_text(encoding="utf-8"))["rows"]
    snippets = [(about, shows) for about, shows, _ in behaviours()]
    assert [(row["about"], row["shows"]) for row in rows] == snippets, "run support/record_behaviours.py"


@pytest.fixture(scope="module", autouse=True)
def _quick_collections():
    """Freeze existing objects, because each snippet ends with a garbage collection."""
    gc.freeze()
    yield
    gc.unfreeze()


@pytest.mark.filterwarnings("ignore::pytest.PytestUnhandledThreadExceptionWarning")  # some snippets end a thread's spin
@pytest.mark.parametrize("row", ROWS, ids=lambda row: f"{row['about']}-{row.get('shows', row.get('id'))}")
def test_same_as_rclpy(row, domain, backend, seen):
    if row["about"] == "tf2" and backend != "pocket":
        pytest.importorskip("tf2_ros")
    if backend == "pocket":
        assert outcome(row["prelude"], row["code"]) == expected(row)
    elif len(accepted(row)) > 1:
        assert seen[row["prelude"], row["code"]] in accepted(row)
    else:
        assert seen[row["prelude"], row["code"]] == expected(row)
