"""The exercise `find_cause`: find out why the messages of a topic do not arrive.

Write the function `cause_of(facts)`. It returns the name of the first cause in this list that applies, or `None` if
all is well:

- `"domain"`: the topic has no publisher in this domain, but it has one in another domain.
- `"nobody"`: the topic has no publisher at all.
- `"type"`: a subscription has no publisher of its type.
- `"reliability"`: a `reliable` subscription has no `reliable` publisher of its type.
- `"durability"`: a `transient_local` subscription has no publisher of its type that is both reliable enough and
  `transient_local`.
- `"clock"`: no message arrives, at least one publisher's node follows `/clock`, and no message arrives on `/clock`
  either.
- `"silent"`: there is a publisher, but no message arrives.
- `"dropped"`: messages arrive, but more than half of them move no joint.

One compatible publisher is enough for a subscription. In each graph, at most one subscription has no compatible
publisher. `clock_users` holds the full names of nodes, such as `"/tank"`.

Hint 1: Look at the list of causes: without a publisher, only two of them are possible. And one compatible publisher is
enough for a subscription, so look at all publishers before you return a cause.

Hint 2: Return early. Start with the two causes that are possible without a publisher. Then narrow down the publishers
for each subscription: first to those of its type, then to those that are also reliable enough, then to those that are
also durable enough. The first list that is empty determines the cause. Only then look at the messages.

Hint 3: same = [each for each in facts.publishers if each.type == subscription.type], then [each for each in same if
each.reliable or not subscription.reliable], and the same with transient_local. If not facts.received: "clock" if
any(each.node in facts.clock_users for each in facts.publishers) and not facts.clock_ticks, otherwise "silent".

Notice that `tank doctor` works like this: it goes through a list of causes and names the first cause that the facts
support.
"""

import sys
from contextlib import redirect_stdout
from io import StringIO
from typing import Any

from tutorial.checks.engine.cases import Case, Cases, Mistake, Run, both, replace
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


REVERSED = replace(
    "if not reliable:",
    "if not subscription.reliable and all(each.reliable for each in same):",
    "if not subscription.reliable and any(each.reliable for each in same):",
)
MISTAKES = [
    Mistake("your code requires the same reliability on both sides. "
            "A best-effort subscription accepts both best-effort and reliable publishers.",
            replace("if each.reliable or not subscription.reliable", "if each.reliable == subscription.reliable",
                    "if each.reliable")),
    Mistake("your code tests reliability the wrong way round: the publisher has to offer at least what the "
            "subscription requests.",
            replace("if each.reliable or not subscription.reliable", "if subscription.reliable or not each.reliable")
            + REVERSED
            + both(REVERSED, replace("if not durable:", "if subscription.transient_local and not durable:"))),
    Mistake("your code requires the same durability on both sides. "
            "A volatile subscription accepts both volatile and transient local publishers.",
            replace("if each.transient_local or not subscription.transient_local",
                    "if each.transient_local == subscription.transient_local", "if each.transient_local")),
    Mistake("your code tests durability the wrong way round: the publisher has to offer at least what the "
            "subscription requests.",
            replace("if each.transient_local or not subscription.transient_local",
                    "if subscription.transient_local or not each.transient_local")
            + replace("if not durable:",
                      "if not subscription.transient_local and all(each.transient_local for each in reliable):",
                      "if not subscription.transient_local and any(each.transient_local for each in reliable):")),
    Mistake("your code checks only the first publisher. "
            "A subscription needs only one compatible publisher: check all publishers.",
            replace("facts.publishers if each.type", "facts.publishers[:1] if each.type")
            + replace("if not same:", "if facts.publishers[0].type != subscription.type:")
            + replace("if not reliable:", "if subscription.reliable and not facts.publishers[0].reliable:")),
    Mistake("your code checks only the first subscription. "
            "Check all subscriptions, because any of them can be incompatible.",
            replace("in facts.subscriptions", "in facts.subscriptions[:1]")),
    Mistake("your code requires every publisher to be compatible. "
            "One compatible publisher is enough for a subscription.",
            replace("if not same:", "if len(same) < len(facts.publishers):")
            + replace("if not reliable:", "if len(reliable) < len(same):")
            + replace("if not durable:", "if len(durable) < len(reliable):")),
    Mistake("your code compares the types too late, or not at all. Return the first cause in the list that applies.",
            replace("if not same:", "if subscription.reliable and not reliable:\n    return 'reliability'\n"
                                    "if not same:")
            + replace('return "type"', "pass")),
    Mistake("your code looks at the messages before the subscriptions. "
            "Return the first cause in the list that applies.",
            replace("for subscription in facts",
                    "if not facts.received:\n"
                    "    waiting = any(each.node in facts.clock_users for each in facts.publishers)\n"
                    "    return 'clock' if waiting and not facts.clock_ticks else 'silent'\n"
                    "for subscription in facts",
                    "if not facts.received:\n    return 'silent'\nfor subscription in facts")),
    Mistake("your code returns 'silent' before it checks whether 'clock' applies. "
            "Return the first cause in the list that applies.",
            replace('"clock" if waiting and not facts.clock_ticks else "silent"', '"silent"')),
    Mistake("your code tests whether the subscriptions' nodes are in clock_users. "
            "The publisher's node has to follow /clock.",
            replace("clock_users for each in facts.publishers", "clock_users for each in facts.subscriptions")),
    Mistake("your code blames the clock although messages arrive on /clock. Also test clock_ticks.",
            replace("waiting and not facts.clock_ticks", "waiting")),
    Mistake("your code blames the clock although no publisher follows /clock. "
            "Test whether the node of a publisher is in clock_users.",
            replace("waiting and not", "not", "facts.clock_users and not")),
    Mistake("your code reports dropped messages as soon as one message moves no joint. "
            "Return 'dropped' only if more than half of the messages move no joint.",
            replace("facts.unmoved > facts.received / 2", "facts.unmoved")),
    Mistake("your code reports dropped messages only if no message moves a joint. "
            "Return 'dropped' if more than half of the messages move no joint.",
            replace("facts.unmoved > facts.received / 2", "facts.unmoved == facts.received")),
]  # fmt: skip
MEANING = ("Compare your steps with these: If there is no publisher, return 'domain' or 'nobody'. Then, for each "
           "subscription, compare type, reliability and durability with those of all publishers. "
           "After that, test for 'clock' and 'silent', and finally for 'dropped'.")  # fmt: skip
