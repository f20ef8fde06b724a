"""The exercise `answer`: have the simulation's thread carry out a request, and answer it.

Write the controller `AngleServer`. It offers the service `angle` (type `Trigger`) of its body; for the body `Tank`,
this is `/Tank/angle`. The response reports the angle of the simulated body's joint `TURRET_Y`.

- The simulated body belongs to the simulation's thread. During a step, its joints hold intermediate values, so only
  this thread may read the joints, and only between two steps: use `config.ask`.
- The message is the angle with two decimal places, such as `0.25 rad`, and `success` is True.
- If the angle cannot be read within 0.5 s, `success` is False, and the message is the text of the `RefusedError`.
  Therefore, no client waits much longer than 0.5 s.
- The controller works on any body. In `unconfigure`, when the controller leaves the body, the node destroys the
  service.

Hint 1: Look at the three threads: configure runs on the main thread, the callback on the executor's thread, and the
joint belongs to the simulation's thread. Which method gives you the simulated body, and on which thread does it run?

Hint 2: Store config.ask in configure, and the joint in initialize. Write a method that returns the text, and have the
callback ask for it, with a timeout. If the request is refused, ask raises RefusedError.

Hint 3: In the callback, try response.message = self.ask(self.read, timeout=0.5), then set response.success = True.
In the clause except RefusedError as refusal, set response.message = str(refusal). Return the response in both cases.

Notice that the callback waits, which a callback should not do; but it waits only for another thread, and never for
long.
"""

import math
import re
import threading
from collections.abc import Iterator
from contextlib import closing, contextmanager

from std_srvs.srv import Trigger

from tutorial.checks.engine.bench import Bench
from tutorial.checks.engine.cases import Case, Cases, Run
from tutorial.checks.engine.failure import Failure, Misuse
from tutorial.checks.engine.trial import Trial
from tutorial.checks.exercise import Exercise
from tutorial.controller import ControllerConfig, ControllerIO, SimpleController
from tutorial.errors import RefusedError

STEP = 0.02  # [s]
LONG_STEP = 1.2  # [s]
ENOUGH = 1.0  # [s] time limit for the response to a request
TIMEOUTS = 0.3, 0.7  # [s] the shortest and the longest wait that count as 0.5 s
# Angles that a correct answer never reads [rad]
DISPLAYED, FIRST, DURING, BARREL, STORED = 3.33, 5.55, 9.99, 7.77, 8.88

ASK = "Have the simulation's thread read the joint for each request: self.ask(self.read, timeout=0.5)."
READ = {
    DISPLAYED: "Your code probably reads the joint of the displayed body, config.body. "
    "The simulated body is io.body in initialize.",
    FIRST: f"Your code probably reads the joint only once, in initialize. {ASK}",
    DURING: "Your code probably reads the joint on the executor's thread, in the middle of a step. Read the joint's "
    "position in the function that the simulation's thread runs: self.ask(self.read, timeout=0.5).",
    STORED: f"Your code probably stores the angle in control, so the stored angle is soon out of date. {ASK}",
    BARREL: "Your code probably reads a different joint. The turret's joint is TURRET_Y.",
}
"""The likely cause of each wrong angle."""
FORMAT = 'The number is right. Write two decimal places, even if they are 0, and then the unit: f"{angle:.2f} rad".'
DEGREES = "Your code probably converts the angle to degrees. The joint's position is already in radians."
FAILED = "The angle is right, but success is False. Once ask has returned, set response.success = True."
EMPTY = (
    "Your code probably returns the response before it has been filled in. call_later returns immediately, without "
    "a result; ask waits for the result. Set success and message, then return the response."
)
NEVER = f"You never call config.ask. {ASK}"


class AngleServer(SimpleController):
    """Report the turret's angle on request."""

    def configure(self, config: ControllerConfig) -> None:
        """Create the service, which is named after the body."""
        self.node = config.node
        self.ask = config.ask
        self.service = self.node.create_service(Trigger, f"{config.body.name}/angle", self.on_angle)

    def initialize(self, io: ControllerIO) -> None:
        """Look up the joint."""
        self.joint = io.body.joint("TURRET_Y")

    def on_angle(self, _request: Trigger.Request, response: Trigger.Response) -> Trigger.Response:
        """Have the simulation's thread read the angle."""
        try:
            response.message = self.ask(self.read, timeout=0.5)
            response.success = True
        except RefusedError as refusal:
            response.message = str(refusal)
        return response

    def read(self) -> str:
        """Return the angle as text."""
        return f"{self.joint.position:.2f} rad"

    def unconfigure(self) -> None:
        """Stop answering."""
        self.node.destroy_service(self.service)


