"""A bench: a learner's controller on a real rclpy node, with its callbacks on one thread, and a second program."""

import sys
import time
from collections import Counter, deque
from collections.abc import Callable, Mapping
from functools import partial
from itertools import chain
from traceback import walk_stack, walk_tb
from typing import Any

from std_srvs.srv import Trigger

from tutorial.checks.engine.answer import name_of
from tutorial.checks.engine.bodies import bodies
from tutorial.checks.engine.exceptions import endless
from tutorial.checks.engine.failure import Failure, Misuse
from tutorial.checks.engine.trial import Trial
from tutorial.controller import ControllerConfig
from tutorial.handoff import PATIENCE, RequestQueue, T, Ts
from tutorial.ros.node_thread import SpinThread
from tutorial.ros.watched_node import WatchedNode

LOOK = 0.01  # [s] between checks of a condition
LOOKS = 500  # number of checks before a request counts as unanswered
NO_SERVICE = "Your code probably doesn't create the service in configure, or creates it with a different name or type."
UNANSWERED = (
    "Your code probably waits for a response that cannot arrive, or returns before it has the response. "
    "Await call_async in a coroutine, with the clients in a callback group that the waiting callback is not in."
)
SPINS = (
    "The executor is already spinning: its thread runs all callbacks, and can receive no response until the current "
    "callback returns or awaits. Await call_async in a coroutine."
)
SIGNATURE = "rclpy calls a service callback with two arguments, the request and an empty response."
FIELDS = "Set message to a string, and success to True or False."
TOO_EARLY = "There is no request yet. Call config.ask in the callback, for each request."
KEYWORD = "config.ask passes these arguments to the function. Pass the timeout as a keyword argument: timeout=0.5."
THE_NODE = "config.node belongs to the whole program. Destroy only what your code has created on it."
NO_RETURN = "You probably forgot return, or returned something else. A service callback must return a response."
REQUEST = (
    "This client can send only a {0}.Request(). Create the client with the type Trigger, and call it with a request."
)
HASTY = "Await each response before you call the next service."
NOT_THERE = {
    "'Future'": "call_async returns a future, not the response. Write await before it, in a coroutine.",
    "'coroutine'": "Calling a coroutine function doesn't give you its result until you await the call. "
    "Write await before it.",
    "'NoneType'": "There is no response yet: a future has no result until it is done, and call returns None after its "
    "timeout. Await call_async in a coroutine.",
    "_Request' object": f"A request does not have this field. {SIGNATURE}",
    "await": "This is already a result. Remove await: only coroutines and the futures that call_async returns can be "
    "awaited.",
}
"""Likely causes of an exception, keyed by a string in its message."""
NO_LOOP = (
    "until and asyncio work only in a cell. In a callback, await the future itself, "
    "as in await self.client.call_async(request)."
)


class _Node(WatchedNode):
    """A node that has at most one service call in progress, and that only the bench may destroy."""

    is_used = True
    _future: Any = None

    def destroy_node(self) -> None:
        if self.is_used:
            raise Misuse("it destroys the program's node", THE_NODE)
        super().destroy_node()

    def _call_async(self, client: Any, call_async: Callable[..., Any], request: Any = None) -> Any:
        if self._future is not None and not self._future.done():
            raise Misuse(f"it calls {client.service_name} before the previous response has arrived", HASTY)
        if not isinstance(request, client.srv_type.Request):
            raise Misuse(f"it calls {client.service_name} with {request!r}", REQUEST.format(client.srv_type.__name__))
        self._future = super()._call_async(client, call_async, request)
        return self._future


class _Thread(SpinThread[_Node]):
    """A node's thread that stores a callback's exception instead of logging it, so that the learner sees it."""

    timeout = 0.5

    @property
    def ident(self) -> int:
        """The identifier of the thread."""
        return self._thread.ident or 0

    def failed(self, error: BaseException) -> None:
        self.error = self.error or error

    def close(self) -> None:
        self.node.is_used = False
        self._stopping.set()
        self._thread.join(self.timeout)
        if self._thread.is_alive():  # the learner's callback does not return: the thread ends with the process
            self.alive.discard(self)
        else:
            super().close()


