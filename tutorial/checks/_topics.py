"""Looking at the subscription or publisher that an exercise asks for: whether it is there, and gone in the end."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TypeVar

from tutorial.checks._answer import missing
from tutorial.checks._node import Ear, Mouth, WatchedNode
from tutorial.checks._verdict import Finding, right, wrong

__all__ = ["ear_on", "judge_leaving", "mouth_on"]

End = TypeVar("End", Ear, Mouth)


def ear_on(node: WatchedNode, topic: str, message_type: type, call: str) -> tuple[Finding, Ear | None]:
    """Find the subscription that the exercise asks for.

    Args:
        node: the learner's.
        topic: its full name.
        message_type: of its messages.
        call: how the subscription is made.
    """
    if not node.ears:
        return wrong("configure subscribes to nothing", f"Most likely the call is missing: {call}."), None
    return _among(node.ears, "listens to", topic, message_type)


def mouth_on(node: WatchedNode, topic: str, message_type: type, call: str) -> tuple[Finding, Mouth | None]:
    """Find the publisher that the exercise asks for; the arguments are those of `ear_on`."""
    if not node.mouths:
        return wrong("configure makes no publisher", f"Most likely the call is missing: {call}."), None
    return _among(node.mouths, "publishes on", topic, message_type)


def judge_leaving(answer: type, unconfigure: Callable[[], None], made: Ear | Mouth) -> Finding:
    """Call `unconfigure`, and look whether it undoes what `configure` did.

    Args:
        answer: the learner's class.
        unconfigure: the learner's, watched.
        made: the subscription or the publisher.

    Raises:
        Stumble: it raised.
    """
    unconfigure()
    does, keeps = ("listens", "subscription") if isinstance(made, Ear) else ("has its publisher", "publisher")
    call = f"self.node.destroy_{keeps}(self.{keeps})"
    if made.destroyed:
        gone = f"after unconfigure {'it does not listen any more' if does == 'listens' else 'its publisher is gone'}"
        better = f". Better call {call}: after destroy() the spin of a real ROS 2 fails, for its node was not told"
        return right(gone + better * made.by_itself)
    lacking = missing(answer, "unconfigure")
    cause = f"Most likely unconfigure is missing, or does not call {call}."
    if lacking is not None and "misspelled" in lacking.cause:
        cause = lacking.cause
    return wrong(f"after unconfigure it still {does}", cause)


def _among(made: Sequence[End], does: str, topic: str, message_type: type) -> tuple[Finding, End | None]:
    """Find the one for a topic and a type among those that the learner has made."""
    for end in made:
        if end.topic == topic and end.message_type is message_type:
            return right(f"it {does} {topic}"), end
    return _other_topic(made[0], does, topic, message_type), None


def _other_topic(made: Ear | Mouth, does: str, topic: str, message_type: type) -> Finding:
    if made.topic == topic:
        text = f"{topic} {does.split(maxsplit=1)[0]} messages of the type {made.message_type.__name__}"
        return wrong(text, f"Its messages are of the type {message_type.__name__}: give that class first.")
    body, _, rest = topic.lstrip("/").partition("/")
    text = f"on a body called {body}, it {does} {made.topic}, not {topic}" if rest else f"it {does} {made.topic}"
    if not rest:
        return wrong(f"{text}, not {topic}", f"Most likely the topic's name is another: it is {body!r}.")
    if made.topic.partition("/")[2].partition("/")[2] == rest:
        return wrong(text, "The body's name is written into the topic: take it from config.body.name.")
    return wrong(text, f'Most likely the topic\'s name is another: it is f"{{config.body.name}}/{rest}".')
