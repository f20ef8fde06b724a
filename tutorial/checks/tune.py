"""The exercise `tune`: parameters that other programs can set, and a check that refuses.

Write the controller `TrackLimits`. It declares two parameters of the program's node, `speed` and `turn` [m/s], with the
values 1.0 and 0.5. Both are doubles with a description and a range from 0.0 to 2.0.

- Their sum must not be above 2.5. The controller refuses values with a larger sum, and the reason contains the sum,
  such as `3.5`.
- If both are set together, only the new values matter.
- `limits()` returns the current values as a tuple, `(speed, turn)`.
- In `unconfigure`, when the controller leaves the body, it removes its callback and undeclares both parameters.

Hint 1: Look at what the callback gets: a list of the parameters that are being set, one or both. For a parameter that
is not in the list, use its current value.

Hint 2: In the callback, make a dict of the current values, and update it with the names and values of the list. Then
test the sum. The callback changes nothing itself: self.node.get_parameter(name).value is always the accepted value.

Hint 3: new = {"speed": ..., "turn": ...} from get_parameter, then new.update({each.name: each.value for each in
parameters}). If new["speed"] + new["turn"] > 2.5, return SetParametersResult(successful=False, reason=...), otherwise
SetParametersResult(successful=True). Register it with node.add_on_set_parameters_callback.

Notice that rclpy itself refuses wrong types and values outside the range, before it calls your callback.
"""

import warnings
from collections.abc import Sequence
from contextlib import closing
from typing import Any

from rcl_interfaces.msg import FloatingPointRange, ParameterDescriptor, SetParametersResult
from rclpy.parameter import Parameter

from tutorial.checks.engine.bench import Bench
from tutorial.checks.engine.cases import Case, Cases, Run
from tutorial.checks.engine.failure import Misuse
from tutorial.checks.engine.trial import Trial
from tutorial.checks.exercise import Exercise
from tutorial.controller import ControllerConfig, SimpleController


class TrackLimits(SimpleController):
    """Limit the speed and the turns of a tank."""

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
        """Refuse limits whose sum is too high."""
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


def tried(*sets: dict[str, Any], reason: str = "") -> Run:
    """Observe whether the node accepts values, and the limits afterwards. All values in a dict are set together.

    Args:
        sets: the values to set, one dict after another.
        reason: a text that the reason of a refusal has to contain.
    """

    def case(trial: Trial) -> str:
        said = []
        with closing(Bench(trial)) as bench:
            for values in sets:
                if "width" in values:
                    bench.node.declare_parameter("width", 0.4)
                given = [Parameter(name, value=value) for name, value in values.items()]
                with trial.calling("check"), warnings.catch_warnings():
                    warnings.simplefilter("ignore")  # rclpy warns if the callback returns anything else
                    result = bench.node.set_parameters_atomically(given)
                said.append("accepted" if result.successful else "refused")
                if not result.successful and reason not in result.reason:
                    said[-1] += f" with the reason {result.reason!r}"
            speed, turn = limits(trial, bench)
        return f"{', '.join(said)}: speed {speed:g}, turn {turn:g}"

    return case


def limits(trial: Trial, bench: Bench) -> tuple[float, float]:
    """Return the learner's limits."""
    with trial.calling("limits"):
        try:
            speed, turn = map(float, bench.learner.limits())
        except (TypeError, ValueError):
            raise Misuse("it does not return two numbers", "Return a tuple: (speed, turn).") from None
    return speed, turn


def described(trial: Trial) -> str:
    """Observe the declared parameters, and whether any of them remain at the end."""
    with closing(Bench(trial)) as bench:
        said = []
        for name in ("speed", "turn"):
            if not bench.node.has_parameter(name):
                raise Misuse(f"there is no parameter {name!r}", "In configure, declare it on config.node.")
            descriptor = bench.node.describe_parameter(name)
            ranges = [f"{each.from_value:g} to {each.to_value:g}" for each in descriptor.floating_point_range]
            said.append(f"{name} {bench.node.get_parameter(name).value!r}, {', '.join(ranges) or 'no range'}")
            said += ["no description"] * (not descriptor.description)
        return f"{', '.join(said)}; {bench.leave()}"


ALONE = (
    "You probably use only the new values, or only the current ones. Use the new value of each parameter that is in "
    "the list, and the current value of each other parameter."
)
CASES = [
    Case("the parameters, until unconfigure", described,
         "Declare both with a value, a description and a range, as doubles. In unconfigure, "
         "remove the callback and undeclare both parameters.", crashes=True),
    Case("speed 1.5", tried({"speed": 1.5}),
         "You probably refuse too much, don't return a SetParametersResult, or limits() returns old values. "
         "If the sum is at most 2.5, return SetParametersResult(successful=True)."),
    Case("speed 2.0", tried({"speed": 2.0}),
         "You probably refuse 2.5 itself, or test each parameter separately. Refuse only a larger sum: > 2.5."),
    Case("speed 2.0, then turn 1.5", tried({"speed": 2.0}, {"turn": 1.5}, reason="3.5"),
         "You probably use the first value of speed, compare with a different limit, or return a reason without the "
         "sum. Add the new turn and the current speed."),
    Case("both at once, 0.4 and 2.0", tried({"speed": 0.4, "turn": 2.0}), ALONE),
    Case("both at once, 2.0 and 0.6", tried({"speed": 2.0, "turn": 0.6}, reason="2.6"),
         "You probably test each parameter separately. Test the sum once, with all new values."),
    Case("a parameter of other code", tried({"width": 9.0, "turn": 0.7}),
         "You probably expect only your own parameters in the list. Ignore the other parameters.", crashes=True),
]  # fmt: skip
tune = Exercise("tune", __doc__, Cases(TrackLimits, CASES, [], ALONE, one_by_one=True))
