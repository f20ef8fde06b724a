"""The exercise `ask`: right answers in various styles, and wrong ones."""

import asyncio
import threading
from contextlib import suppress

import rclpy
from rclpy.callback_groups import MutuallyExclusiveCallbackGroup, ReentrantCallbackGroup
from std_srvs.srv import Trigger

from tutorial.checks.ask import PitCrew, ask
from tutorial.errors import RefusedError

from . import edited

GROUP = "MutuallyExclusiveCallbackGroup()"
OPEN, HOME = "self.open_door.call_async(Trigger.Request())", "self.go_home.call_async(Trigger.Request())"
OWN_GROUP = ("callback_group=group", "callback_group=None")
SYNC = ("async def", "def")


class OneGroupForAll(PitCrew):
    """Everything can run at any time, on the one thread."""

    def configure(self, config):
        self.node, group = config.node, ReentrantCallbackGroup()
        self.clients = [
            self.node.create_client(Trigger, name, callback_group=group) for name in ("/open_door", "/go_home")
        ]
        self.service = self.node.create_service(Trigger, "/pit_stop", self.on_request, callback_group=group)

    async def on_request(self, request, response):
        for client in self.clients:
            reply = await client.call_async(request)
            response.success, response.message = reply.success, reply.message
            if not reply.success:
                break
        return response

    def unconfigure(self):
        self.node.destroy_service(self.service)
        for client in self.clients:
            self.node.destroy_client(client)


class ServiceInItsOwnGroup(PitCrew):
    def configure(self, config):
        self.node = config.node
        self.open_door = self.node.create_client(Trigger, "/open_door")
        self.go_home = self.node.create_client(Trigger, "/go_home")
        group = MutuallyExclusiveCallbackGroup()
        self.service = self.node.create_service(Trigger, "pit_stop", self.on_pit_stop, callback_group=group)


class InSteps(PitCrew):
    async def on_pit_stop(self, _request, response):
        response.success, response.message = await self.open()
        return response

    async def open(self):
        opened = await self.open_door.call_async(Trigger.Request())
        return await self.drive() if opened.success else (False, opened.message)

    async def drive(self):
        home = await self.go_home.call_async(Trigger.Request())
        return home.success, home.message


class FuturesFirst(PitCrew):
    async def on_pit_stop(self, request, response):
        future = self.open_door.call_async(request)
        await future
        if future.result().success:
            future = self.go_home.call_async(request)
            await future
        return future.result()


class WaitsForTheServices(PitCrew):
    def configure(self, config):
        super().configure(config)
        self.open_door.wait_for_service()
        self.go_home.wait_for_service(timeout_sec=1.0)


RIGHT = [OneGroupForAll, ServiceInItsOwnGroup, InSteps, FuturesFirst, WaitsForTheServices]


class OnAThread(PitCrew):
    """Let a thread wait, and wait for the thread."""

    def on_pit_stop(self, request, response):
        waiting = threading.Thread(target=self.wait, args=[request, response], daemon=True)
        waiting.start()
        waiting.join(15.0)
        return response

    def wait(self, request, response):
        response.success = self.open_door.call(request).success


class WithADoneCallback(PitCrew):
    def on_pit_stop(self, request, response):
        self.open_door.call_async(request).add_done_callback(lambda _: self.go_home.call_async(request))
        return response


class CreatesClientsLate(PitCrew):
    """Create the clients at the first request."""

    def configure(self, config):
        self.node, self.group = config.node, MutuallyExclusiveCallbackGroup()
        self.service = self.node.create_service(Trigger, "/pit_stop", self.on_pit_stop)

    async def on_pit_stop(self, request, response):
        self.open_door = self.node.create_client(Trigger, "/open_door", callback_group=self.group)
        self.go_home = self.node.create_client(Trigger, "/go_home", callback_group=self.group)
        self.open_door.wait_for_service()
        return await super().on_pit_stop(request, response)


class OnASecondNode(PitCrew):
    """Create the clients on a second node, whose thread would receive the responses."""

    def configure(self, config):
        super().configure(config)
        self.node.destroy_client(self.go_home)
        self.other = rclpy.create_node("second", context=self.node.context)
        self.go_home = self.other.create_client(Trigger, "/go_home")


class Spins(PitCrew):
    """Spin the node in its own callback."""

    def on_pit_stop(self, request, response):
        self.node.executor.spin_until_future_complete(self.open_door.call_async(request))
        return response