class Bench:
    """Run a learner's controller on its own node, and make requests from a second node.

    Args:
        trial: the trial that the bench belongs to.
        name: the body's name.
        replies: by service name, the replies of the services that the second program already offers when `configure`
            runs. A request succeeds unless the reply begins with "no".

    Attributes:
        trial: as given.
        node: the learner's node.
        displayed: the displayed body.
        body: the simulated body, which does not move by itself.
        requests: the requests that are waiting for the simulation's thread.
        learner: the learner's controller.
        took: how long the last response took [s].
        asked: the names of the second program's services that the learner has called, in order.
        timeouts: the timeouts of the learner's calls to ``config.ask`` [s].

    Raises:
        Failure: one of the learner's methods raised an exception. Every method of a bench can also raise this error.
    """

    def __init__(self, trial: Trial, name: str = "Tank", **replies: str) -> None:
        self.trial, self.requests, self.asked, self.took = trial, RequestQueue(), list[str](), 0.0
        self.timeouts, self._posted, self._is_configured = list[float](), deque[Callable[[], object]](), False
        trial.is_timed = not replies  # configure may wait for the services, and rclpy checks for them only every 0.25 s
        self._own, self._other = _Thread(_Node, f"tank_{id(trial)}"), _Thread(_Node, "other")
        self.node = self._own.node
        setattr(self.node.executor, "spin_until_future_complete", _spins)  # noqa: B010 - mypy refuses an assignment
        self.displayed, self.body = bodies(trial, "tank", name)
        self.node.declare_parameter("width", 0.4)  # declared by other code
        self._before = self._made()
        try:
            self._serve(replies)
            with trial.calling("__init__"):
                self.learner = trial.answer()
            self.do("configure", ControllerConfig(self.displayed, self.node, self._post, _drop, self._ask_simulation))
            self._is_configured = True
            clients = [each for each in self.node.clients if each.service_name[1:] in replies]
            self._wait(lambda: all(map(self._know_each_other, clients)))
        except BaseException:
            self.close()
            raise

    def do(self, method: str, *arguments: Any) -> None:
        """Call one of the learner's methods."""
        with self.trial.calling(method):
            getattr(self.learner, method)(*arguments)

    def _serve(self, replies: Mapping[str, str]) -> None:
        """Offer the second program's services, and wait until the learner's node has discovered them."""
        for name, reply in replies.items():

            def answer(_request: Any, response: Any, name: str = name, reply: str = reply) -> Any:
                time.sleep(LOOK)
                self.asked.append(name)
                response.success, response.message = not reply.startswith("no"), reply
                return response

            self._other.node.create_service(Trigger, f"/{name}", answer)
        self._wait(lambda: all(self.node.count_services(f"/{name}") for name in replies))

    def _ask_simulation(self, function: Callable[[*Ts], T], /, *arguments: *Ts, timeout: float = PATIENCE) -> T:
        if not self._is_configured:
            raise Misuse("it calls config.ask", TOO_EARLY)
        self.timeouts.append(timeout)
        try:
            return self.requests.ask(function, *arguments, timeout=timeout)
        except TypeError as error:
            if not arguments:
                raise
            raise Misuse(f"it passes the arguments {arguments} to config.ask: {error}", KEYWORD) from error

    def _post(self, function: Callable[[*Ts], object], /, *args: *Ts) -> None:
        self._posted.append(partial(function, *args))

    def ask(self, service: str) -> str:
        """Make a request, and describe the response."""
        client = self._other.node.create_client(Trigger, service)
        if not self._wait(lambda: client.service_is_ready() and self.node.count_clients(service)):
            text = f"there is no service {service} of the type Trigger; it creates {self.created() or 'nothing'}"
            raise Failure("configure", Misuse(text, NO_SERVICE))
        began = time.monotonic()
        future = client.call_async(Trigger.Request())
        self._wait(lambda: future.done() or self._own.error or self.node.deadlocks())
        if not future.done():
            raise self._failure(service)
        self.took = time.monotonic() - began
        return f"{'yes' if future.result().success else 'no'}: {future.result().message}"

    def leave(self) -> str:
        """Call `unconfigure`, and name the services, clients and parameters that the controller has left behind."""
        self.do("unconfigure")
        left = self.created()
        return f"left: {left}" if left else "nothing is left"

    def created(self) -> str:
        """Name the services, clients, callbacks and parameters that the controller has created but not destroyed."""
        return ", ".join(sorted((self._made() - self._before).elements()))

    def close(self) -> None:
        """End all pending requests, and close both nodes."""
        self.requests.close()
        if self.node.deadlocks():
            self.node.end_deadlocks()
            self._wait(lambda: self._own.error)  # otherwise, rclpy warns that the exception was never retrieved
        self._own.close()
        self._other.close()

    def _know_each_other(self, client: Any) -> bool:
        """Return whether a client has discovered its service, and the service the client."""
        return bool(client.service_is_ready() and self._other.node.count_clients(client.srv_name))

    def _failure(self, service: str) -> Failure:
        """Determine why no response has arrived."""
        if self._own.error is not None:
            return _from_callback(self.trial, self._own.error)
        for wait, text in self.node.deadlocks().items():
            return Failure(wait.label, Misuse(text, UNANSWERED))
        place = self.trial.place(walk_stack(sys._current_frames().get(self._own.ident)))
        if place is not None:
            return Failure(place.function, Misuse("it does not return", endless(place.function)), place)
        return Failure(service, Misuse("no response arrives", UNANSWERED))

    def _made(self) -> Counter[str]:
        node = self.node
        callbacks = node._pre_set_parameters_callbacks, node._on_set_parameters_callbacks
        names = [f"the service {each.service_name}" for each in node.services]
        names += [f"the client of {each.service_name}" for each in node.clients]
        names += [f"the callback {name_of(each)}" for each in chain(*callbacks, node._post_set_parameters_callbacks)]
        return Counter(names + [f"the parameter {name}" for name in self.node.get_parameters_by_prefix("")])

    def _wait(self, condition: Callable[[], object]) -> bool:
        """Run the posted calls until a condition holds. Return False if it does not hold within `LOOKS` checks."""
        for _ in range(LOOKS):
            while self._posted:
                self.trial.call(self._posted.popleft())
            if condition():
                return True
            time.sleep(LOOK)
        return False


