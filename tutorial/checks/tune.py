"""The exercise `tune`: parameters that other programs can set, and a check that can reject new values.

Write the controller `TrackLimits`. On the program's node, it declares two parameters, `speed` and `turn` [m/s], with
the initial values 1.0 and 0.5. Both are doubles with a description and a range from 0.0 to 2.0, without a step size.

- Their sum must not exceed 2.5. The controller rejects values with a larger sum, and the reason contains the sum, such
  as `3.5`.
- If both are set together, only the new values matter. The controller ignores other parameters.
- `limits()` returns the current values as a list or tuple, `(speed, turn)`.
- In `unconfigure`, when the controller leaves the body, it removes its callback and undeclares both parameters.

Hint 1: Look at what the callback gets: a list of the parameters that are being set, one or both. For a parameter that
is not in the list, use its current value.

Hint 2: In the callback, make a dict of the current values, and update it with the names and values in the list. Then
test the sum. The callback changes nothing itself: self.node.get_parameter(name).value is always the accepted value.

Hint 3: new = {"speed": ..., "turn": ...} from get_parameter, then new.update({each.name: each.value for each in
parameters}). If new["speed"] + new["turn"] > 2.5, return SetParametersResult(successful=False, reason=...), otherwise
SetParametersResult(successful=True). Register the callback with node.add_on_set_parameters_callback.

Notice that rclpy itself rejects values of the wrong type or out of range, before it calls your callback.
"""

import warnings
from collections.abc import Sequence
from contextlib import closing
from typing import Any

from rcl_interfaces.msg import FloatingPointRange, ParameterDescriptor, SetParametersResult
from rclpy.parameter import Parameter

from tutorial.checks.engine.answer import name_of
from tutorial.checks.engine.bench import Bench
from tutorial.checks.engine.cases import Case, Cases, Run
from tutorial.checks.engine.failure import Failure, Misuse
from tutorial.checks.engine.trial import Trial
from tutorial.checks.exercise import Exercise
from tutorial.controller import ControllerConfig, SimpleController


class TrackLimits(SimpleController):
    """Limit how fast a tank drives and turns."""

    def configure(self, config: ControllerConfig) -> None:
        """Declare the parameters."""
        self.node = config.node
        limits = [FloatingPointRange(from_value=0.0, to_value=2.0)]
        for name, value in (("speed", 1.0), ("turn", 0.5)):
            descriptor = ParameterDescriptor(description=f"limit of the {name} [m/s]", floating_point_range=limits)
            self.node.declare_parameter(name, value, descriptor)
        self.node.add_on_set_parameters_callback(self.check)

    def limits(self) -> tuple[float, float]:
        """Return the limits."""
        return self.node.get_parameter("speed").value, self.node.get_parameter("turn").value

    def check(self, parameters: Sequence[Parameter]) -> SetParametersResult:
        """Reject limits whose sum is too large."""
        new = dict(zip(("speed", "turn"), self.limits()))
        new.update({each.name: each.value for each in parameters if each.name in new})
        total = new["speed"] + new["turn"]
        if total > 2.5:
            return SetParametersResult(successful=False, reason=f"together {total:g} m/s, which is above 2.5")
        return SetParametersResult(successful=True)

    def unconfigure(self) -> None:
        """Remove the callback and the parameters."""
        self.node.remove_on_set_parameters_callback(self.check)
        self.node.undeclare_parameter("speed")
        self.node.undeclare_parameter("turn")


RCLPYS_OWN = "_on_parameter_event"  # the callback for use_sim_time, which every node has
NO_CALLBACK = (
    "In configure, add it with self.node.add_on_set_parameters_callback: only this callback can reject a value and "
    "give a reason."
)
RESULT = "In every case, return SetParametersResult(successful=True), or successful=False with a reason."


def tried(*sets: dict[str, Any], reason: str = "", vetoed: bool = False) -> Run:
    """Observe whether the node accepts values, and what the limits are afterwards.

    Args:
        sets: the values to set, one dict after another. All values in a dict are set together.
        reason: text that the reason for a rejection has to contain.
        vetoed: whether a callback added by other code, which runs last, rejects all values.
    """

    def case(trial: Trial) -> str:
        said = []
        with closing(Bench(trial)) as bench:
            callbacks = bench.node._on_set_parameters_callbacks
            method = name_of(callbacks[0])
            if method == RCLPYS_OWN:
                made = bench.created()
                raise Failure(
                    "configure", Misuse(f"it adds no callback that can reject values; it creates {made}", NO_CALLBACK)
                )
            callbacks += [lambda _: SetParametersResult(successful=False)] * vetoed
            for values in sets:
                given = [Parameter(name, value=value) for name, value in values.items()]
                with trial.calling(method), warnings.catch_warnings():
                    warnings.simplefilter("ignore")  # rclpy warns if the callback's result has the wrong type
                    result = bench.node.set_parameters_atomically(given)
                if "invalid type" in result.reason:
                    raise Failure(method, Misuse("it returns no SetParametersResult", RESULT))
                said.append("accepted" if result.successful else "rejected")
                if not result.successful and reason not in result.reason:
                    cause = f"The reason has to contain the sum of the new speed and turn: {reason}."
                    raise Failure(method, Misuse(f"the reason is {result.reason!r}", cause))
            speed, turn = limits(trial, bench)
        return f"{', '.join(said)}: speed {speed:g}, turn {turn:g}"

    return case


