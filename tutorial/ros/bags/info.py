"""Describe a bag as ``ros2 bag info`` does."""

import time

from tutorial.errors import printable
from tutorial.ros.bags.bag import Bag
from tutorial.ros.topics.names import escape_name

INDENT = " " * 19
UNITS = ("B", "KiB", "MiB", "GiB", "TiB")


def bag_info(bag: Bag) -> str:
    """Return what ``ros2 bag info`` prints, with the topics sorted by name."""
    topics = [
        f"Topic: {escape_name(topic.name)} | Type: {escape_name(topic.type)} | Count: {topic.count} | "
        f"Serialization Format: {escape_name(bag.channels[topic.name].encoding)}"
        for topic in bag.topics
    ]
    lines = {
        "Files": f"\n{INDENT}".join(printable(file.name) for file in bag.files),
        "Bag size": _size(bag.size),
        "Storage id": bag.storage,
        "ROS Distro": bag.distro or "unknown",
        "Duration": f"{_seconds(bag.end - bag.start)}s",
        "Start": _moment(bag.start),
        "End": _moment(bag.end),
        "Messages": str(sum(topic.count for topic in bag.topics)),
        "Topic information": f"\n{INDENT}".join(topics),
        "Service": "0",
    }
    return "\n" + "".join(f"{f'{name}:':<19}{value}\n" for name, value in lines.items()) + "Service information: \n"


def _size(count: float) -> str:
    """Format a size in the largest unit that fits; bytes have no decimals."""
    power = 0
    while count >= 1024 and power < len(UNITS) - 1:
        count, power = count / 1024, power + 1
    return f"{count:.{min(power, 1)}f} {UNITS[power]}"


def _seconds(nanoseconds: int) -> str:
    seconds, rest = divmod(nanoseconds, 10**9)
    return f"{seconds}.{rest:09d}"


def _moment(nanoseconds: int) -> str:
    """Format a time as a local date and time, and as seconds since 1970."""
    local = time.localtime(min(nanoseconds // 10**9, 2**35))
    text = time.strftime("%b %e %Y %H:%M:%S", local)
    return f"{text}.{nanoseconds % 10**9:09d} ({_seconds(nanoseconds)})"
