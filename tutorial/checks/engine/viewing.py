"""Viewing: what all exercises about viewers try, step by step, and the mistakes that they share."""

from collections.abc import Callable, Sequence
from contextlib import closing
from typing import Any

from tutorial.checks.engine.cases import Case, Cases, Mistake, Run, both, replace
from tutorial.checks.engine.failure import Failure, Misuse
from tutorial.checks.engine.interleave import early
from tutorial.checks.engine.real_dds import ros_node, send
from tutorial.checks.engine.trial import Trial
from tutorial.checks.engine.viewer import Viewer

# A step of a case: a function of the viewer that may return what it observes, in words.
Step = Callable[[Any], str | None]

POST = "self.call_later(self.update, message)"
BESIDE = "You probably post from a timer or a thread of your own. Post in the callback, once for each message."

SHARED_BY_VIEWERS = "You probably keep something on the class, which all viewers share. Set it on self, in configure."
NOT_POSTED = ("You probably skip messages, by time or by count, or post none at all. "
              "Post a call for each one, {}, and show it.")  # fmt: skip
MOVES = ("You probably call calc_forward_kinematics or notify_change too early, or not after every move. "
         "First move the body, then call these two, in this order.")  # fmt: skip
MISSING_CALLS = [
    Mistake("you call neither calc_forward_kinematics nor notify_change. Call both after each move, in this order.",
            both(replace("self.body.calc_forward_kinematics()", "pass"), replace("self.body.notify_change", "str"))),
    Mistake("you don't call calc_forward_kinematics, so the links stay behind. "
            "Call it after each move, before notify_change.",
            replace("self.body.calc_forward_kinematics()", "pass")),
    Mistake("you don't call notify_change, so nobody draws the move. Call it after each move, as the last step.",
            replace("self.body.notify_change", "str")),
]  # fmt: skip


def steps(*done: Step, viewer: Callable[..., Any] = Viewer) -> Run:
    """Make the run of a case: do these steps, one after the other, and observe what they return.

    Args:
        done: the steps.
        viewer: makes what they are done with, from a trial: a `Viewer` or a class made from it.
    """

    def run(trial: Trial) -> str:
        with trial.clocks_stand(), closing(viewer(trial)) as made:
            return ", ".join(dict.fromkeys(filter(None, [step(made) for step in done])))

    return run


def heard(*messages: Any) -> Step:
    """Make a step: messages arrive one after the other, and what each has posted runs."""

    def step(viewer: Viewer) -> None:
        for message in messages:
            viewer.receive(message)
            viewer.drain()

    return step


def hands_over(*messages: Any) -> Step:
    """Make a step: say how many messages the callback posts, and whether it leaves the body alone."""

    def step(viewer: Viewer) -> str:
        before, noted = viewer.loop.posted, viewer.trial.noted
        for message in messages:
            viewer.receive(message)
            if place := noted.get("thread") or noted.get("timer"):
                raise Failure(place.function, Misuse("it starts a timer or a thread", BESIDE), place)
            viewer.drain()
        posted = viewer.loop.posted - before
        return f"a call is posted for {min(posted, len(messages))} of {len(messages)}"

    return step


def side_by_side(*done: Step) -> Step:
    """Make a step: a tank and the crane Lift do these steps in turns."""

    def step(tank: Viewer) -> str:
        with closing(tank.another("crane", "Lift")) as lift:
            seen = [[each(viewer) for viewer in (tank, lift)] for each in done]
        return "; ".join(f"{one} and {other}" for one, other in seen if one)

    return step


def past_the_queue(post: str) -> Mistake:
    """Return the mistake of an answer that goes to the event loop by itself.

    Args:
        post: the solution's statement that posts.
    """
    return Mistake(
        "you post to the event loop yourself, so the call still runs after the controller has left its body. "
        f"Use {post}: it drops such calls.",
        both(replace("self.node = config.node", "self.node, self.loop = config.node, get_running_loop()"),
             replace(post, "self.loop.call_soon_threadsafe(self.update, message)")))  # fmt: skip


def _topic(kind: type, topic: str, listens: Run) -> Case:
    """Make the case of the topic to which a viewer listens."""
    right = f'the topic is f"{{config.body.name}}/{topic}".'
    call = f'config.node.create_subscription({kind.__name__}, f"{{config.body.name}}/{topic}", ...)'
    meaning = f"You probably subscribe to another topic or type, or outside of configure. In configure write {call}."
    name = f"{{self.body.name}}/{topic}"
    return Case("on the body Rover", listens, meaning, mistakes=[
        Mistake(f"you leave out the body's name: {right}", replace(name, topic)),
        Mistake(f"you hard-code the body's name: {right}", replace(name, f"Tank/{topic}"))])  # fmt: skip


def viewing(
    solution: type,
    topic: str,
    message: Any,
    cases: Sequence[Case],
    clock: str = NOT_POSTED.format(POST),
    viewer: type[Viewer] = Viewer,
) -> Cases:
    """Put together what an exercise about a viewer tries, and what all of them try.

    Args:
        solution: the right answer.
        topic: the topic that it listens to, without the body's name.
        message: a message that another program sends in the end, with rclpy's own node.
        cases: the exercise's own, in the order in which they are tried.
        clock: the cause of a wrong observation if the answer asks the computer's clock; "" if it may ask it.
        viewer: makes what an answer is tried in.
    """

    def on_ros(trial: Trial) -> str:
        with ros_node() as node, closing(viewer(trial, node=node)) as made:
            send(node, f"/Rover/{topic}", message, lambda: made.loop.posted)
            made.drain()
            return made.where()

    kind = type(message)
    listens = steps(lambda viewer: viewer.node.on(kind, f"Rover/{topic}"), viewer=viewer)
    soon = early(lambda trial, node: Viewer(trial, node=node).close(), message)
    last = Case("a message as soon as there is a subscription", soon)
    tried = [_topic(kind, topic, listens), *cases, last]
    return Cases(solution, tried, [], SHARED_BY_VIEWERS, clock=clock, on_ros=on_ros, one_by_one=True)
