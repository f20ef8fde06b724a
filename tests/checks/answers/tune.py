"""The exercise `tune`: right answers in various styles, and wrong ones."""

from rcl_interfaces.msg import FloatingPointRange, ParameterDescriptor, SetParametersResult

from tutorial.checks.tune import TrackLimits, tune

from . import edited

NEW = "new.update({each.name: each.value for each in parameters if each.name in new})"
REASON = 'reason=f"together {total:g} m/s, which is above 2.5"'
DECLARE = "self.node.declare_parameter(name, value, descriptor)"


EACH = (
    "total = max(each.value + dict(zip(('turn', 'speed'), self.limits())).get(each.name, 0.0) for each in parameters)"
)


class OneByOne(TrackLimits):
    def configure(self, config):
        self.node = config.node
        for name, value in {"speed": 1.0, "turn": 0.5}.items():
            descriptor = ParameterDescriptor(description=name)
            descriptor.floating_point_range.append(FloatingPointRange(from_value=0.0, to_value=2.0))
            self.node.declare_parameter(name, value=value, descriptor=descriptor)
        self.node.add_on_set_parameters_callback(self.check)


class Keeps(TrackLimits):
    """Keep the limits, and change them when they are accepted."""

    def configure(self, config):
        super().configure(config)
        self.now = {"speed": 1.0, "turn": 0.5}
        self.node.add_post_set_parameters_callback(self.use)

    def use(self, parameters):
        self.now.update({each.name: each.value for each in parameters if each.name in self.now})

    def limits(self):
        return tuple(self.now.values())

    def unconfigure(self):
        self.node.remove_post_set_parameters_callback(self.use)
        super().unconfigure()


class Loops(TrackLimits):
    def check(self, parameters):
        speed, turn = self.limits()
        for parameter in parameters:
            if parameter.name == "speed":
                speed = parameter.value
            elif parameter.name == "turn":
                turn = parameter.value
        fits = speed + turn <= 2.5
        return SetParametersResult(successful=fits, reason="" if fits else f"{speed + turn} is too much")


class TogetherDeclared(TrackLimits):
    def configure(self, config):
        self.node = config.node
        described = ParameterDescriptor(
            description="limit", floating_point_range=[FloatingPointRange(from_value=0.0, to_value=2.0)]
        )
        self.node.declare_parameters("", [("speed", 1.0, described), ("turn", 0.5, described)])
        self.node.add_on_set_parameters_callback(self.check)


class AsAList(TrackLimits):
    def limits(self):
        return [*super().limits()]


RIGHT = [OneByOne, Keeps, Loops, TogetherDeclared, AsAList]


class Stores(TrackLimits):
    """Store all new values in the callback."""

    def configure(self, config):
        self.now = {"speed": 1.0, "turn": 0.5}
        super().configure(config)

    def limits(self):
        return tuple(self.now.values())

    def check(self, parameters):
        self.now.update({each.name: each.value for each in parameters if each.name in self.now})
        return super().check([])


class StoresAccepted(Stores):
    """Store only values that the callback itself accepts, but other code may still refuse them."""

    def check(self, parameters):
        before = self.now.copy()
        result = super().check(parameters)
        self.now = self.now if result.successful else before
        return result


class OneAfterAnother(TrackLimits):
    """Test the sum after each value."""

    def check(self, parameters):
        new = dict(zip(("speed", "turn"), self.limits()))
        for each in parameters:
            new[each.name] = each.value
            if new["speed"] + new["turn"] > 2.5:
                return SetParametersResult(successful=False, reason=f"{new['speed'] + new['turn']:g} is above 2.5")
        return SetParametersResult(successful=True)


class SpeedFirst(OneAfterAnother):
    def check(self, parameters):
        return super().check(sorted(parameters, key=lambda each: each.name))


class LeavesACallback(Keeps):
    def unconfigure(self):
        TrackLimits.unconfigure(self)


class DeclaresLast(TrackLimits):
    def configure(self, config):
        config.node.add_on_set_parameters_callback(self.check)
        super().configure(config)


class Prefixed(TrackLimits):
    def configure(self, config):
        config.node.declare_parameters("Tank", [("speed", 1.0), ("turn", 0.5)])


class Sets(TrackLimits):
    """Set a parameter in the callback that checks parameters."""

    def check(self, parameters):
        self.node.set_parameters(parameters)
        return super().check(parameters)


