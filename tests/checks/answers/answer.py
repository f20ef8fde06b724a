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


class ForgetsReturn(AngleServer):
    def on_angle(self, request, response):
        response.message = f"{self.ask(lambda: None, timeout=0.5):.2f} rad"
        return response


class Polls(AngleServer):
    """Post, and look whether the answer is there."""

    def on_angle(self, request, response):
        texts = []

        def fetch():
            with suppress(RefusedError):
                texts.append(self.ask(self.read))

        threading.Thread(target=fetch, daemon=True).start()
        return Trigger.Response(success=bool(texts), message="".join(texts))


class Displayed(AngleServer):
    """Read the displayed body."""

    def configure(self, config):
        super().configure(config)
        self.joint = config.body.joint("TURRET_Y")

    def initialize(self, io):
        self.io = io


class DisplayedOnly(Displayed):
    def initialize(self, io):
        pass


class Later(AngleServer):
    """Have the main thread fill in the response, and return it before."""

    def configure(self, config):
        super().configure(config)
        self.call_later = config.call_later

    def on_angle(self, request, response):
        self.call_later(setattr, response, "message", "0.25 rad")
        return response


class Cached(AngleServer):
    """Respond with the value of the last step."""

    angle = 0.0

    def control(self):
        self.angle = self.joint.position

    def on_angle(self, request, response):
        return Trigger.Response(success=True, message=f"{self.angle:.2f} rad")


class AsksEarly(AngleServer):
    def configure(self, config):
        super().configure(config)
        self.text = config.ask(self.read)


class CreatesMore(AngleServer):
    """Create a service for each request."""

    def on_angle(self, request, response):
        self.service = self.node.create_service(Trigger, "Tank/angle", self.on_angle)
        return super().on_angle(request, response)


SUCCESS, CATCHES = "response.success = True", "except RefusedError as refusal:"
WRONG = [
    (
        edited(answer, (ASK, "self.read()"), ("RefusedError", "AttributeError")),
        "reads the joint on the executor's thread",
    ),
    (edited(answer, (ASK, "self.ask(lambda: 0) or self.read()")), "reads the joint on the executor's thread"),
    (edited(answer, ("timeout=0.5", "timeout=5.0")), "Your code probably omits the timeout"),
    (edited(answer, (", timeout=0.5", "")), "Your code probably omits the timeout"),
    (edited(answer, (CATCHES, "except KeyError as refusal:")), "Your code probably reports success"),
    (
        edited(answer, ("response.message = str(refusal)", f"response.message = str(refusal)\n{SUCCESS}")),
        "reports success",
    ),
    (edited(answer, ("str(refusal)", "'no'")), "set message to the error's text"),
    (edited(answer, ("return response", "pass")), "You probably forgot return"),
    (edited(answer, (SUCCESS, "pass")), "set response.success = True"),
    (edited(answer, ("timeout=0.5", "timeout=0.8")), "or uses a different one"),
    (edited(answer, ("timeout=0.5", "timeout=0.1")), "or uses a different one"),
    (edited(answer, ("{self.joint.position:.2f}", "{round(self.joint.position, 2)}")), "two decimal places"),
    (edited(answer, (":.2f} rad", ":.1f} rad")), "two decimal places"),
    (edited(answer, (":.2f} rad", ":.2f}")), "and then the unit"),
    (edited(answer, ("self.joint.position", "(self.joint.position * 57.2958)")), "already in radians"),
    (edited(answer, ("TURRET_Y", "TURRET_P")), "a different joint"),
    (edited(answer, ("{config.body.name}", "Tank")), "with a different name or type"),
    (edited(answer, (SERVICE, "pass")), "Your code probably doesn't create the service"),
    (edited(answer, (":.2f} rad", "} rad")), "two decimal places"),
    (edited(answer, ("self.node.destroy_service(self.service)", "pass")), "self.node.destroy_service"),
    (edited(answer, (ASK, "self.ask(self.read(), timeout=0.5)")), "Pass it without parentheses"),
    (ForgetsReturn, "probably lacks return"),
    (Sampled, "reads the joint only once"),
    (Polls, "before it has been filled in"),
    (Later, "before it has been filled in"),
    (Cached, "stores the angle in control"),
    (Displayed, "reads the joint of the displayed body"),
    (edited(answer, (ASK, "self.ask(self.read, 0.5)")), "as a keyword argument: timeout=0.5"),
    (edited(answer, ("def on_angle", "async def on_angle"), (ASK, f"await {ASK}")), "Remove await"),
    (
        edited(answer, ("_request: Trigger.Request, response", "response: Trigger.Request, _response")),
        "not have this field",
    ),
    (edited(answer, (ASK, f"len({ASK})")), "Set message to a string"),
    (edited(answer, ('joint("TURRET_Y")', 'joint["TURRET_Y"]')), "Fix this line first"),
    (edited(answer, ("self.node.destroy_service(self.service)", "self.node.destroy_node()")), "Destroy only what"),
    (
        edited(answer, ("response.message = self", "print(self"), ("timeout=0.5)", "timeout=0.5))")),
        "before it has been filled in",
    ),
    (AsksEarly, "There is no request yet"),
    (CreatesMore, "doesn't destroy the service"),
    (DisplayedOnly, "config.body is the displayed body"),
]