NAMES = "domain", "nobody", "type", "reliability", "durability", "clock", "silent", "dropped"
A_NAME = f"Return one of {', '.join(map(repr, NAMES))}, or None."

JOINTS, IMU = "sensor_msgs/msg/JointState", "sensor_msgs/msg/Imu"
TANK, STRANGER = Endpoint("/tank", JOINTS), Endpoint("/stranger", IMU)
KEEPING_STRANGER = Endpoint("/stranger", IMU, transient_local=True)
SPEAKER = Endpoint("/speaker", "std_msgs/msg/String")
SENSOR = Endpoint("/sensor", JOINTS, reliable=False)
KEEPER = Endpoint("/keeper", JOINTS, transient_local=True)
LOSER = Endpoint("/loser", JOINTS, reliable=False, transient_local=True)
VIEWER, LATE = Endpoint("/viewer", JOINTS), Endpoint("/late", JOINTS, transient_local=True)
SHAKER, EASY = Endpoint("/shaker", IMU), Endpoint("/easy", JOINTS, reliable=False)
EASY_LATE = Endpoint("/easy_late", JOINTS, reliable=False, transient_local=True)


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
        Misuse: the answer returns neither a cause's name nor None, or prints the right name instead of returning it.
    """
    with redirect_stdout(StringIO()) as printed:
        returned = trial.call(trial.answer, facts)
    sys.stdout.write(printed.getvalue())
    if returned is not None and returned not in NAMES:
        raise Misuse(f"it returns {returned!r}", A_NAME)
    if returned is None and cause_of(facts) in printed.getvalue().split():
        raise Misuse(f"it prints {cause_of(facts)!r} and returns None", "Use return instead of print.")
    return returned or "all is well"


ORDER = "Your code probably tests the causes in the wrong order. Return the first cause in the list that applies."
OTHER_TYPE = "Your code probably accepts a publisher whose type differs from the subscription's: the two never match."
EACH = ("Your code probably checks only one subscription, or only whether any of them "
        "has a compatible publisher. Every subscription needs a compatible publisher.")  # fmt: skip
ALONE = ("Your code probably looks at other facts first. If there is no publisher, "
         "only found_in tells you whether the cause is 'domain' or 'nobody'.")  # fmt: skip
TYPES = ("Your code probably doesn't compare the publisher's type with "
         "the subscription's: each.type == subscription.type.")  # fmt: skip
CASES = [
    Case("a compatible publisher and subscription", graph(TANK)),
    Case("no publisher anywhere", graph(), ALONE, crashes=True),
    Case("a publisher only in domain 5", graph(found_in=(5,)), ALONE, crashes=True),
    Case("publishers in this domain and in domain 5", graph(TANK, found_in=(5,)),
         "Your code probably looks at other domains even if there is a publisher in this domain. "
         "In that case, ignore found_in."),
    Case("a publisher of Imu messages", graph(STRANGER), TYPES),
    Case("a publisher of String messages", graph(SPEAKER), TYPES),
    Case("a publisher of Imu messages and a best-effort subscription", graph(STRANGER, to=(EASY,)), TYPES),
    Case("a publisher of Imu messages and a transient local subscription", graph(STRANGER, to=(LATE,)), ORDER),
    Case("a best-effort publisher and a reliable subscription", graph(SENSOR)),
    Case("a reliable publisher and a best-effort subscription", graph(TANK, to=(EASY,))),
    Case("a best-effort publisher and subscription", graph(SENSOR, to=(EASY,))),
    Case("a volatile publisher and a transient local subscription", graph(TANK, to=(LATE,))),
    Case("a transient local publisher and a volatile subscription", graph(KEEPER)),
    Case("a transient local publisher and subscription", graph(KEEPER, to=(LATE,))),
    Case("a transient local best-effort publisher and a transient local reliable subscription",
         graph(LOSER, to=(LATE,)), ORDER),
    Case("a volatile best-effort publisher and a transient local reliable subscription",
         graph(SENSOR, to=(LATE,)), ORDER),
    Case("a transient local best-effort publisher and subscription", graph(LOSER, to=(EASY_LATE,)),
         "Your code probably requires a reliable publisher even for a best-effort subscription, "
         "which doesn't need one."),
    Case("two publishers, and only the second is compatible", graph(SENSOR, TANK)),
    Case("two publishers, and only the first is compatible", graph(KEEPER, TANK, to=(LATE,))),
    Case("two publishers: one is reliable, and the other is transient local", graph(TANK, LOSER, to=(LATE,)),
         "Your code probably tests for a reliable publisher and for a transient local one separately. "
         "The same publisher has to be reliable and transient local."),
    Case("two publishers, and only the first has the wrong type", graph(STRANGER, TANK)),
    Case("two publishers, and only the second has the wrong type", graph(TANK, STRANGER)),
    Case("two publishers, and only the one of the wrong type is reliable", graph(SENSOR, STRANGER), OTHER_TYPE),
    Case("two publishers, and only the one of the wrong type is transient local",
         graph(TANK, KEEPING_STRANGER, to=(LATE,)), OTHER_TYPE),
    Case("two subscriptions, and only the second is incompatible", graph(TANK, to=(VIEWER, LATE)), EACH),
    Case("two subscriptions, and only the first is incompatible", graph(TANK, to=(LATE, VIEWER)), EACH),
    Case("two subscriptions, and only the second has the wrong type", graph(TANK, to=(VIEWER, SHAKER)), EACH),
    Case("two subscriptions, and only the first accepts a best-effort publisher",
         graph(SENSOR, to=(EASY, VIEWER)), EACH),
    Case("no subscription", graph(TANK, to=()),
         "Your code probably expects at least one subscription. If there is no subscription, go on to the messages.",
         crashes=True),
    Case("no message arrives", graph(TANK, received=0)),
    Case("no message arrives, and the types differ", graph(STRANGER, received=0), ORDER),
    Case("no message arrives, and the reliability is incompatible", graph(SENSOR, received=0), ORDER),
    Case("no message arrives, and the durability is incompatible", graph(TANK, to=(LATE,), received=0), ORDER),
    Case("no message arrives, and the publisher follows /clock", graph(TANK, received=0, clock_users=("/tank",))),
    Case("no message arrives, the publisher follows /clock, and the clock ticks",
         graph(TANK, received=0, clock_users=("/tank",), clock_ticks=200)),
    Case("no message arrives, and only the viewer follows /clock",
         graph(TANK, received=0, clock_users=("/viewer",))),
    Case("no message arrives, and one of three publishers follows /clock",
         graph(TANK, KEEPER, SENSOR, received=0, clock_users=("/keeper",)),
         "Your code probably requires every publisher to follow /clock, or checks only one publisher. "
         "One publisher that follows /clock is enough."),
    Case("no message arrives, and only nodes with similar names follow /clock",
         graph(TANK, received=0, clock_users=("/tank2", "/tan")),
         "Your code probably matches only part of the name. Compare whole names: each.node in facts.clock_users."),
    Case("messages arrive although /clock doesn't tick", graph(TANK, clock_users=("/tank",)),
         "Your code probably blames the clock although messages arrive. Also test received."),
    Case("no message moves a joint", graph(TANK, unmoved=20)),
    Case("12 of 20 messages move no joint", graph(TANK, unmoved=12)),
    Case("10 of 20 messages move no joint", graph(TANK, unmoved=10),
         "Half is not more than half: compare with >."),
    Case("1 of 20 messages moves no joint", graph(TANK, unmoved=1)),
]  # fmt: skip
find_cause = Exercise("find_cause", __doc__, Cases(cause_of, CASES, MISTAKES, MEANING))