class ReturnsEarly(TrackLimits):
    """Accept everything that other code sets as well."""

    def check(self, parameters):
        if any(each.name not in ("speed", "turn") for each in parameters):
            return SetParametersResult(successful=True)
        return super().check(parameters)


FIRST_TURN = ("self.limits()))", "(self.limits()[0], 0.5)))")
IF_TURN = ("if total > 2.5:", "if total > 2.5 and 'turn' in [each.name for each in parameters]:")
BOTH = ("if each.name in new})", "if each.name in new})\nnew = {each.name: each.value for each in parameters}")

WRONG = [
    (edited(tune, (NEW, "pass")), "Add the new turn to the current speed"),
    (edited(tune, ('dict(zip(("speed", "turn"), self.limits()))', '{"speed": 0.0, "turn": 0.0}')), "current speed"),
    (edited(tune, ('dict(zip(("speed", "turn"), self.limits()))', '{"speed": 1.0, "turn": 0.5}')), "the current speed"),
    (
        edited(tune, (" if each.name in new", ""), ('new["speed"] + new["turn"]', "sum(new.values())")),
        "Ignore all other parameters",
    ),
    (edited(tune, ('total = new["speed"] + new["turn"]', EACH)), "Your code probably uses only new values"),
    (edited(tune, ("> 2.5", "> 2.9")), "Test the sum once"),
    (edited(tune, (f", {REASON}", "")), "has to contain the sum of the new speed and turn: 3.5"),
    (
        edited(tune, ("return SetParametersResult(successful=True)", "return True")),
        "In every case, return SetParametersResult",
    ),
    (edited(tune, ("return SetParametersResult(successful=True)", "pass")), "In every case, return"),
    (
        edited(tune, ("self.node.add_on_set_parameters_callback(self.check)", "pass")),
        "only this callback can reject",
    ),
    (edited(tune, (DECLARE, "self.node.declare_parameter(name, value)")), "a description and a range"),
    (edited(tune, ('("turn", 0.5)', '("turn", 1)')), "a description and a range"),
    (edited(tune, ("to_value=2.0", "to_value=5.0")), "a description and a range"),
    (edited(tune, ('self.node.undeclare_parameter("turn")', "pass")), "undeclare both parameters"),
    (edited(tune, ("self.node.remove_on_set_parameters_callback(self.check)", "pass")), "remove the callback"),
    (
        edited(tune, ("if total > 2.5:", "if max(each.value for each in parameters) > 1.5:")),
        "or tests each parameter separately",
    ),
    (edited(tune, ("> 2.5", ">= 2.5")), "Your code probably rejects a sum of exactly 2.5"),
    (edited(tune, FIRST_TURN), "initial value of turn"),
    (edited(tune, IF_TURN), "tests the sum only if turn is in the list"),
    (edited(tune, BOTH), "expects both parameters in the list"),
    (edited(tune, ("to_value=2.0", "to_value=2.0, step=0.1")), "a range without a step size"),
    (edited(tune, ('self.node.get_parameter("speed").value, self.node', "1.0, self.node")), "or only once"),
    (
        edited(
            tune, ('self.node.get_parameter("speed").value, self.node', 'self.node.get_parameter("speed"), self.node')
        ),
        "whose value attribute holds the number",
    ),
    (
        edited(tune, ("return SetParametersResult(successful=False, reason=", "raise ValueError(")),
        "raises this error itself",
    ),
    (
        edited(tune, ("add_on_set_parameters_callback(self.check)", "add_on_set_parameters_callback(self.check([]))")),
        "without parentheses",
    ),
    (
        edited(tune, ("    def limits", "    @property\n    def limits"), ("self.limits()", "self.limits")),
        "without @property",
    ),
    (
        edited(tune, ("limits = [FloatingPointRange(from_value=0.0, to_value=2.0)]", "limits = FloatingPointRange()")),
        "list",
    ),
    (edited(tune, ("description=f", "read_only=True, description=f")), "Declare both as doubles"),
    (Sets, "the recursion never ends"),
    (ReturnsEarly, "returns when it finds a different one"),
    (Prefixed, "with exactly this name"),
    (Stores, "stored too early"),
    (StoresAccepted, "stored too early"),
    (OneAfterAnother, "before it has all the new values"),
    (SpeedFirst, "before it has all the new values"),
    (LeavesACallback, "remove the callback"),
    (DeclaresLast, "add your callback after all declarations"),
]
