"""The exercise `find_cause`: say why the messages of a topic do not arrive.

Write the function `cause_of(facts)`. It returns the name of the first cause in this list that applies, or `None` if
all is well:

- `"domain"`: the topic has no publisher here, but it has one in another domain.
- `"nobody"`: the topic has no publisher at all.
- `"type"`: there is a subscription, and no publisher has its type.
- `"reliability"`: there is a `reliable` subscription, and no publisher of its type is `reliable`.
- `"durability"`: there is a `transient_local` subscription, and no publisher of its type that is reliable enough for it
  is `transient_local`.
- `"clock"`: no message arrives, the node of a publisher follows `/clock`, and no message arrives there, either.
- `"silent"`: there is a publisher, and no message arrives.
- `"dropped"`: messages arrive, and more than half of them move no joint.

One compatible publisher is enough for a subscription. In each graph, at most one subscription lacks one.

Hint 1: Look at the list of causes: without a publisher, only two are possible. And one compatible publisher is
enough for a subscription, so look at all publishers before you blame one.

Hint 2: Return early. Start with the two causes without a publisher. Then narrow down the publishers for each
subscription: first to those of its type, then to those that are also reliable enough, then to those that are also
durable enough. The first empty list names the cause. Only then look at the messages.

Hint 3: same = [each for each in facts.publishers if each.type == subscription.type], then [each for each in same if
each.reliable or not subscription.reliable], and the same with transient_local. If not facts.received: "clock" if
any(each.node in facts.clock_users for each in facts.publishers) and not facts.clock_ticks, otherwise "silent".

Notice that `tank doctor` works like this: it goes through a list of causes, and names the first that the facts support.
"""

from typing import Any

from tutorial.checks.engine.cases import Case, Cases, Mistake, Run, replace
from tutorial.checks.engine.failure import Misuse
from tutorial.checks.engine.trial import Trial
from tutorial.checks.exercise import Exercise
from tutorial.ros.doctor.facts import Endpoint, Facts


def cause_of(facts: Facts) -> str | None:
    """Return the name of the first cause that the facts support; None if all is well."""
    if not facts.publishers:
        return "domain" if facts.found_in else "nobody"
    for subscription in facts.subscriptions:
        same = [each for each in facts.publishers if each.type == subscription.type]
        reliable = [each for each in same if each.reliable or not subscription.reliable]
        durable = [each for each in reliable if each.transient_local or not subscription.transient_local]
        if not same:
            return "type"
        if not reliable:
            return "reliability"
        if not durable:
            return "durability"
    if not facts.received:
        waiting = any(each.node in facts.clock_users for each in facts.publishers)
        return "clock" if waiting and not facts.clock_ticks else "silent"
    return "dropped" if facts.unmoved > facts.received / 2 else None


MISTAKES = [
    Mistake("you require the same reliability on both sides. "
            "A subscription that is not reliable accepts any publisher.",
            replace("if each.reliable or not subscription.reliable", "if each.reliable == subscription.reliable",
                    "if each.reliable")),
    Mistake("you test reliability the wrong way round: the subscription asks, "
            "and the publisher has to offer at least as much.",
            replace("if each.reliable or not subscription.reliable", "if subscription.reliable or not each.reliable")),
    Mistake("you require the same durability on both sides. A VOLATILE subscription accepts any publisher.",
            replace("if each.transient_local or not subscription.transient_local",
                    "if each.transient_local == subscription.transient_local", "if each.transient_local")),
    Mistake("you test durability the wrong way round: the subscription asks, "
            "and the publisher has to offer at least as much.",
            replace("if each.transient_local or not subscription.transient_local",
                    "if subscription.transient_local or not each.transient_local")),
    Mistake("you check only the first publisher. A subscription needs one compatible publisher: check all of them.",
            replace("facts.publishers if each.type", "facts.publishers[:1] if each.type")),
    Mistake("you check only the first subscription. Check all of them: only one of them may be incompatible.",
            replace("in facts.subscriptions", "in facts.subscriptions[:1]")),
    Mistake("you require every publisher to be compatible. One is enough for a subscription.",
            replace("if not same:", "if len(same) < len(facts.publishers):")
            + replace("if not reliable:", "if len(reliable) < len(same):")
            + replace("if not durable:", "if len(durable) < len(reliable):")),
    Mistake("you blame the clock although its messages arrive. Also test clock_ticks.",
            replace("waiting and not facts.clock_ticks", "waiting")),
    Mistake("you blame the clock although no publisher follows it. "
            "Test whether the node of a publisher is in clock_users.",
            replace("waiting and not", "not", "facts.clock_users and not")),
    Mistake("you report dropped messages as soon as one moves no joint. It takes more than half of them.",
            replace("facts.unmoved > facts.received / 2", "facts.unmoved")),
    Mistake("you report dropped messages only if no message moves a joint. More than half is enough.",
            replace("facts.unmoved > facts.received / 2", "facts.unmoved == facts.received")),
]  # fmt: skip
MEANING = ("Compare your steps with these: without a publisher, domain or nobody. Then for each subscription "
           "type, reliability and durability, over all publishers. Then clock or silent, "
           "and finally dropped.")  # fmt: skip