class AsksTheSimulation(PitCrew):
    def configure(self, config):
        super().configure(config)
        self.ask = config.ask

    def on_pit_stop(self, request, response):
        return self.ask(self.open_door.call, request)


class AsksTheSimulationAnyway(AsksTheSimulation):
    def on_pit_stop(self, request, response):
        with suppress(RefusedError):
            return super().on_pit_stop(request, response)
        return response


class WithUntil(PitCrew):
    async def on_pit_stop(self, request, response):
        opening = self.open_door.call_async(request)
        await asyncio.sleep(0.1)
        return opening.result()


class OnlyOnce(PitCrew):
    """Open the door only for the first pit stop."""

    opened = None

    async def on_pit_stop(self, request, response):
        self.opened = self.opened or await self.open_door.call_async(request)
        return await self.go_home.call_async(request) if self.opened.success else self.opened


CALL = ("await self.open_door.call_async(", "self.open_door.call("), (f"await {HOME}", "self.go_home.call(_request)")
TOO_EARLY = "returns too early, calls the services in the wrong order, or returns the wrong response"
LEFT = "doesn't destroy everything"
WRONG = [
    (WithUntil, "await the future itself"),
    (edited(ask, SYNC, *CALL), "waits for a response that cannot arrive"),
    (
        edited(ask, SYNC, *CALL, ("call(Trigger.Request()", "call(_request, timeout_sec=0.1")),
        "waits for a response that cannot arrive",
    ),
    (edited(ask, OWN_GROUP), "that the waiting callback is not in"),
    (edited(ask, ("opened = await", "opened =")), "Write await before it"),
    (edited(ask, SYNC, (f"await {OPEN}", f"{OPEN}.result()"), ("await ", "")), "no result until it is done"),
    (WithADoneCallback, TOO_EARLY),
    (edited(ask, (OPEN, "self.second"), (HOME, OPEN), ("self.second", HOME)), TOO_EARLY),
    (edited(ask, (f"return await {HOME}", f"await {HOME}\nreturn opened")), TOO_EARLY),
    (edited(ask, (f"return await {HOME}", f"await {HOME}")), "forgot return"),
    (edited(ask, ("return opened", "return None")), "forgot return"),
    (edited(ask, ("return opened", "return opened.message")), "or returned something else"),
    (edited(ask, (", _response: Trigger.Response", "")), "with two arguments"),
    (edited(ask, (f"return await {HOME}", f"return {HOME}")), "call_async returns a future"),
    (edited(ask, SYNC, (f"opened = await {OPEN}", f"return {OPEN}"), ("await ", "")), "call_async returns a future"),
    (
        edited(ask, (f"opened = await {OPEN}", f"calls = {OPEN}, {HOME}\nopened = await calls[0]")),
        "Await each response before you call the next service",
    ),
    (CreatesClientsLate, "create one client for each service, on config.node"),
    (OnASecondNode, "create one client for each service, on config.node"),
    (edited(ask, ('"/go_home"', '"/Tank/go_home"')), "with the service's name"),
    (AsksTheSimulation, "Fix this line first"),
    (AsksTheSimulationAnyway, "config.ask is only for the simulation's thread"),
    (OnlyOnce, "Call both services for each request"),
    (edited(ask, ("if not opened.success:", "if not opened:")), "doesn't test opened.success"),
    (edited(ask, (f"return await {HOME}", f"await {HOME}\n_response.success = True\nreturn opened")), TOO_EARLY),
    (
        edited(ask, (f"return await {HOME}", f"home = await {HOME}\nhome.success = True\nreturn home")),
        "even if /go_home fails",
    ),
    (edited(ask, ("self.node.destroy_client(self.go_home)", "pass")), LEFT),
    (edited(ask, ("self.node.destroy_service(self.service)", "pass")), LEFT),
    (edited(ask, ('"/pit_stop"', '"/pitstop"')), "with a different name or type"),
    (OnAThread, "Never wait or loop in a callback"),  # last, because its service stays until its thread ends
    (edited(ask, ("call_async(Trigger.Request())", "call_async(Trigger)")), "can send only a Trigger.Request()"),
    (edited(ask, ("CallbackGroup()", "CallbackGroup")), "MutuallyExclusiveCallbackGroup() creates a group"),
    (Spins, "already spinning"),
]
