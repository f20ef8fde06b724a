"""The mutants that are also right answers: a check must accept them."""

from tutorial.checks.catalogue import exercises

EXERCISES = {each.name: each for those in exercises().values() for each in those}


def becomes(line: str, *others: str) -> tuple[str, ...]:
    """Return a line's mutants."""
    return tuple(f"{line} → {other}" for other in others)


def swapped(one: str, other: str) -> str:
    """Return the mutant that swaps two consecutive statements."""
    return f"{one}; {other} → {other}; {one}"


UNRELATED = "neither statement depends on the other"
EVEN = "the remainder is never negative, and a multiple of n is also a multiple of -n"
WHAT_IS_TOLD = "an answer has to notify observers, but may choose the argument"
FIRST = "an answer may choose the step of the first message"

PRESSED = "pressed = len(message.buttons) > 0 and message.buttons[0] == 1"
FOUR_AXES = "axes = [*message.axes[:4], 0.0, 0.0, 0.0, 0.0][:4]"
AXES = "left_x, left_y = (axis if abs(axis) {} 0.3 else 0.0 for axis in axes[:2])"
DROPPED = "return 'dropped' if facts.unmoved > facts.received / 2 else None"
DURABLE = "durable = [each for each in reliable if each.transient_local or not subscription.transient_local]"
KEPT = "kept = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)"
KEPT_TURNED = "kept = QoSProfile(depth=DurabilityPolicy.TRANSIENT_LOCAL, durability=1)"
LATEST = "self.call_latest(self.body.name, self.update, message)"
TOLD = "self.body.notify_change({})"
TOLD_OTHERWISE = becomes(TOLD.format("report"), TOLD.format("message"), TOLD.format("positions"))
BLOWS = "self.subscription = self.node.create_subscription(Imu, f'{self.body.name}/imu', self.on_imu, 10)"

STAMP = "stamp = (message.header.stamp.sec, message.header.stamp.nanosec)"
STAMP_TURNED = "stamp = (message.header.stamp.nanosec, message.header.stamp.sec)"
TWO = "if len(together) == 2:"
DROP = "del self.waiting[next(iter(self.waiting))]"
COMPLETE = f"{TWO}; while stamp in self.waiting:; {DROP}; return (together['joints'], together['pose'])"
TOO_MANY = f"if len(self.waiting) > 50:; {DROP}"
OPEN_DOOR, GO_HOME = (
    f"self.{name} = self.node.create_client(Trigger, '/{name}', callback_group=group)"
    for name in ("open_door", "go_home")
)
PIT_STOP = "self.service = self.node.create_service(Trigger, '/pit_stop', self.on_pit_stop)"
DESCRIBED = "descriptor = ParameterDescriptor(description=f'limit of the {{{}}} [m/s]', floating_point_range=limits)"


def now_and_then(what: str, rate: int) -> dict[str, tuple[str, ...]]:
    """Return the mutants of an answer that does something at a rate: in its condition, and its number of steps."""
    step, steps = "self.io.step", f"self.steps_per_{what}"
    due = f"{step} % {steps} == 0"
    evens = (due.replace("==", "<="), f"-({step} % {steps}) == 0", f"-{due}", f"{step} % -{steps} == 0")
    line = f"{steps} = round(1 / ({rate} * io.time_step))"
    signs = (line.replace(part, f"-{part}") for part in (f"({rate} * io.time_step)", "io.time_step", "1 /", str(rate)))
    return {
        EVEN: (*becomes(f"if {due}:", *(f"if {even}:" for even in evens)), *becomes(line, *signs)),
        FIRST: becomes(f"if {due}:", f"if {step} % {steps} == 1:"),
    }


EQUIVALENT: dict[str, dict[str, tuple[str, ...]]] = {
    "fire": {
        "a length is never negative": becomes(PRESSED, PRESSED.replace(">", "!=")),
        "a button is 0 or 1": becomes(PRESSED, PRESSED.replace("==", ">=")),
    },
    "bound": {
        "the end of the line keeps only four values anyway": becomes(
            FOUR_AXES, FOUR_AXES.replace("axes[:4]", "axes[:5]")
        ),
    },
    "drive": {
        "an axis is a float32, and 0.3 is not one": becomes(AXES.format(">"), AXES.format(">=")),
        "of four values, all but the last two are the first two": becomes(
            AXES.format(">"), AXES.format(">").replace("[:2]", "[:-2]")
        ),
    },
    "publish": now_and_then("message", 25),
    "thrift": {
        UNRELATED: (swapped("self.publisher.publish(message)", "self.sent.update(news)"),),
        EVEN: now_and_then("look", 50)[EVEN],
    },
    "show": {WHAT_IS_TOLD: TOLD_OTHERWISE},
    "keep_up": {
        WHAT_IS_TOLD: TOLD_OTHERWISE,
        "any constant key works, because each controller has its own keys": becomes(
            LATEST, LATEST.replace("name", "joint_names")
        ),
    },
    "gyro": {
        UNRELATED: (swapped("self.publisher.publish(message)", "self.samples.clear()"),),
        **now_and_then("message", 10),
    },
    "hop": {
        UNRELATED: (
            swapped("self.node.destroy_subscription(self.subscription)", "self.land()"),
            swapped("timer.cancel()", "self.move(self.place)"),
            swapped("self.move((x, y, z + 0.1))", "self.timer = asyncio.get_running_loop().call_later(0.5, self.land)"),
        ),
        "a posted call runs on the main thread, and so not before configure has returned": (
            swapped("self.timer = None", BLOWS),
        ),
    },
    "pair": {
        "a function without a return returns None": becomes("return None", "nothing", "return"),
        "the order within a key does not matter": becomes(STAMP, STAMP_TURNED),
        "a stamp never has more than two messages": becomes(TWO, TWO.replace("==", ">=")),
        "a message that completes a pair does not make more messages wait": (swapped(COMPLETE, TOO_MANY),),
    },
    "gray": now_and_then("picture", 5),
    "gaps": {
        "the bag's own time is not used": becomes(
            "for _, message in messages:",
            "for message, message in messages:",
            "for stamp, message in messages:",
        ),
    },
    "find_cause": {
        "a number is whole": becomes(DROPPED, DROPPED.replace("/ 2", "// 2")),
        UNRELATED: (swapped(DURABLE, "if not same:; return 'type'"),),
        "it only matters whether the list is empty": becomes(
            DURABLE, DURABLE.replace("[each", "[same"), DURABLE.replace("[each", "[reliable")
        ),
    },
    "reach": {
        "TRANSIENT_LOCAL is 1": becomes(KEPT, KEPT_TURNED),
        "any depth keeps the newest message; rclpy replaces a depth of 0": becomes(
            KEPT, KEPT.replace("=1", "=2"), KEPT.replace("=1", "=0")
        ),
    },
    "ask": {
        UNRELATED: (swapped(OPEN_DOOR, GO_HOME),),
        "the check's first request comes after configure": (swapped(GO_HOME, PIT_STOP),),
    },
    "tune": {
        "an answer may choose the descriptions": becomes(*map(DESCRIBED.format, ("name", "limits", "value"))),
    },
}
