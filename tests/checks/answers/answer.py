"""The exercise `answer`: right answers in various styles, and wrong ones."""

import threading
from contextlib import suppress

from std_srvs.srv import Trigger

from tutorial.checks.answer import AngleServer, answer
from tutorial.errors import RefusedError, TutorialError

from . import edited

ASK = "self.ask(self.read, timeout=0.5)"
SERVICE = 'self.service = self.node.create_service(Trigger, f"{config.body.name}/angle", self.on_angle)'


class Returns(AngleServer):
    def on_angle(self, request, response):
        try:
            return Trigger.Response(success=True, message=self.ask(self.read, timeout=0.4))
        except RefusedError as refusal:
            return Trigger.Response(message=str(refusal))


class InPieces(AngleServer):
    """The simulation's thread reads a number, and the callback formats it."""

    def on_angle(self, request, response):
        try:
            position = self.ask(getattr, self.joint, "position", timeout=0.5)
        except (TutorialError, AttributeError) as refusal:
            response.success, response.message = False, str(refusal)
            if "joint" in response.message:
                response.message = "the simulation is not running. Start it, and ask again."
        else:
            response.success, response.message = True, f"{position:.2f} rad"
        return response


class KeepsTheBody(AngleServer):
    def initialize(self, io):
        self.simulated = io.body

    def read(self):
        return "{:.2f} rad".format(self.simulated.joint("TURRET_Y").position)


class WithALambda(AngleServer):
    def on_angle(self, request, response):
        response.success = False
        try:
            response.message = self.ask(lambda: f"{round(self.joint.position, 2):.2f} rad", timeout=0.5)
        except RefusedError as refusal:
            response.message = refusal.args[0]
        else:
            response.success = True
        return response


RIGHT = [Returns, InPieces, KeepsTheBody, WithALambda]


class Sampled(AngleServer):
    """Read the joint once, when the simulation starts."""

    def initialize(self, io):
        super().initialize(io)
        self.text = super().read()

    def read(self):
        return self.text


class Polls(AngleServer):
    """Post, and look whether the answer is there."""

    def on_angle(self, request, response):
        texts = []

        def fetch():
            with suppress(RefusedError):
                texts.append(self.ask(self.read))

        threading.Thread(target=fetch, daemon=True).start()
        return Trigger.Response(success=bool(texts), message="".join(texts))


SUCCESS, CATCHES = "response.success = True", "except RefusedError as refusal:"
WRONG = [
    (
        edited(answer, (ASK, "self.read()"), ("RefusedError", "AttributeError")),
        "read the joint on the executor's thread",
    ),
    (edited(answer, (ASK, "self.ask(lambda: 0) or self.read()")), "read the joint on the executor's thread"),
    (edited(answer, ("timeout=0.5", "timeout=5.0")), "You probably omit the timeout"),
    (edited(answer, (", timeout=0.5", "")), "You probably omit the timeout"),
    (edited(answer, (CATCHES, "except KeyError as refusal:")), "You probably report success"),
    (
        edited(answer, ("response.message = str(refusal)", f"response.message = str(refusal)\n{SUCCESS}")),
        "report success",
    ),
    (edited(answer, ("str(refusal)", "'no'")), "set message to the error's text"),
    (edited(answer, ("return response", "pass")), "You probably forgot return"),
    (edited(answer, (SUCCESS, "pass")), "read the joint on the executor's thread"),
    (edited(answer, ("{config.body.name}", "Tank")), "with a different name or type"),
    (edited(answer, (SERVICE, "pass")), "You probably don't create the service"),
    (edited(answer, (":.2f} rad", "} rad")), "self.ask(self.read, timeout=0.5)"),
    (edited(answer, ("self.node.destroy_service(self.service)", "pass")), "self.node.destroy_service"),
    (edited(answer, (ASK, "self.ask(self.read(), timeout=0.5)")), "read the joint on the executor's thread"),
    (Sampled, "or read it only once"),
    (Polls, "read the joint on the executor's thread"),
]