@contextmanager
def simulated(bench: Bench, angle: float, step: float = STEP) -> Iterator[None]:
    """Simulate steps on a separate thread. The turret has the given angle [rad] only between two steps.

    Raises:
        Failure: one of the learner's methods raised an exception.
    """
    done, failures = threading.Event(), list[Failure]()

    def run() -> None:
        bench.displayed.set_joint_positions({"TURRET_Y": DISPLAYED})
        bench.body.set_joint_positions({"TURRET_Y": FIRST, "TURRET_P": BARREL})
        try:
            bench.do("initialize", ControllerIO(bench.body, 0.001))
            while not done.is_set():
                bench.body.set_joint_positions({"TURRET_Y": STORED})
                bench.do("control")
                bench.body.set_joint_positions({"TURRET_Y": DURING})
                done.wait(step)
                bench.body.set_joint_positions({"TURRET_Y": angle})
                bench.requests.run_waiting()
        except Failure as failure:
            failures.append(failure)

    thread = threading.Thread(target=run, name="simulation")
    bench.requests.open(thread)
    thread.start()
    try:
        yield
    finally:
        done.set()
        bench.requests.close()
        thread.join()
        if failures:
            raise failures[0]


def read(name: str, *angles: float) -> Run:
    """Observe the responses in a simulation of a body whose turret is set to one angle after another."""

    def case(trial: Trial) -> str:
        said = []
        with closing(Bench(trial, name)) as bench:
            for angle in angles:
                with simulated(bench, angle):
                    said += [angle_from(bench, f"/{name}/angle", angle) for _ in range(3)]
        return ", ".join(dict.fromkeys(said))

    return case


def angle_from(bench: Bench, service: str, angle: float) -> str:
    """Make a request, and return a description of the response.

    Raises:
        Failure: the response does not report the angle [rad], and the likely cause is known.
    """
    said, wanted = bench.ask(service), f"yes: {angle:.2f} rad"
    number = float((re.search(r"-?\d+(\.\d+)?", said) or ["nan"])[0])
    known = {**READ, angle: FAILED if said.startswith("no") else FORMAT, math.degrees(angle): DEGREES}
    causes = [cause for value, cause in known.items() if abs(number - value) < 0.06]
    causes += [EMPTY] * said.endswith(": ") + [NEVER] * (not bench.timeouts)
    if said != wanted and causes:
        raise Failure(service, Misuse(f"{said}; expected: {wanted}", causes[0]))
    return said


def refused(trial: Trial) -> str:
    """Observe the response when no simulation is running."""
    with closing(Bench(trial)) as bench:
        return bench.ask("/Tank/angle")


def late(trial: Trial) -> str:
    """Observe the response while a step takes too long."""
    with closing(Bench(trial)) as bench, simulated(bench, 0.5, LONG_STEP):
        said = bench.ask("/Tank/angle")
        waits, (shortest, longest) = sum(bench.timeouts), TIMEOUTS
        is_refused = said.startswith("no: the simulation") and bench.took < ENOUGH and shortest <= waits <= longest
        return "refused in time" if is_refused else f"a timeout of {waits:g} s, after {bench.took:.1f} s {said}"


def left(trial: Trial) -> str:
    """Observe what the controller leaves behind after a request and `unconfigure`."""
    with closing(Bench(trial)) as bench:
        bench.ask("/Tank/angle")
        return bench.leave()


WHERE = f"Your code probably reads the joint only once, or on the executor's thread, in the middle of a step. {ASK}"
HOW = "Pass the request to the simulation's thread, and wait for the answer: self.ask(self.read, timeout=0.5)."
CASES = [
    Case("in a simulation, with the turret at 0.25 rad", read("Tank", 0.25), WHERE),
    Case("on the body Rover, in two simulations", read("Rover", -0.5, 1.0), WHERE),
    Case("without a simulation", refused,
         "Your code probably reports success, uses its own text, or doesn't catch the error. If ask raises a "
         "RefusedError, set message to the error's text, and success to False.", crashes=True),
    Case("while a step takes 1.2 s", late,
         "Your code probably omits the timeout, or uses a different one. Write self.ask(self.read, timeout=0.5)."),
    Case("after unconfigure", left,
         "Your code probably doesn't destroy the service. In unconfigure: self.node.destroy_service(self.service)."),
]  # fmt: skip
answer = Exercise("answer", __doc__, Cases(AngleServer, CASES, [], HOW, one_by_one=True))
