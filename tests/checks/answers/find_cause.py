"""The exercise `find_cause`: right answers in various styles, and wrong ones."""

from dataclasses import replace

from tutorial.checks.find_cause import cause_of, find_cause
from tutorial.ros.doctor.rules import diagnose

from . import edited


def as_the_doctor(facts):
    return next((cause.name for cause in diagnose(facts)), None)


def lonely(fits):
    """Return a rule: there is a subscription that no publisher fits."""
    return lambda f: any(not any(fits(p, s) for p in f.publishers) for s in f.subscriptions)


def typed(p, s):
    return p.type == s.type


def reliable(p, s):
    return typed(p, s) and p.reliable >= s.reliable


def durable(p, s):
    return reliable(p, s) and p.transient_local >= s.transient_local


def all_lonely(fits):
    """Return a rule: no publisher fits any subscription."""
    return lambda f: f.subscriptions and not any(fits(p, s) for p in f.publishers for s in f.subscriptions)


RULES = {
    "domain": lambda f: not f.publishers and f.found_in,
    "nobody": lambda f: not f.publishers,
    "type": lonely(typed),
    "reliability": lonely(reliable),
    "durability": lonely(durable),
    "clock": lambda f: not f.received and {p.node for p in f.publishers} & {*f.clock_users} and not f.clock_ticks,
    "silent": lambda f: not f.received,
    "dropped": lambda f: f.unmoved * 2 > f.received,
}


def with_rules(*order, **changed):
    """Return an answer that tests a table of independent rules, some of them changed or in a different order."""
    rules = RULES | changed
    return lambda facts: next((name for name in order or rules if rules[name](facts)), None)


def with_the_nearest_publisher(facts):
    def misfit(publisher, subscription):
        if publisher.type != subscription.type:
            return 1
        if subscription.reliable and not publisher.reliable:
            return 2
        return 3 if subscription.transient_local and not publisher.transient_local else 4

    if len(facts.publishers) == 0:
        return "domain" if len(facts.found_in) > 0 else "nobody"
    for subscription in facts.subscriptions:
        furthest = max(misfit(publisher, subscription) for publisher in facts.publishers)
        if furthest < 4:
            return ("type", "reliability", "durability")[furthest - 1]
    if facts.received == 0:
        for publisher in facts.publishers:
            if publisher.node in facts.clock_users and facts.clock_ticks == 0:
                return "clock"
        return "silent"
    if facts.unmoved / facts.received > 0.5:
        return "dropped"
    return None


class Doctor:
    """An object that can be called."""

    def __call__(self, facts):
        return cause_of(facts)


def prints_its_way(facts):
    print("domain, nobody or type")
    return cause_of(facts)


RIGHT = [as_the_doctor, with_rules(), with_the_nearest_publisher, Doctor(), prints_its_way]


def messages_first(facts):
    if facts.publishers and not facts.received:
        return "silent"
    return cause_of(facts)


def first_publisher_at_once(facts):
    publisher = facts.publishers[0]
    return cause_of(facts) if publisher else None


def prints(facts):
    print(cause_of(facts))


def prints_all(facts):
    for name, applies in RULES.items():
        if applies(facts):
            print(name)


def any_type(p, s):
    return p.reliable >= s.reliable


def durable_of_any_type(p, s):
    return any_type(p, s) and p.transient_local >= s.transient_local


def durable_if_reliable(p, s):
    return typed(p, s) and ((p.reliable and p.transient_local) or not s.transient_local)


def on_a_clock(some, is_known):
    """Return a rule for the clock: `is_known` tells for some or all publishers whether they follow it."""

    def applies(f):
        return not f.received and not f.clock_ticks and some(is_known(p.node, f.clock_users) for p in f.publishers)

    return applies


def the_wrong_way_round(policy, some):
    """Return a rule that blames a subscription for asking for less than some or all publishers offer."""

    def offered(f, s):
        return some(getattr(p, policy) for p in f.publishers if typed(p, s))

    return lambda f: any(not getattr(s, policy) and offered(f, s) for s in f.subscriptions)


