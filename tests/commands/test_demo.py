"""The demo: one command that runs step 3 as a whole, and its closing table."""

from __future__ import annotations

import io

import pytest
from rich.console import Console

from tutorial.commands.demo import summary


def record(node, topics, joints):
    return {"node": node, "joints": joints, "topics": topics}


def counts(kind, rate, median=None, **keys):
    return {"type": kind, "rate_hz": rate, "latency_ms": {"median": median, "p99": median}, **keys}


def text_of(records):
    console = Console(width=80, file=io.StringIO())
    console.print(summary(records))
    return console.file.getvalue()


def test_the_table_has_nodes_topics_rates_latencies_and_joints_in_80_columns():
    topic, kind, joints = "/Tank/joint_state", "sensor_msgs/msg/JointState", {"J": 0.5}
    sent, got = counts(kind, 50.0, published=500), counts(kind, 49.9, 0.75, received=499, applied=499)
    text = text_of([record("simulation", {topic: sent}, joints), record("viewer", {topic: got}, joints)])
    assert all(len(line) <= 80 for line in text.splitlines())
    assert "…" not in text
    rows = [" ".join(line.split()) for line in text.splitlines()]
    for row in (
        "/viewer /Tank/joint_state 499 499 49.9 0.75 0.75",
        "node topic sent received shown [Hz] median p99 [ms]",
        "J +0.50000 +0.50000",
        "joint [rad] simulation viewer",
    ):
        assert row in rows


@pytest.mark.process
def test_the_demo_runs_and_ends_with_its_table(program):
    running = program("demo", "--duration", 4)
    assert running.ends() == 0
    looks = [f"{name} | look at http://127.0.0.1:" for name in ("viewer    ", "simulation")]
    for said in (*looks, "/viewer      /Tank/joint_state", "TURRET_Y"):
        assert said in running.output
    running.leaves_nothing()
