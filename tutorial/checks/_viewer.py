"""What a controller of a displayed body is tried in: messages on another thread, and the main thread's queue."""

import inspect
import sys
import threading
from collections.abc import Callable, Hashable, Mapping, Sequence
from contextlib import closing
from functools import partial
from numbers import Real
from string import Template
from typing import Any, Self, cast

import mujoco
import numpy as np

from tutorial.body import Body
from tutorial.checks._answer import name_of
from tutorial.checks._cases import Case, Cases
from tutorial.checks._clock import ClockedLoop
from tutorial.checks._diagnose import slept
from tutorial.checks._mistakes import A_MISTAKE
from tutorial.checks._rig import MemoryNode, early, model_of, ros_node, send
from tutorial.checks._watch import Failure, Misuse, watch
from tutorial.controller import ControllerConfig
from tutorial.handoff import CallQueue, ThreadGuard

Step = Callable[[Any], str | None]

PATIENCE = 1.0  # [s], after which a callback that has not returned waits for something

KEY = "call_latest takes a key first: self.call_latest(self.body.name, self.update, message)."
SECONDS = "config.call_later takes no seconds. The loop's does: asyncio.get_running_loop().call_later(0.5, self.land)."
PARENTHESES = "You probably call it at once, with parentheses. Pass the function itself, then its arguments."
TOUCHED = "You probably move the body in the callback. Post everything that uses the body; a lock does not help."
BESIDE = "You probably post from a timer or a thread of your own. Post in the callback, once for each message."
COROUTINE = "Write def, not async def. To wait, let it start a task: asyncio.create_task(...)."
ENDLESS = "The posted call probably posts itself again. Post the method that shows the message, such as self.update."

AT_ONCE = "a message as soon as there is a subscription"
SHARED = """
#
You probably keep something on the class, which all viewers share. Set it on self, in configure.

# on the body Rover
you leave out the body's name: the topic is f"{config.body.name}/$topic".
    {self.body.name}/$topic => $topic
you hard-code the body's name: the topic is f"{config.body.name}/$topic".
    {self.body.name}/$topic => Tank/$topic

You probably subscribe to another topic or type, or outside of configure. In configure write
config.node.create_subscription($kind, f"{config.body.name}/$topic", ...).

# messages come
You probably skip messages, by time or by count, or post none at all. Post a call for each one, $post, and
show it.

# after each move
you call neither calc_forward_kinematics nor notify_change. Call both after each move, in this order.
    self.body.calc_forward_kinematics() => pass
    self.body.notify_change => str
you don't call calc_forward_kinematics, so the links stay behind. Call it after each move, before notify_change.
    self.body.calc_forward_kinematics() => pass
you don't call notify_change, so nobody draws the move. Call it after each move, as the last step.
    self.body.notify_change => str

You probably call calc_forward_kinematics or notify_change too early, or not after every move. First move the body, then
call these two, in this order.

# a call that waits when the controller leaves
you post to the event loop yourself, so the call still runs after the controller has left its body. Use $post: it drops
such calls.
    self.node = config.node => self.node, self.loop = config.node, get_running_loop()
    $post => self.loop.call_soon_threadsafe(self.update, message)
"""


class _Guard(ThreadGuard):
    """A guard that stops nobody: it has `watch` note who comes by on another thread than the main one, ``"touch"``.

    So a check sees what such code does next, for example that it posts what a method has returned.
    """

    def check(self, _action: str) -> None:
        """Note whoever comes by on another thread."""
        if threading.get_ident() != self._ident and not watch.interleaved:
            watch.note("touch", sys._getframe())


