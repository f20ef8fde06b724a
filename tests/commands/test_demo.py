"""The demo's closing table. tests/house/test_wheel.py runs the installed demo."""

import io

from rich.console import Console

from tutorial.commands.demo import summary

TOPIC, JOINTS = "/Tank/joint_state", {"J": 0.5}


def test_the_table_fits_into_80_columns():
    sent = {"published": 500, "rate_hz": 50.0, "latency_ms": {"median": None, "p99": None}}
    got = {"received": 499, "applied": 499, "rate_hz": 49.9, "latency_ms": {"median": 0.75, "p99": 0.8}}
    nodes = {"simulation": sent, "viewer": got}
    console = Console(width=80, file=io.StringIO())
    console.print(summary([{"node": name, "joints": JOINTS, "topics": {TOPIC: each}} for name, each in nodes.items()]))
    text = console.file.getvalue()
    assert all(len(line) <= 80 for line in text.splitlines())
    assert "…" not in text
    rows = [" ".join(line.split()) for line in text.splitlines()]
    for row in (
        "/viewer /Tank/joint_state 499 499 49.9 0.75 0.80",
        "node topic sent received shown [Hz] median p99 [ms]",
        "J +0.50000 +0.50000",
        "joint [rad] simulation viewer",
    ):
        assert row in rows
