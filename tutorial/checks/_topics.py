"""Looking at the subscription or publisher that an exercise asks for: whether it is there, and gone in the end."""

from __future__ import annotations

from collections.abc import Callable, Generator
from typing import TypeVar

from tutorial.checks._answer import missing
from tutorial.checks._node import WatchedEndpoint, WatchedNode, WatchedSubscription
from tutorial.checks._verdict import Finding, right, wrong

__all__ = ["endpoint", "endpoint_on", "judge_leaving"]

TWO = (
    "Most likely configure makes two, and keeps only one, as when super().configure(config) has made one already: make "
    "only the {keeps} that was asked for."
)

Endpoint = TypeVar("Endpoint", bound=WatchedEndpoint)


def endpoint_on(
    node: WatchedNode, kind: type[Endpoint], topic: str, message_type: type, call: str
) -> Generator[Finding, None, Endpoint | None]:
    """Find the subscription or publisher that the exercise asks for among those that the learner has made.

    It is returned, None where there is none, and what was found is yielded: ``made = yield from endpoint_on(...)``.

    Args:
        node: the learner's.
        kind: `WatchedSubscription` or `WatchedPublisher`.
        topic: its full name.
        message_type: of its messages.
        call: how it is made.
    """
    made = node.watched(kind)
    found = endpoint(node, kind, topic, message_type)
    listens = kind is WatchedSubscription
    does = "listens to" if listens else "publishes on"
    if found is not None:
        yield right(f"it {does} {topic}")
    elif made:
        yield _other_topic(made[0], does, topic, message_type)
    else:
        nothing = "subscribes to nothing" if listens else "makes no publisher"
        yield wrong(f"configure {nothing}", f"Most likely the call is missing: {call}.")
    return found


def endpoint(node: WatchedNode, kind: type[Endpoint], topic: str, message_type: type) -> Endpoint | None:
    """Return the learner's subscription or publisher of a topic; of several the last, None where there is none."""
    made = [each for each in node.watched(kind) if each.topic == topic and each.message_type is message_type]
    return made[-1] if made else None


def judge_leaving(answer: type, unconfigure: Callable[[], None], made: WatchedEndpoint) -> Finding:
    """Call `unconfigure`, and look whether it undoes what `configure` did.

    Args:
        answer: the learner's class.
        unconfigure: the learner's, watched.
        made: the subscription or the publisher.

    Raises:
        Failure: it raised.
    """
    unconfigure()
    listens = isinstance(made, WatchedSubscription)
    keeps = "subscription" if listens else "publisher"
    call = f"self.node.destroy_{keeps}(self.{keeps})"
    if made.node_destroyed:
        cause = f"config.node belongs to the whole program: unconfigure destroys only the {keeps}, {call}."
        return wrong("after unconfigure the program's node is gone", cause)
    if not made.destroyed:
        cause = _left_out(answer, keeps, call)
        return wrong(f"after unconfigure it still {'listens' if listens else 'has its publisher'}", cause)
    others = [each for each in made.node.watched(WatchedEndpoint) if not each.destroyed]
    if others:
        kind = "listens to" if isinstance(others[0], WatchedSubscription) else "has a publisher on"
        return wrong(f"after unconfigure it still {kind} {others[0].topic}", TWO.format(keeps=keeps))
    if made.node.timers_left:
        return wrong(
            "after unconfigure its timer still runs", "Take it back, too: self.node.destroy_timer(self.timer)."
        )
    gone = f"after unconfigure {'it does not listen any more' if listens else 'its publisher is gone'}"
    better = f". Better call {call}: after destroy() the spin of a real ROS 2 fails, for its node was not told"
    return right(gone + better * made.by_itself)


def _left_out(answer: type, keeps: str, call: str) -> str:
    """Say what is the matter with an `unconfigure` after which something is still there."""
    lacking = missing(answer, "unconfigure")
    if lacking is None:
        return f"Most likely unconfigure does not call {call}: a flag or None does not destroy the {keeps}."
    return (
        lacking.cause if "misspelled" in lacking.cause else f"Most likely unconfigure is missing: in it, call {call}."
    )


def _other_topic(made: WatchedEndpoint, does: str, topic: str, message_type: type) -> Finding:
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
