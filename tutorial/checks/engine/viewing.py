"""Viewing: the cases shared by all exercises about viewers, and the steps that make up a case."""

from collections.abc import Callable, Sequence
from contextlib import closing
from typing import Any

from tutorial.checks.engine.cases import Case, Cases, Run
from tutorial.checks.engine.failure import Failure, Misuse
from tutorial.checks.engine.interleave import early
from tutorial.checks.engine.real_dds import ros_node, send
from tutorial.checks.engine.trial import Trial
from tutorial.checks.engine.viewer import Viewer

# A step of a case: a function that is called with the viewer, and can return an observation as text.
Step = Callable[[Any], str | None]

POST = "self.call_later(self.update, message)"
BESIDE = "Your code probably posts calls from its own timer or thread. Post one call per message, in the callback."

SHARED_BY_VIEWERS = (
    "Your code probably stores state on the class, which all viewers share. Store it on self, in configure."
)
ANOTHER_TOPIC = (
    "Your code probably subscribes outside configure, or uses the wrong topic or type. In configure, write {}."
)
NOT_POSTED = ("Your code probably drops some messages, for instance every second message, or posts no calls at all. "
              "For each message, post a call that shows it: {}.")  # fmt: skip
MOVES = ("Your code probably omits calc_forward_kinematics or notify_change, or calls them too early. Each time "
         "your code has moved the body, call calc_forward_kinematics and then notify_change.")  # fmt: skip
PAST_THE_QUEUE = ("Your code probably posts a call directly to the event loop, so it still runs after the controller "
                  "has left its body. Use config.call_later or config.call_latest: "
                  "when the controller leaves, pending calls posted with either function are dropped.")  # fmt: skip


def steps(*done: Step, viewer: Callable[..., Any] = Viewer) -> Run:
    """Make the `run` function of a case. It performs the steps one after another and joins their observations.

    Args:
        done: the steps.
        viewer: makes the viewer for the steps, given a trial: `Viewer` or a subclass.
    """

    def run(trial: Trial) -> str:
        with trial.clocks_stand(), closing(viewer(trial)) as made:
            return ", ".join(dict.fromkeys(filter(None, [step(made) for step in done])))

    return run


def heard(*messages: Any) -> Step:
    """Make a step that delivers messages one by one, and runs the posted calls after each message."""

    def step(viewer: Viewer) -> None:
        for message in messages:
            viewer.receive(message)
            viewer.drain()

    return step


def hands_over(*messages: Any) -> Step:
    """Make a step that counts how many of these messages make the callback post a call.

    The step fails if the callback starts a timer or a thread.
    """

    def step(viewer: Viewer) -> str:
        before, noted = viewer.loop.posted, viewer.trial.noted
        for message in messages:
            viewer.receive(message)
            if place := noted.get("thread") or noted.get("timer"):
                raise Failure(place.function, Misuse("it starts its own timer or thread", BESIDE), place)
            viewer.drain()
        posted = viewer.loop.posted - before
        return f"a call is posted for {min(posted, len(messages))} of {len(messages)} messages"

    return step


def side_by_side(*done: Step) -> Step:
    """Make a step that performs each of these steps with the tank, and then with the crane Lift."""

    def step(tank: Viewer) -> str:
        with closing(tank.another("crane", "Lift")) as lift:
            seen = [[each(viewer) for viewer in (tank, lift)] for each in done]
        return "; ".join(f"{one} and {other}" for one, other in seen if one)

    return step


def viewing(
    solution: type,
    topic: str,
    message: Any,
    arrivals: Sequence[Step],
    cases: Sequence[Case],
    post: str = POST,
    may_ask_clock: bool = False,
    viewer: type[Viewer] = Viewer,
) -> Cases:
    """Combine the cases of an exercise about a viewer with the cases that all such exercises share.

    Args:
        solution: the right answer.
        topic: the topic of the subscription, without the body's name.
        message: a message that a right answer receives at the end, through rclpy's own node.
        arrivals: steps that deliver messages; the last step comes from `hands_over`.
        cases: the exercise's own cases, in order.
        post: the solution's statement that posts a call.
        may_ask_clock: whether an answer may read the computer's clock.
        viewer: the class of viewer that the cases use.
    """

    def on_ros(trial: Trial) -> str:
        with ros_node() as node, closing(viewer(trial, node=node)) as made:
            send(node, f"/Rover/{topic}", message, lambda: made.loop.posted)
            made.drain()
            return made.where()

    kind, not_posted = type(message), NOT_POSTED.format(post)
    listens = steps(lambda viewer: viewer.node.on(kind, f"Rover/{topic}"), viewer=viewer)
    call = f'config.node.create_subscription({kind.__name__}, f"{{config.body.name}}/{topic}", ...)'
    soon = early(lambda trial, node: Viewer(trial, node=node).close(), message)
    tried = [
        Case("on the body Rover", listens, ANOTHER_TOPIC.format(call)),
        Case("when messages arrive", steps(*arrivals, viewer=viewer), not_posted),
        *cases,
        Case("a message arrives as soon as there is a subscription", soon),
    ]
    clock = "" if may_ask_clock else not_posted
    return Cases(solution, tried, [], SHARED_BY_VIEWERS, clock=clock, on_ros=on_ros, one_by_one=True)
