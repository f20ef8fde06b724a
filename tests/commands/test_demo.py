"""The demo: one command that runs step 3 as a whole, and its closing table."""

from __future__ import annotations

import io

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
    text = text_of(
        [
            record(
                "simulation",
                {"/Tank/joint_state": counts("sensor_msgs/msg/JointState", 50.0, published=500)},
                {"J": 0.5},
            ),
            record(
                "viewer",
                {"/Tank/joint_state": counts("sensor_msgs/msg/JointState", 49.9, 0.75, received=499, applied=499)},
                {"J": 0.5},
            ),
        ]
    )
    assert all(len(line) <= 80 for line in text.splitlines())
    assert "…" not in text
    rows = [" ".join(line.split()) for line in text.splitlines()]
    assert "/Tank/joint_state sensor_msgs/msg/JointState 49.9" in rows
    assert "/viewer /Tank/joint_state 499 499 0.75 0.75" in rows
    assert "node topic published received applied median p99 [ms]" in rows
    assert "J +0.50000 +0.50000" in rows
    assert "joint [rad] simulation viewer" in rows


def test_the_demo_runs_and_ends_with_its_table(program):
    running = program("demo", "--duration", 4)
    assert running.ends() == 0
    assert "viewer     | look at http://127.0.0.1:" in running.output
    assert "simulation | look at http://127.0.0.1:" in running.output
    assert "100% |========" in running.output
    assert "/Tank/joint_state  sensor_msgs/msg/JointState" in running.output
    assert "TURRET_Y" in running.output
    running.leaves_nothing()
