"""Write the table in `comparison.md`, which compares how viewers show the same faulty stream.

Run ``make comparison`` after a change to `tutorial/joints.py` or to a fault.
"""

import re
from collections import Counter
from functools import lru_cache
from pathlib import Path
from typing import Any

import tutorial  # noqa: F401 - makes rclpy importable

# isort: split
from viewers import VIEWERS, Viewer

from tutorial.ros.chaos import FAULTS, Action, Chaos
from tutorial.ros.chaos.stream import swing

PAGE = Path(__file__).with_name("comparison.md")
TABLE = re.compile(r"(?<=<!-- made by book/comparison_table.py -->\n).*?(?=<!-- end -->)", re.DOTALL)

MESSAGES = 2000
RATE = 20  # [Hz], the rate of robot_state_publisher
SHARE = 0.1
SEED = 1
RANGES = {"TURRET_Y": (-6.29, 6.29), "TURRET_P": (-0.18, 0.79)}  # [rad]


def judge(kind: type[Viewer], fault: str) -> str:
    """Show a stream to a viewer, and describe how often its pose was stale or wrong and whether it reported a problem.

    A pose is right if every joint has its position from the newest good message. A pose is stale if some joints have
    their positions from earlier good messages instead. Any other pose is wrong.
    """
    viewer = kind(RANGES)
    seen: dict[str, set[float]] = {joint: set() for joint in RANGES}
    found: Counter[str] = Counter()
    said = False
    for good, actions in _stream(fault):
        for action in actions:
            if action.message is not None and not viewer.ended:
                said |= viewer.take(action.message, action.kind)
        true = dict(zip(good.name, good.position))
        for joint, position in true.items():
            seen[joint].add(position)
        known = all(viewer.pose[joint] in seen[joint] for joint in RANGES)
        found["right" if viewer.pose == true else "stale" if known else "wrong"] += 1
    return _words(found, said, viewer.ended)


@lru_cache(maxsize=1)
def _stream(fault: str) -> list[tuple[Any, list[Action]]]:
    """Return each good message, paired with the actions that result from it when the fault is applied.

    Every viewer gets the same actions.
    """
    chaos = Chaos(seed=SEED)
    made = []
    for number in range(1, 1 + MESSAGES):
        good = swing(number, tuple(RANGES), RATE)
        made.append((good, list(chaos.apply(good))))
        chaos.faults = {fault: SHARE}  # the first message was correct, so every joint already has a position
    return made


def _words(found: Counter[str], said: bool, ended: bool) -> str:
    bad = [f"{verdict} {100 * found[verdict] / MESSAGES:.0f} %" for verdict in ("stale", "wrong") if found[verdict]]
    end = ["ends"] if ended else ["reported"] if said else ["silent"] if bad else []
    return ", ".join([*(bad or ["right"]), *end])


def table() -> str:
    """Return the table in Markdown, with a row for each fault."""
    names = [kind.name for kind in VIEWERS]
    rows = [["fault", *names], ["---"] * (len(names) + 1)]
    rows += [[f"`{fault}`", *(judge(kind, fault) for kind in VIEWERS)] for fault in FAULTS]
    return "".join(f"| {' | '.join(row)} |\n" for row in rows)


if __name__ == "__main__":
    PAGE.write_text(TABLE.sub(lambda _: table(), PAGE.read_text(encoding="utf-8")), encoding="utf-8")
