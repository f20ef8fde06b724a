"""What all exercises have in common whose controllers show something: the topic, the hand-over, the end."""

from collections.abc import Mapping, Sequence
from contextlib import closing
from string import Template
from typing import Any

from tutorial.checks._cases import Case, Cases
from tutorial.checks._mistakes import A_MISTAKE
from tutorial.checks._node import early, ros_node, send
from tutorial.checks._viewer import Step, Viewer
from tutorial.checks._watch import watch

AT_ONCE = "a message as soon as there is a subscription"
THROTTLED = "Most likely messages are dropped by time or by count: post and show every one, whenever it comes."
SHARED = """
#
Most likely what is kept belongs to the class: make it in configure, self.place = ...

# on a body called Rover it listens to
the topic is another: it is f"{config.body.name}/$topic".
    {self.body.name}/$topic" => {self.body.name}/${topic}s" => Tank/$topic"
config.node.create_subscription($kind, ...) is missing, or not reached.
    self.node.create_subscription( => (

# for messages of the type
the type of the messages is another: give $kind first.
    ($kind, => (object,

# messages come
$post is missing, or not reached: the callback posts nothing.
    $post => pass

# the news of it
self.body.calc_forward_kinematics() is missing, or not reached: the links stay behind.
    self.body.calc_forward_kinematics() => pass
self.body.calc_forward_kinematics() comes too early: the links stay behind what is moved after it.
    self.body.calc_forward_kinematics() => pass
    $move => self.body.calc_forward_kinematics() // $move
self.body.notify_change() is missing, or not reached: nobody is told to draw.
    self.body.notify_change( => bool(
self.body.notify_change() comes too early: first the move, then the kinematics, then the news of it.
    self.body.notify_change( => bool(
    $move => self.body.notify_change() // $move

# one that waits when the controller leaves
it goes to the event loop by itself: $post is asked for, and drops what still waits when the controller leaves its body.
    self.node = config.node => self.node, self.loop = config.node, asyncio.get_running_loop()
    $post => self.loop.call_soon_threadsafe(self.update, message)
"""


def viewing(
    solution: type,
    topic: str,
    message: Any,
    move: str,
    tried: Mapping[str, Sequence[Step]],
    table: str,
    post: str = "self.call_later(self.update, message)",
    viewer: type[Viewer] = Viewer,
    **options: Any,
) -> Cases:
    """Put together what is tried and known of all such exercises, and of this one.

    Args:
        solution: the right answer.
        topic: that it listens to, without the body's name.
        message: what it is sent by another program in the end, with rclpy's own node.
        move: the solution's statement that moves the body.
        tried: by text, in the order in which they are tried, steps: functions of the viewer, of which each may return
            what is observed, in words.
        table: the mistakes, those that fail a case below a line with ``#`` and its text. To them come those that all
            viewers share.
        post: the solution's statement that posts.
        viewer: makes what an answer is tried in.
        options: of `Cases`.
    """

    def case(steps: Sequence[Step]) -> Case:
        def attempt(answer: Any) -> str:
            watch.noted.clear()
            watch.files.add(A_MISTAKE)  # as if the learner had written that
            with watch.clocks_stand(), closing(viewer(answer)) as made:
                return ", ".join(dict.fromkeys(filter(None, [step(made) for step in steps])))

        return attempt

    def on_ros(answer: Any) -> str:
        with ros_node() as node, closing(viewer(answer, node=node)) as made:
            send(node, f"/Rover/{topic}", message, lambda: made.loop.posted)
            made.drain()
            return made.where()

    words = {"topic": topic, "kind": type(message).__name__, "move": move, "post": post}
    cases = {text: case(steps) for text, steps in tried.items()}
    cases[AT_ONCE] = early(lambda answer, node: Viewer(answer, node=node).close(), message)
    known = Template(SHARED + table).substitute(words)
    return Cases(solution, cases, known, str, on_ros=on_ros, one_by_one=True, **{"clock": THROTTLED, **options})
