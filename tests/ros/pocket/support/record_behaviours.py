"""Record what the real rclpy does with the snippets in the folder behaviours, each in a fresh process.

Run it with a real ROS 2 in use, then review the git diff. With ``--newer``, keep the record, and write the
differences of a later patch release into a separate file.
"""

import json
import os
import platform
import sys
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

from behaviours import EXPRESSIONS, NEWER, RECORD, behaviours, outcomes, prelude, snippets

import pocket_ros2


def record(about: str, shows: str, code: str) -> dict[str, Any]:
    """Run one snippet, and return its row."""
    (outcome,) = outcomes(prelude(), [code])
    return {"about": about, "shows": shows, **outcome}


def main() -> None:
    if pocket_ros2.install():
        raise SystemExit("The pocket ROS 2 is in use: what is recorded here is what a real one does.")
    where = f"{os.environ.get('RMW_IMPLEMENTATION', 'default rmw')}, Python {platform.python_version()}"
    groups = json.loads(EXPRESSIONS.read_text(encoding="utf-8"))["groups"]
    with ThreadPoolExecutor(os.cpu_count()) as workers:
        rows = list(workers.map(lambda given: record(*given), behaviours()))
        printed = list(workers.map(lambda group: outcomes(prelude(), snippets(group)), groups))
    if "--newer" in sys.argv:
        _write_differences(groups, printed, rows, where)
        return
    for group, those in zip(groups, printed, strict=True):
        group["expressions"] = {
            code: done["printed"].removesuffix("\n") for code, done in zip(group["expressions"], those, strict=True)
        }
    note = (
        "Recorded by support/record_behaviours.py: each snippet, after the prelude, in a fresh process on a real "
        f"ROS 2 Jazzy ({where}). "
        "'raises' is the exception's type and text; 'logged' the log lines on stderr, sorted, with the time replaced "
        "by [T]. Paths are cut."
    )
    _write(RECORD, {"note": note, "rows": rows})
    note = (
        "Expressions are written here by hand; their outcomes are recorded by support/record_behaviours.py on a "
        f"real ROS 2 Jazzy ({where}). The prelude, and the lines of the group's setup, come before each."
    )
    _write(EXPRESSIONS, {"note": note, "groups": groups})
    print(f"{len(rows)} behaviours in {RECORD}, {sum(map(len, printed))} expressions in {EXPRESSIONS}")


def _write_differences(groups: Any, printed: Any, rows: list[dict[str, Any]], where: str) -> None:
    """Write the outputs that differ from the record, without those that need a missing package."""
    before = {row["shows"]: row["printed"] for row in json.loads(RECORD.read_text(encoding="utf-8"))["rows"]}
    different = {row["shows"]: row["printed"] for row in rows if row["printed"] != before[row["shows"]]}
    for row in rows:
        if row["raises"] and row["raises"]["type"] == "builtins.ModuleNotFoundError":
            different.pop(row["shows"], None)
    for group, those in zip(groups, printed, strict=True):
        for (code, recorded), snippet, done in zip(group["expressions"].items(), snippets(group), those, strict=True):
            if done["printed"] != f"{recorded}\n":
                (alone,) = outcomes(prelude(), [snippet])  # an earlier snippet may have affected it
                if alone["printed"] != f"{recorded}\n":
                    different[code] = alone["printed"]
    note = f"What a later patch release of Jazzy prints instead ({where}); by record_behaviours.py --newer."
    _write(NEWER, {"note": note, "printed": different})
    print(f"{len(different)} differences in {NEWER}")


def _write(file: Path, what: dict[str, Any]) -> None:
    file.write_text(json.dumps(what, indent=1) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