def limits(trial: Trial, bench: Bench) -> tuple[float, float]:
    """Return the learner's limits, which have to equal the parameters' values."""
    with trial.calling("limits"):
        if not callable(bench.learner.limits):
            raise Misuse("it is no method", "Write it without @property: def limits(self):")
        returned = bench.learner.limits()
        try:
            speed, turn = map(float, returned)
        except (TypeError, ValueError):
            parts = returned if isinstance(returned, (tuple, list)) else [returned]
            kinds = ", ".join(type(each).__name__ for each in parts)
            raise Misuse(f"it returns {len(parts)} of type {kinds}, not two numbers", NUMBERS) from None
        values = [bench.node.get_parameter(name).value for name in ("speed", "turn")]
        if [speed, turn] != values:
            raise Misuse(f"it returns {(speed, turn)}, but the parameters are {(*values,)}", STORED)
    return speed, turn


def described(trial: Trial) -> str:
    """Observe the declared parameters."""
    with closing(Bench(trial)) as bench:
        said = []
        for name in ("speed", "turn"):
            if not bench.node.has_parameter(name):
                text = f"there is no parameter {name!r}; it creates {bench.created() or 'nothing'}"
                raise Misuse(text, "In configure, declare the parameter on config.node, with exactly this name.")
            descriptor = bench.node.describe_parameter(name)
            ranges = [
                f"{each.from_value:g} to {each.to_value:g}{f' in steps of {each.step:g}' if each.step else ''}"
                for each in descriptor.floating_point_range
            ]
            parameter = bench.node.get_parameter(name)
            kind = parameter.type_.name.lower()
            said.append(f"{name} {parameter.value!r} ({kind}), {', '.join(ranges) or 'no range'}")
            said += ["no description"] * (not descriptor.description) + ["read-only"] * descriptor.read_only
        return ", ".join(said)


def left(trial: Trial) -> str:
    """Observe what remains after the controller has left the body."""
    with closing(Bench(trial)) as bench:
        return bench.leave()


NUMBERS = (
    "Return a tuple: (speed, turn). get_parameter returns a Parameter, whose value attribute holds the number: "
    "self.node.get_parameter('speed').value."
)
STORED = (
    "limits() probably returns the values in the wrong order, or values that your code stored too early, or only once. "
    "Return self.node.get_parameter(name).value for both parameters: rejected values are never stored there."
)
ALONE = (
    "Your code probably uses only new values, or only current ones, or tests the sum before it has all the new values. "
    "Use the new value of each parameter in the list, and the current value of a parameter that is not in the list. "
    "Then test the sum once."
)
CASES = [
    Case("the parameters", described,
         "Declare both as doubles, with a value, a description and a range without a step size. "
         "Put the range in a list: floating_point_range=[FloatingPointRange(from_value=0.0, to_value=2.0)]."),
    Case("speed 1.5", tried({"speed": 1.5}),
         "The callback probably expects both parameters in the list, or rejects valid values. "
         "If the sum is at most 2.5, return SetParametersResult(successful=True).", crashes=True),
    Case("speed 2.0", tried({"speed": 2.0}),
         "Your code probably rejects a sum of exactly 2.5, or tests each parameter separately. "
         "Reject only a larger sum: > 2.5."),
    Case("speed 2.0, then turn 1.5", tried({"speed": 2.0}, {"turn": 1.5}, reason="3.5"),
         "Your code probably uses only the values in the list, uses initial or current values instead of the new ones, "
         "or compares the sum with a different limit. Add the new turn to the current speed, and reject a sum above "
         "2.5."),
    Case("turn 1.5, then speed 2.0", tried({"turn": 1.5}, {"speed": 2.0}, reason="3.5"),
         "Your code probably uses the initial value of turn, or tests the sum only if turn is in the list. "
         "Add the new speed to the current turn."),
    Case("speed 0.4 and turn 2.0 at once", tried({"turn": 2.0, "speed": 0.4}), ALONE),
    Case("turn 1.5, then speed 2.0 and turn 0.4 at once", tried({"turn": 1.5}, {"speed": 2.0, "turn": 0.4}), ALONE),
    Case("speed 2.0 and turn 0.6 at once", tried({"speed": 2.0, "turn": 0.6}, reason="2.6"),
         "Your code probably tests each parameter separately. Test the sum once, with all new values."),
    Case("a parameter that other code declared", tried({"width": 9.0, "turn": 0.7}, {"width": 1.0, "turn": 1.6}),
         "The callback probably expects only its own parameters in the list, or returns when it finds a different one. "
         "Ignore all other parameters, and test the sum of speed and turn.", crashes=True),
    Case("speed 1.5, rejected by a different callback", tried({"speed": 1.5}, vetoed=True)),
    Case("after unconfigure", left,
         "In unconfigure, remove the callback with remove_on_set_parameters_callback, and undeclare both parameters."),
]  # fmt: skip
tune = Exercise("tune", __doc__, Cases(TrackLimits, CASES, [], ALONE, one_by_one=True))
