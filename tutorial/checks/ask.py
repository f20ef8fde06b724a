"""The exercise `ask`: ask two questions in a callback, and never wait for yourself.

Write the controller `PitCrew`. It offers the service `/pit_stop` (type `Trigger`). For each request, it calls
`/open_door`, and then `/go_home` (both `Trigger`). Assume that other programs offer these services.

- If `success` is True in the door's response, `PitCrew` returns the response of `/go_home`, successful or not.
- If `success` is False in the door's response, `PitCrew` does not call `/go_home` and returns the door's response.
- All callbacks of the program's node run on one thread. This thread must not wait for a response.
- Create both clients on `config.node`, in `configure`. In `unconfigure`, when the controller leaves the body, the node
  destroys the service and the clients.

Hint 1: Look at what the executor's thread does while a response is on its way. This thread has to be free to receive
it. And which callback group does the response need?

Hint 2: Make the callback a coroutine, async def, and await the futures of call_async. Give the two clients a separate
callback group, because the waiting callback occupies its own group.

Hint 3: In configure, group = MutuallyExclusiveCallbackGroup(), and create_client(..., callback_group=group) for both.
In the callback, opened = await self.open_door.call_async(Trigger.Request()), and return opened if not opened.success.
Otherwise, return the result of await self.go_home.call_async(Trigger.Request()).

Notice that a coroutine reads like a list of steps, and that no second thread is needed.
"""

from collections.abc import Iterator
from contextlib import closing, contextmanager

from rclpy.callback_groups import MutuallyExclusiveCallbackGroup
from std_srvs.srv import Trigger

from tutorial.checks.engine.bench import UNANSWERED, Bench
from tutorial.checks.engine.cases import Case, Cases, Run
from tutorial.checks.engine.failure import Failure, Misuse
from tutorial.checks.engine.trial import Trial
from tutorial.checks.exercise import Exercise
from tutorial.controller import ControllerConfig, SimpleController


class PitCrew(SimpleController):
    """Answer requests for a pit stop. Each pit stop requires two requests to other programs."""

    def configure(self, config: ControllerConfig) -> None:
        """Create the clients and the service."""
        self.node = config.node
        group = MutuallyExclusiveCallbackGroup()
        self.open_door = self.node.create_client(Trigger, "/open_door", callback_group=group)
        self.go_home = self.node.create_client(Trigger, "/go_home", callback_group=group)
        self.service = self.node.create_service(Trigger, "/pit_stop", self.on_pit_stop)

    async def on_pit_stop(self, _request: Trigger.Request, _response: Trigger.Response) -> Trigger.Response:
        """Open the door, and have the tank go home."""
        opened = await self.open_door.call_async(Trigger.Request())
        if not opened.success:
            return opened
        return await self.go_home.call_async(Trigger.Request())

    def unconfigure(self) -> None:
        """Destroy the service and the clients."""
        self.node.destroy_service(self.service)
        self.node.destroy_client(self.open_door)
        self.node.destroy_client(self.go_home)


NAMES = ["/go_home", "/open_door"]
CLIENTS = (
    "In configure, create one client for each service, on config.node and with the service's name: "
    "self.node.create_client(Trigger, '/open_door', ...)."
)
WRONG_ASK = (
    "config.ask is only for the simulation's thread, and it blocks its caller. "
    "Instead, await the future that call_async returns."
)


@contextmanager
def garage(trial: Trial, door: str = "open", home: str = "home") -> Iterator[Bench]:
    """Offer both services with the given replies, and configure the controller.

    Raises:
        Failure: `configure` has not created a client for each service.
    """
    with closing(Bench(trial, open_door=door, go_home=home)) as bench:
        bench.requests.close(WRONG_ASK)
        clients = sorted(each.service_name for each in bench.node.clients)
        if not {*NAMES} <= {*clients}:
            said = ", ".join(clients) or "none"
            raise Failure("configure", Misuse(f"clients of config.node: {said}; expected: {', '.join(NAMES)}", CLIENTS))
        yield bench


def stops(door: str = "open", home: str = "home", count: int = 1) -> Run:
    """Observe pit stops, one after another, with the given replies from both services."""

    def case(trial: Trial) -> str:
        with garage(trial, door, home) as bench:
            said = [bench.ask("/pit_stop") for _ in range(count)]
            if bench.timeouts:
                raise Failure("on_pit_stop", Misuse("it calls config.ask", WRONG_ASK))
            return f"{', then '.join(said)} ({', '.join(bench.asked) or 'no calls'})"

    return case


def left(trial: Trial) -> str:
    """Observe what the controller leaves behind after a pit stop and `unconfigure`."""
    with garage(trial) as bench:
        bench.ask("/pit_stop")
        return bench.leave()


CASES = [
    Case("a pit stop", stops(),
         "Your code probably returns too early, calls the services in the wrong order, or returns the wrong response. "
         "Await the response of /open_door, then the response of /go_home, and return the second response."),
    Case("a door that stays closed", stops(door="no key"),
         "Your code probably doesn't test opened.success, or returns a new response. If opened.success is False, "
         "return opened, and don't call /go_home."),
    Case("a tank that cannot go home", stops(home="no fuel"),
         "Your code probably reports success even if /go_home fails. Return the response of /go_home."),
    Case("two pit stops", stops(count=2),
         "Your code probably stores something during the first pit stop. Call both services for each request."),
    Case("after unconfigure", left,
         "Your code probably doesn't destroy everything. In unconfigure, destroy the service with "
         "node.destroy_service, and both clients with node.destroy_client."),
]  # fmt: skip
ask = Exercise("ask", __doc__, Cases(PitCrew, CASES, [], UNANSWERED, one_by_one=True))
