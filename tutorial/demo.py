"""The demo's closing table: what the records of a run say, side by side."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from rich.console import Group, RenderableType
from rich.table import Table

__all__ = ["read_records", "summary"]

COUNTS = ("published", "received", "applied")


def read_records(directory: Path) -> list[dict[str, Any]]:
    """Read the records that the processes of a run have left, in the order of their nodes' names."""
    return [json.loads(path.read_text(encoding="utf-8")) for path in sorted(directory.glob("*.json"))]


def summary(records: Sequence[Mapping[str, Any]]) -> RenderableType:
    """Lay out nodes, topics, rates and latencies, and the joints as each node has them."""
    return Group(_topics(records), _joints(records))


def _topics(records: Sequence[Mapping[str, Any]]) -> Table:
    table = Table(title="Topics", title_justify="left")
    for heading in ("node", "topic", "type"):
        table.add_column(heading, no_wrap=True)
    for heading in ("messages", "rate [Hz]", "latency median [ms]", "p99 [ms]"):
        table.add_column(heading, justify="right")
    for record in records:
        for topic, counts in record["topics"].items():
            messages = ", ".join(f"{counts[key]} {key}" for key in COUNTS if key in counts)
            latency = counts["latency_ms"]
            table.add_row(
                f"/{record['node']}",
                topic,
                counts["type"],
                messages,
                f"{counts['rate_hz']:.1f}",
                _number(latency["median"]),
                _number(latency["p99"]),
            )
    return table


def _joints(records: Sequence[Mapping[str, Any]]) -> Table:
    table = Table(title="Joints [rad]", title_justify="left")
    table.add_column("joint")
    having = [record for record in records if record["joints"]]
    for record in having:
        table.add_column(record["node"], justify="right")
    for joint in dict.fromkeys(joint for record in having for joint in record["joints"]):
        table.add_row(joint, *(_angle(record["joints"].get(joint)) for record in having))
    return table


def _number(value: float | None) -> str:
    return "" if value is None else f"{value:.2f}"


def _angle(value: float | None) -> str:
    return "" if value is None else f"{value:+.5f}"
