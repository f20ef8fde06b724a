"""The record of a run: one JSON file for each process, and what the demo's table is made of."""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

from tutorial.errors import TutorialError
from tutorial.joints import JointTally
from tutorial.ros.backend import ros_backend
from tutorial.ros.node_thread import TopicMeter

__all__ = ["make_record", "write_record"]


def make_record(
    node: str,
    seconds: float,
    meters: Iterable[TopicMeter],
    joints: Mapping[str, float] | None = None,
    tally: JointTally | None = None,
    applied: Mapping[str, int] | None = None,
) -> dict[str, Any]:
    """Sum up what a process did.

    Args:
        node: its node's name.
        seconds: how long it ran; simulated time, where it simulates [s].
        meters: what its node has counted.
        joints: where its joints are in the end [rad or m].
        tally: what joint matching found, where joint states are shown.
        applied: how many messages were shown, by topic.

    Returns:
        A mapping with the keys ``node``, ``ros``, ``seconds``, ``joints``, ``topics`` and ``report``. A topic
        has ``published``, ``received`` or both; with both, its rate and latency are those of receiving.
    """
    topics: dict[str, dict[str, Any]] = {}
    for meter in sorted(meters, key=lambda meter: meter.direction):  # of a topic that goes both ways, received is last
        topics.setdefault(meter.topic, {}).update(_topic(meter, applied or {}))
    return {
        "node": node,
        "ros": ros_backend(),
        "seconds": round(seconds, 3),
        "joints": dict(joints or {}),
        "topics": topics,
        "report": (tally or JointTally()).as_dict(),
    }


def write_record(record: Mapping[str, Any], directory: Path) -> Path:
    """Write a record to ``directory/<node>.json``; the directory is made where there is none.

    Returns:
        Where it was written.

    Raises:
        TutorialError: it cannot be written there.
    """
    path = directory / f"{record['node']}.json"
    try:
        directory.mkdir(parents=True, exist_ok=True)
        path.write_text(json.dumps(record, indent=2) + "\n", encoding="utf-8")
    except OSError as error:
        raise TutorialError(
            f"the report {str(path)!r} cannot be written: {error.strerror}. Give another DIR."
        ) from error
    return path


def _topic(meter: TopicMeter, applied: Mapping[str, int]) -> dict[str, Any]:
    counts = {meter.direction: meter.count}
    if meter.topic in applied:
        counts["applied"] = applied[meter.topic]
    return {
        "type": meter.type_name,
        **counts,
        "rate_hz": round(meter.rate, 2),
        "latency_ms": meter.latency_ms(),
    }
