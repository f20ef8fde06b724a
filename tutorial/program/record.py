"""The record of a run: one JSON file for each process. The demo builds its table from these files."""

import json
from collections import Counter, defaultdict
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any

from sensor_msgs.msg import JointState

from tutorial.errors import TutorialError
from tutorial.joints import JointReport
from tutorial.program.item import Item
from tutorial.ros.backend import ros_backend
from tutorial.ros.node_thread import TopicMeter


def make_record(node: str, seconds: float, meters: Sequence[TopicMeter], items: Sequence[Item] = ()) -> dict[str, Any]:
    """Summarize the run of one process.

    Args:
        node: its node's name.
        seconds: the duration of the run [s], in simulated time if the process runs a simulation.
        meters: the node's meters.
        items: the displayed bodies.

    Returns:
        A mapping with the keys ``node``, ``ros``, ``seconds``, ``joints``, ``topics`` and ``report``. A joint's
        position is the last one published or, if none was published, the one displayed [rad or m]. A topic has a
        ``published`` count, a ``received`` count, or both. If it has both, its rate and latency are those of the
        received messages.
    """
    joints = {joint.name: joint.position for item in items for joint in item.body.joints}
    for meter in meters:
        if meter.direction == "published" and isinstance(meter.last, JointState):
            joints.update(zip(meter.last.name, meter.last.position))
    report = Counter(JointReport().counts())
    for item in items:
        report.update(item.joints.tally)
    return {
        "node": node,
        "ros": ros_backend(),
        "seconds": round(seconds, 3),
        "joints": joints,
        "topics": _topics(meters, items),
        "report": dict(report),
    }


def write_record(record: Mapping[str, Any], directory: Path) -> Path:
    """Write a record to ``directory/<node>.json``, and create the directory if it does not exist.

    Returns:
        The path of the file.

    Raises:
        TutorialError: the file cannot be written.
    """
    path = directory / f"{record['node']}.json"
    try:
        directory.mkdir(parents=True, exist_ok=True)
        path.write_text(json.dumps(record, indent=2) + "\n", encoding="utf-8")
    except OSError as error:
        raise TutorialError(f"the report {path} cannot be written: {error.strerror}. Give a different DIR.") from error
    return path


def _topics(meters: Iterable[TopicMeter], items: Iterable[Item]) -> dict[str, dict[str, Any]]:
    """Combine the meters by topic: add up the counts of a topic's publishers, and those of its subscriptions."""
    ends: defaultdict[tuple[str, str], list[TopicMeter]] = defaultdict(list)
    for meter in meters:
        ends[meter.direction, meter.topic].append(meter)
    applied: Counter[str] = Counter()
    for item in items:
        applied.update({meter.topic: item.joints.applied for meter in item.joints.meters})
    topics: dict[str, dict[str, Any]] = {}
    for (direction, topic), same in sorted(ends.items(), key=lambda end: end[0][0]):  # sorts published first
        record = topics.setdefault(topic, {"type": same[0].type_name})
        record[direction] = sum(meter.count for meter in same)
        if direction == "received" and topic in applied:
            record["applied"] = applied[topic]
        record["rate_hz"] = round(sum(meter.rate for meter in same), 2)
        record["latency_ms"] = max(same, key=lambda meter: meter.count).latency_ms()
    return topics