class Viewer:
    """A learner's controller on a displayed body. What it posts runs only in `drain`, and the clock stands still.

    Args:
        answer: the learner's class.
        model: the body's model file, without ``.xml``.
        name: the body's name.
        node: the learner's; None for one in memory.

    Attributes:
        node, body, loop: the learner's node, the displayed body, and the main thread's loop.
        calls: the main thread's queue. Its length says how many calls wait.
        keys: those of what was posted with `call_latest`.
        shown: what observers of the body saw at each change: where it was, and whether the links were there.

    Raises:
        Failure: one of the learner's methods raised. So does every method.
    """

    def __init__(self, answer: type, model: str = "tank", name: str = "Rover", node: Any = None) -> None:
        compiled, self._fresh = model_of(model, name)
        self.body = Body(name, compiled, mujoco.MjData(compiled), _Guard(f"the body {name!r}"))
        self.body.calc_forward_kinematics()
        self.body.on_change(lambda _: self.shown.append((self.where(), self._links_follow())))
        self.node = node or cast("Any", MemoryNode())
        self.loop = ClockedLoop()
        self.loop.wrap = lambda function: partial(self._run, function)
        self.loop.set_exception_handler(self._failed)
        self.calls = CallQueue(self.loop)
        self.keys, self.shown = list[Hashable](), list[tuple[str, bool]]()
        self._answer, self._scope, self._failures = answer, self.calls.scope(name), list[Failure]()
        post: tuple[Any, Any] = self._later, self._latest
        try:
            with watch.call("__init__"):
                self._learner = answer()
            self.loop.call_soon(self._run, self._learner.configure, ControllerConfig(self.body, self.node, *post))
            self.drain()
        except Failure:
            self.close()
            raise

    def another(self, model: str = "tank", name: str = "Rover") -> Self:
        """Make another one for the same answer."""
        return type(self)(self._answer, model, name)

    def receive(self, message: Any) -> None:
        """Have a message come, on a thread of its own, and wait until the callbacks have returned."""
        thread = threading.Thread(target=self.call_back, args=(message,), daemon=True)
        thread.start()
        thread.join(PATIENCE)
        if thread.is_alive():
            name, _ = watch.running[thread.ident or 0][-1]
            raise Failure(name, Misuse("it waits", slept(name)), watch.noted.pop("sleep", None))
        self._tell()

    def call_back(self, message: Any) -> None:
        """Have a message come on this thread."""
        for callback in self.node.listeners(message):
            self._run(callback, message)

    def drain(self, seconds: float = 0.0) -> None:
        """Let time pass [s], and run what was posted."""
        self.loop.advance(seconds)
        self._tell()
        if len(self.calls) and not watch.interleaved:  # the turn of another thread may come late, and post
            raise Failure("the posted call", Misuse("it posts another call each time it runs, without end", ENDLESS))

    def leaves(self, *messages: Any) -> str:
        """Have the controller leave its body, and say where the body is then. What waits does not run any more.

        Args:
            messages: come while the main thread is busy with that, just before.
        """
        self.shown.clear()

        def leave() -> None:
            for message in messages:
                self.receive(message)
            self._scope.close()
            self._run(self._learner.unconfigure)

        self.loop.call_soon(leave)
        self.drain()
        return "a timer is still running" if self.loop.timers else self.where()

    def left(self) -> str:
        """Say that the controller has left nothing behind at the node."""
        return str(self.node.check_left())

    def where(self) -> str:
        """Say where the joints are [rad or m]."""
        return ", ".join(f"{joint.name} at {round(joint.position, 6) + 0.0:g}" for joint in self.body.joints)

    def news(self) -> str:
        """Say whether everything follows the last move."""
        told = f"observers are notified{' too early' * (self.shown[-1] != (self.where(), True))}" if self.shown else ""
        return f"its links {'follow' if self._links_follow() else 'stay behind'}, {told or 'nobody is notified'}"

    def close(self) -> None:
        """Drop what waits."""
        self.calls.close()
        self.loop.close()

    def _links_follow(self) -> bool:
        """Whether the links are where the joints' positions put them."""
        self._fresh.qpos[:] = self.body.data.qpos
        mujoco.mj_kinematics(self.body.model, self._fresh)
        return all(np.allclose(getattr(self._fresh, name), getattr(self.body.data, name)) for name in ("xpos", "xquat"))

    def _run(self, function: Callable[..., object], *arguments: Any) -> None:
        """Call a function of the learner's, and keep the failure that it raises."""
        try:
            with watch.call(name_of(function)):
                made = function(*arguments)
                if inspect.iscoroutine(made):
                    made.close()
                    raise Misuse("it is a coroutine function, async def, and nobody awaits it", COROUTINE)
        except Failure as failure:
            self._failures.append(failure)

    def _failed(self, _loop: object, context: Mapping[str, Any]) -> None:
        """Keep what asyncio says of something that runs on the loop."""
        error = context.get("exception") or RuntimeError(context["message"])
        self._failures.append(error if isinstance(error, Failure) else watch.failure("what runs on the loop", error))

    def _later(self, function: Any, *arguments: Any) -> None:
        _check_callable(function)
        self._scope.call_later(self._run, function, *arguments)

    def _latest(self, key: Any, function: Any = None, *arguments: Any) -> None:
        if callable(key) and not callable(function):
            raise Misuse("call_latest is called without a key", KEY)
        self.keys.append(key)
        _check_callable(function)
        self._scope.call_latest(key, self._run, function, *arguments)

    def _tell(self) -> None:
        """Raise what the learner's code has raised meanwhile, or say that it has touched the body on another thread."""
        failures, self._failures = self._failures, []
        for failure in failures[:1]:
            if "touch" not in watch.noted or isinstance(failure.error, Misuse):
                raise failure
        if "touch" in watch.noted:
            touched = Misuse("it uses the body outside of the main thread", TOUCHED)
            raise Failure("the callback", touched, watch.noted["touch"])


