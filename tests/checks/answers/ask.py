"""The exercise `ask`: right answers in various styles, and wrong ones."""

import threading

from rclpy.callback_groups import MutuallyExclusiveCallbackGroup, ReentrantCallbackGroup
from std_srvs.srv import Trigger

from tutorial.checks.ask import PitCrew, ask

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


RIGHT = [OneGroupForAll, ServiceInItsOwnGroup, InSteps, FuturesFirst]


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


CALL = ("await self.open_door.call_async(", "self.open_door.call("), (f"await {HOME}", "self.go_home.call(_request)")
TOO_EARLY = "return too early, ask in a different order, or return the wrong response"
LEFT = "don't destroy everything"
WRONG = [
    (edited(ask, SYNC, *CALL), "wait for a response that cannot arrive"),
    (
        edited(ask, SYNC, *CALL, ("call(Trigger.Request()", "call(_request, timeout_sec=0.1")),
        "wait for a response that cannot arrive",
    ),
    (edited(ask, OWN_GROUP), "callback group of their own"),
    (edited(ask, ("opened = await", "opened =")), "Write await before it"),
    (edited(ask, SYNC, (f"await {OPEN}", f"{OPEN}.result()"), ("await ", "")), "no result before it is done"),
    (WithADoneCallback, TOO_EARLY),
    (edited(ask, (OPEN, "self.second"), (HOME, OPEN), ("self.second", HOME)), TOO_EARLY),
    (edited(ask, (f"return await {HOME}", f"await {HOME}\nreturn opened")), TOO_EARLY),
    (edited(ask, (f"return await {HOME}", f"await {HOME}")), "forgot return"),
    (edited(ask, ("if not opened.success:", "if not opened:")), "don't test opened.success"),
    (edited(ask, (f"return await {HOME}", f"await {HOME}\n_response.success = True\nreturn opened")), TOO_EARLY),
    (
        edited(ask, (f"return await {HOME}", f"home = await {HOME}\nhome.success = True\nreturn home")),
        "even if /go_home fails",
    ),
    (edited(ask, ("self.node.destroy_client(self.go_home)", "pass")), LEFT),
    (edited(ask, ("self.node.destroy_service(self.service)", "pass")), LEFT),
    (edited(ask, ('"/pit_stop"', '"/pitstop"')), "with a different name or type"),
    (OnAThread, "Never wait or loop in a callback"),  # last, because its service stays until its thread ends
]