def _from_callback(trial: Trial, error: BaseException) -> Failure:
    """Return the failure for an exception raised by a callback that the executor has called."""
    trace = error.__traceback__
    while trace is not None and trace.tb_frame.f_code.co_filename not in trial.watched:
        trace = trace.tb_next  # the executor's frames
    frames = [*walk_tb(trace)]
    place = trial.place(reversed(frames))
    if place is None:
        return _unsent(error)
    is_own = frames[-1][0].f_code.co_filename in trial.watched  # the learner's code itself raised the exception
    cause = next((cause for part, cause in NOT_THERE.items() if is_own and part in str(error)), None)
    if "event loop" in str(error):
        cause = NO_LOOP
    if any(frame.f_code.co_name.startswith("spin") for frame, _ in frames):
        cause = SPINS
    text = f"it raises {type(error).__name__}: {error}"
    return Failure(place.function, Misuse(text, cause) if cause else error.with_traceback(trace), place)


def _unsent(error: BaseException) -> Failure:
    """Return the failure if rclpy could not call a service callback, or could not send the returned object."""
    *_, (frame, _) = walk_tb(error.__traceback__)
    if frame.f_code.co_name != "send_response":
        return Failure("a callback", Misuse(f"calling it raises {type(error).__name__}: {error}", SIGNATURE))
    service, returned = frame.f_locals["self"], frame.f_locals["response"]
    method, kind = name_of(service.callback), type(returned).__name__
    if isinstance(returned, service.srv_type.Response):
        return Failure(method, Misuse(f"rclpy cannot send {returned}", FIELDS))
    if returned is None:
        return Failure(method, Misuse("it returns None", NO_RETURN))
    return Failure(method, Misuse(f"it returns a {kind}", NOT_THERE.get(f"'{kind}'", NO_RETURN)))


def _drop(*_: object) -> None:
    pass


def _spins(*_: object, **__: object) -> None:
    raise Misuse("it spins the executor", SPINS)
