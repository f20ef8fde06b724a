"""The exercise of step 8: find in a bag where a stream was interrupted."""

from __future__ import annotations

from collections.abc import Sequence

from rclpy.time import Time
from sensor_msgs.msg import JointState

from tutorial.checks._gaps import judge_gaps
from tutorial.checks.exercise import Exercise

__all__ = ["gaps"]


def find_gaps(messages: Sequence[tuple[int, JointState]]) -> list[tuple[str, int, int]]:
    """Find where a stream was interrupted, and where its publisher was started again."""
    found = []
    newest = None
    for _, message in messages:
        stamp = Time.from_msg(message.header.stamp).nanoseconds
        if newest is None:
            newest = stamp
        elif stamp - newest > 100_000_000:
            found.append(("gap", newest, stamp))
            newest = stamp
        elif newest - stamp > 1_000_000_000:
            found.append(("restart", newest, stamp))
            newest = stamp
        else:
            newest = max(newest, stamp)
    return found


gaps = Exercise(
    name="gaps",
    statement="""
    Write the function `find_gaps(messages)`. It is given what a bag holds of one topic, a list of pairs `(time_ns,
    message)` in the order in which they were received, each `message` a `JointState`. It returns a list of what
    happened, in the same order:

    - `("gap", before, after)`, where a stamp is more than 0.1 s after the newest one so far;
    - `("restart", before, after)`, where a stamp is more than 1 s before the newest one so far: the publisher was
      started again, and the newest stamp begins anew.

    `before` is the newest stamp so far and `after` that of the message, both in whole nanoseconds. A message that is a
    little late, or as old as the newest one, says nothing. It never raises, and leaves the list as it is.
    """,
    judge=judge_gaps,
    solution=(find_gaps,),
    base=None,
    parts=(),
    hints=(
        "Look at what each message is compared with: not with the one before it, which may have been late, but with "
        "the newest stamp so far. And the bag's own times say nothing about when a message was made.",
        "Keep the newest stamp in a variable, None before the first message. A stamp is whole nanoseconds: "
        "Time.from_msg of rclpy.time makes them. Then there are three cases: far ahead, far back, and all others.",
        "In the loop: with no newest one yet, newest = stamp. If stamp - newest > 100_000_000, append a gap; if newest "
        "- stamp > 1_000_000_000, a restart; after either, newest = stamp. Else newest = max(newest, stamp).",
    ),
    notice="Notice that the bag's own times were not needed: a slow computer is no gap.",
    imports=("from rclpy.time import Time",),
)