NO_PUBLISHER, APART, NO_MESSAGE = ("domain", "nobody"), ("type", "reliability", "durability"), ("clock", "silent")
LATE_TYPE = "your code compares the types too late"
EACH = "Your code probably checks only one subscription"
OTHER_TYPE = "Your code probably accepts a publisher whose type differs"
FIRST = "your code checks only the first publisher"
WHOLE = "Compare whole names"
ENOUGH = "One publisher that follows /clock is enough"
BY_MESSAGES = "your code looks at the messages before the subscriptions"
TURNED = "the wrong way round: the publisher has to offer"
ELSEWHERE = "Your code probably looks at other domains even if there is a publisher in this domain"
LOST = "Your code probably looks at other facts first"
WRONG = [
    (lambda _: "broken", "Return one of 'domain', 'nobody', 'type'"),
    (lambda facts: [cause_of(facts)], "Return one of 'domain', 'nobody', 'type'"),
    (first_publisher_at_once, LOST),
    (messages_first, BY_MESSAGES),
    (prints, "Use return instead of print"),
    (prints_all, "Use return instead of print"),
    (with_rules(reliability=lonely(any_type)), OTHER_TYPE),
    (with_rules(durability=lonely(durable_of_any_type)), OTHER_TYPE),
    (with_rules(durability=lonely(durable_if_reliable)), "even for a best-effort subscription"),
    (with_rules(type=all_lonely(typed), reliability=all_lonely(reliable), durability=all_lonely(durable)), EACH),
    (with_rules(type=all_lonely(typed)), EACH),
    (lambda facts: cause_of(replace(facts, subscriptions=facts.subscriptions[-1:])), EACH),
    (with_rules(clock=on_a_clock(all, lambda node, users: node in users)), ENOUGH),
    (with_rules(clock=on_a_clock(next, lambda node, users: node in users)), ENOUGH),
    (with_rules(clock=on_a_clock(any, lambda node, users: node in " ".join(users))), WHOLE),
    (with_rules(clock=on_a_clock(any, lambda node, users: any(user in node for user in users))), WHOLE),
    (with_rules(clock=lambda f: RULES["clock"](replace(f, received=0))), "Also test received"),
    (with_rules(clock=lambda f: RULES["clock"](replace(f, publishers=f.subscriptions))), "The publisher's node"),
    *((with_rules(reliability=the_wrong_way_round("reliable", some)), TURNED) for some in (any, all)),
    *((with_rules(durability=the_wrong_way_round("transient_local", some)), TURNED) for some in (any, all)),
    (with_rules(type=lambda f: any(s.type != f.publishers[0].type for s in f.subscriptions)), FIRST),
    (with_rules(reliability=lambda f: any(s.reliable > f.publishers[0].reliable for s in f.subscriptions)), FIRST),
    (with_rules(*NO_PUBLISHER, "reliability", "type", "durability", *NO_MESSAGE, "dropped"), LATE_TYPE),
    (with_rules(*NO_PUBLISHER, *NO_MESSAGE, *APART, "dropped"), BY_MESSAGES),
    (with_rules(*NO_PUBLISHER, *NO_MESSAGE, "reliability", "durability", "type", "dropped"), [LATE_TYPE, BY_MESSAGES]),
    (with_rules(*NO_PUBLISHER, *APART, "silent", "clock", "dropped"), "your code returns 'silent'"),
    (lambda facts: "nobody" if not facts.publishers else cause_of(facts), LOST),
]
WRONG += [
    (edited(find_cause, edit), cause)
    for edit, cause in [
        (("each.reliable or not subscription.reliable", "each.reliable"), "both best-effort and reliable"),
        (("each.type == subscription.type", "each"), "your code doesn't test `each.type == subscription.type`"),
        (("facts.unmoved > facts.received / 2", "facts.unmoved >= facts.received / 2"), "compare with >"),
        (("in reliable if", "in same if"), "The same publisher has to be reliable"),
        (("if facts.found_in", "if not facts.found_in"), "your condition is reversed"),
        (("if not facts.publishers:", "if facts.found_in:\n    return 'domain'\nif not facts.publishers:"), ELSEWHERE),
    ]
]
