"""The tables at the end of the demo, which compare what its processes recorded."""

import json
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from rich.box import SIMPLE_HEAD
from rich.console import Group, RenderableType
from rich.table import Table
from rich.text import Text

COUNTS = ("published", "received", "applied")


def read_records(directory: Path) -> list[dict[str, Any]]:
    """Read the records that the processes of a run have written, sorted by node name."""
    return [json.loads(path.read_text(encoding="utf-8")) for path in sorted(directory.glob("*.json"))]


def summary(records: Sequence[Mapping[str, Any]]) -> RenderableType:
    """Lay out each node's message counts and joint positions, in at most 80 columns."""
    return Group(_nodes(records), _joints(records))


def _nodes(records: Sequence[Mapping[str, Any]]) -> Table:
    """Lay out how many messages each node sent and received, and their latency from publication to callback."""
    table = _table("node", "topic", "sent", "received", "shown", "[Hz]", "median", "p99 [ms]")
    table.caption = (
        "median and p99 describe the time from publication to callback. Receivers can miss messages: "
        "the programs start one after another, and a queue of depth 1 holds only the newest message."
    )
    table.caption_justify = "left"
    for record in records:
        for topic, counts in record["topics"].items():
            messages = (str(counts.get(key, "")) for key in COUNTS)
            latency = (_number(counts["latency_ms"][key], ".2f") for key in ("median", "p99"))
            table.add_row(f"/{record['node']}", topic, *messages, f"{counts['rate_hz']:.1f}", *latency)
    return table


def _table(*headings: str) -> Table:
    table = Table(box=SIMPLE_HEAD, pad_edge=False, padding=(0, 1, 0, 0))
    for i, heading in enumerate(headings):
        table.add_column(Text(heading), justify="right" if i > 1 else "left")
    return table


def _joints(records: Sequence[Mapping[str, Any]]) -> Table:
    table = _table("joint [rad]")
    having = [record for record in records if record["joints"]]
    for record in having:
        table.add_column(record["node"], justify="right")
    for joint in dict.fromkeys(joint for record in having for joint in record["joints"]):
        table.add_row(joint, *(_number(record["joints"].get(joint), "+.5f") for record in having))
    return table


def _number(value: float | None, form: str) -> str:
    return "" if value is None else format(value, form)
