"""The exercises of step 7: from one frame to the next, and two messages of one moment."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from geometry_msgs.msg import Quaternion, TransformStamped
from numpy.typing import ArrayLike, NDArray

from tutorial.checks._pair import judge_pair
from tutorial.checks._where import judge_where
from tutorial.checks.exercise import Exercise

__all__ = ["pair", "where"]


def turned(q: Quaternion, point: ArrayLike) -> NDArray[np.float64]:
    """Turn a point about the origin."""
    axis, point = np.array([q.x, q.y, q.z]), np.array(point, float)
    return np.asarray(point + 2 * np.cross(axis, np.cross(axis, point) + q.w * point))


def where_is(transforms: Sequence[TransformStamped], point: ArrayLike) -> ArrayLike:
    """Say where a point of the last frame is, seen from the first."""
    for stamped in reversed(transforms):
        t = stamped.transform.translation
        point = turned(stamped.transform.rotation, point) + np.array([t.x, t.y, t.z])
    return point


class Pairs:
    """Finds the joint states and the pose of one stamp."""

    def __init__(self) -> None:
        self.waiting: dict[tuple[int, int], dict[str, Any]] = {}

    def add(self, stream: str, message: Any) -> tuple[Any, Any] | None:
        """Take a message; return the pair that it completes."""
        stamp = message.header.stamp.sec, message.header.stamp.nanosec
        together = self.waiting.setdefault(stamp, {})
        together[stream] = message
        if len(together) == 2:
            while stamp in self.waiting:
                del self.waiting[next(iter(self.waiting))]
            return together["joints"], together["pose"]
        if len(self.waiting) > 50:
            del self.waiting[next(iter(self.waiting))]
        return None


where = Exercise(
    name="where",
    statement="""
    Write the function `where_is(transforms, point)`. It returns x, y and z of a point [m], seen from the outermost
    frame.

    - `transforms` is a list of `TransformStamped`, from the outside to the inside: the parent of the first one is the
      outermost frame, and the child of each is the parent of the next.
    - `point` is x, y, z in the child of the last one. Without transforms it is returned as it is.
    - It works with any number of transforms and with any rotation, and leaves the messages as they are.
    """,
    judge=judge_where,
    solution=(where_is,),
    base=None,
    parts=(),
    hints=(
        "Look at the frame that the point is in: only one of the transforms knows that frame, the last one. What does "
        "it make of the point, and which frame is it in then?",
        "Go through the transforms from the last to the first. Each turns the point by its rotation, with turned, and "
        "then adds its translation; what comes out is given to the one before.",
        "for stamped in reversed(transforms): t = stamped.transform.translation, and point becomes "
        "turned(stamped.transform.rotation, point) + np.array([t.x, t.y, t.z]). In the end the point is returned.",
    ),
    notice="Notice that nothing asks how many transforms there are: tf2 composes them in just this way.",
)

pair = Exercise(
    name="pair",
    statement="""
    Write the class `Pairs`, which brings together what two topics say of one moment. Its method `add(stream, message)`
    is called for each message as it comes; `stream` is `"joints"` or `"pose"`. It returns the two messages that have
    the same stamp, `joints, pose`, as soon as both are there, and otherwise `None`.

    - Either of them may come first, and one topic may be ahead of the other.
    - What came before a pair is past: its partner would come too late, so it makes no pair any more.
    - Up to 50 messages wait. If there are more, the one that *came* first gives way.
    - A publisher that is started again begins at 0, and is paired at once.
    """,
    judge=judge_pair,
    solution=(Pairs,),
    base=object,
    parts=("add",),
    requires=("add",),
    hints=(
        "Look at what has to be found when a message comes: the one of the other stream that has the same stamp. What "
        "would you have to keep, and by which key, so that it is found at once?",
        "Keep a dict from stamps to what came of that stamp, by stream. A dict remembers in which order its keys came, "
        "so its first key is the one that has waited longest: drop from there, up to the stamp of a pair, or when "
        "there are more than 50.",
        "The stamp is message.header.stamp.sec, message.header.stamp.nanosec. together: self.waiting.setdefault(stamp, "
        "{}), with together[stream] set to the message. If it has two, delete next(iter(self.waiting)) as long as the "
        "stamp is in there, and return both.",
    ),
    notice="Notice that no stamp is compared with another for being larger: so a new start needed no line.",
)