def heard(*messages: Any) -> Step:
    """Make a step: messages come one after the other, and what each has posted runs."""

    def step(viewer: Viewer) -> None:
        for message in messages:
            viewer.receive(message)
            viewer.drain()

    return step


def hands_over(*messages: Any) -> Step:
    """Make a step: say how many messages the callback posts, and whether it leaves the body alone."""

    def step(viewer: Viewer) -> str:
        before = viewer.loop.posted
        for message in messages:
            viewer.receive(message)
            if place := watch.noted.get("thread") or watch.noted.get("timer"):
                raise Failure(place.function, Misuse("it starts a timer or a thread", BESIDE), place)
            viewer.drain()
        posted = viewer.loop.posted - before
        return f"a call is posted for {min(posted, len(messages))} of {len(messages)}"

    return step


def side_by_side(*steps: Step) -> Step:
    """Make a step: a tank and the crane Lift do steps in turns."""

    def step(tank: Viewer) -> str:
        with closing(tank.another("crane", "Lift")) as lift:
            seen = [[each(viewer) for viewer in (tank, lift)] for each in steps]
        return "; ".join(f"{one} and {other}" for one, other in seen if one)

    return step


def _check_callable(function: Any) -> None:
    """Refuse to post what cannot be called.

    Raises:
        Misuse: it cannot.
    """
    if not callable(function):
        cause = SECONDS if isinstance(function, Real) else PARENTHESES
        raise Misuse(f"it posts something that cannot be called: {function!r:.40}", cause)


def viewing(
    solution: type,
    topic: str,
    message: Any,
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

    words = {"topic": topic, "kind": type(message).__name__, "post": post}
    tried = {"on the body Rover": [lambda viewer: viewer.node.on(type(message), f"Rover/{topic}")], **tried}
    cases = {text: case(steps) for text, steps in tried.items()}
    cases[AT_ONCE] = early(lambda answer, node: Viewer(answer, node=node).close(), message)
    known = Template(SHARED + table).substitute(words)
    return Cases(solution, cases, known, str, on_ros=on_ros, one_by_one=True, **{"clock": "messages come", **options})