NAMES = "domain", "nobody", "type", "reliability", "durability", "clock", "silent", "dropped"
A_NAME = f"Return one of {', '.join(map(repr, NAMES))}, or None."

JOINTS, IMU = "sensor_msgs/msg/JointState", "sensor_msgs/msg/Imu"
TANK, STRANGER = Endpoint("/tank", JOINTS), Endpoint("/stranger", IMU)
SPEAKER = Endpoint("/speaker", "std_msgs/msg/String")
SENSOR = Endpoint("/sensor", JOINTS, reliable=False)
KEEPER = Endpoint("/keeper", JOINTS, transient_local=True)
LOSER = Endpoint("/loser", JOINTS, reliable=False, transient_local=True)
VIEWER, LATE = Endpoint("/viewer", JOINTS), Endpoint("/late", JOINTS, transient_local=True)
EASY = Endpoint("/easy", JOINTS, reliable=False)


def graph(*publishers: Endpoint, to: tuple[Endpoint, ...] = (VIEWER,), received: int = 20, **more: Any) -> Run:
    """Observe the cause that the answer names for a graph."""
    facts = Facts(
        "/tank/joint_state",
        publishers=publishers,
        subscriptions=to,
        received=received if publishers else 0,
        seconds=4.0,
        **more,
    )
    return lambda trial: named(trial, facts)


def named(trial: Trial, facts: Facts) -> str:
    """Call the answer, and return the name of the cause.

    Raises:
        Misuse: there is no cause with the returned name.
    """
    returned = trial.call(trial.answer, facts)
    if returned is not None and returned not in NAMES:
        raise Misuse(f"it returns {returned!r}", A_NAME)
    return returned or "all is well"


ORDER = "You probably test the causes in a different order. Return the first one in the list that applies."
ALONE = "You probably look at something else first. Without a publisher, only found_in tells the two causes apart."
TYPES = "You probably don't compare the types of both sides: each.type == subscription.type."
CASES = [
    Case("a compatible publisher and subscription", graph(TANK)),
    Case("no publisher anywhere", graph(), ALONE, crashes=True),
    Case("a publisher in domain 5", graph(found_in=(5,)), ALONE, crashes=True),
    Case("publishers here and in domain 5", graph(TANK, found_in=(5,)),
         "You probably look at other domains although there is a publisher here. Otherwise, ignore found_in."),
    Case("a publisher of Imu messages", graph(STRANGER), TYPES),
    Case("a publisher of String messages", graph(SPEAKER), TYPES),
    Case("a best-effort publisher, a reliable subscription", graph(SENSOR)),
    Case("a reliable publisher, a best-effort subscription", graph(TANK, to=(EASY,))),
    Case("both best effort", graph(SENSOR, to=(EASY,))),
    Case("a volatile publisher, a transient local subscription", graph(TANK, to=(LATE,))),
    Case("a transient local publisher, a volatile subscription", graph(KEEPER)),
    Case("both transient local", graph(KEEPER, to=(LATE,))),
    Case("a transient local best-effort publisher, a subscription that asks for both", graph(LOSER, to=(LATE,)), ORDER),
    Case("two publishers, the second one is compatible", graph(SENSOR, TANK)),
    Case("two publishers, the first one is compatible", graph(KEEPER, TANK, to=(LATE,))),
    Case("two publishers: one is reliable, the other one keeps messages", graph(TANK, LOSER, to=(LATE,)),
         "You probably accept a reliable publisher and a durable one. A single publisher has to be both."),
    Case("two publishers, one of a different type", graph(STRANGER, TANK)),
    Case("two subscriptions, the second one refuses", graph(TANK, to=(VIEWER, LATE))),
    Case("no subscription", graph(TANK, to=())),
    Case("no message arrives", graph(TANK, received=0)),
    Case("no message arrives, and the types differ", graph(STRANGER, received=0), ORDER),
    Case("no message arrives, and the publisher follows /clock", graph(TANK, received=0, clock_users=("/tank",))),
    Case("no message arrives, the publisher follows /clock, which ticks",
         graph(TANK, received=0, clock_users=("/tank",), clock_ticks=200)),
    Case("no message arrives, and only the viewer follows /clock",
         graph(TANK, received=0, clock_users=("/viewer",))),
    Case("messages arrive without a clock", graph(TANK, clock_users=("/tank",)), ORDER),
    Case("no message moves a joint", graph(TANK, unmoved=20)),
    Case("12 of 20 messages move no joint", graph(TANK, unmoved=12)),
    Case("10 of 20 messages move no joint", graph(TANK, unmoved=10),
         "Half is not more than half: compare with >."),
    Case("1 of 20 messages moves no joint", graph(TANK, unmoved=1)),
]  # fmt: skip
find_cause = Exercise("find_cause", __doc__, Cases(cause_of, CASES, MISTAKES, MEANING))
