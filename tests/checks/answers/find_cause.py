"""The exercise `find_cause`: right answers in various styles, and wrong ones."""

from tutorial.checks.find_cause import cause_of, find_cause
from tutorial.ros.doctor.rules import diagnose

from . import edited


def as_the_doctor(facts):
    return next((cause.name for cause in diagnose(facts)), None)


def with_a_table(facts):
    def refused(test, known=lambda *_: True):
        pairs = [[(p, s) for p in facts.publishers if known(p, s)] for s in facts.subscriptions]
        return any(not any(test(*each) for each in those) for those in pairs)

    def same_type(p, s):
        return p.type == s.type

    def reliable(p, s):
        return p.reliable >= s.reliable

    rules = {
        "domain": not facts.publishers and facts.found_in,
        "nobody": not facts.publishers,
        "type": refused(same_type),
        "reliability": refused(reliable, same_type),
        "durability": refused(
            lambda p, s: p.transient_local >= s.transient_local, lambda p, s: same_type(p, s) and reliable(p, s)
        ),
        "clock": not facts.received
        and {p.node for p in facts.publishers} & {*facts.clock_users}
        and not facts.clock_ticks,
        "silent": not facts.received,
        "dropped": facts.unmoved * 2 > facts.received,
    }
    return next((name for name, applies in rules.items() if applies), None)


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


RIGHT = [as_the_doctor, with_a_table, with_the_nearest_publisher, Doctor()]


def messages_first(facts):
    if facts.publishers and not facts.received:
        return "silent"
    return cause_of(facts)


def first_publisher_at_once(facts):
    publisher = facts.publishers[0]
    return cause_of(facts) if publisher else None


ELSEWHERE = "You probably look at other domains although there is a publisher here"
LOST = "You probably look at something else first"
WRONG = [
    (lambda _: "broken", "Return one of 'domain', 'nobody', 'type'"),
    (lambda facts: [cause_of(facts)], "Return one of 'domain', 'nobody', 'type'"),
    (first_publisher_at_once, LOST),
    (messages_first, "You probably test the causes in a different order"),
    (lambda facts: "nobody" if not facts.publishers else cause_of(facts), LOST),
]
WRONG += [
    (edited(find_cause, edit), cause)
    for edit, cause in [
        (("each.reliable or not subscription.reliable", "each.reliable"), "accepts any publisher"),
        (("each.type == subscription.type", "each"), "you don't test `each.type == subscription.type`"),
        (("facts.unmoved > facts.received / 2", "facts.unmoved >= facts.received / 2"), "compare with >"),
        (("in reliable if", "in same if"), "A single publisher has to be both"),
        (("if facts.found_in", "if not facts.found_in"), "your condition is reversed"),
        (("if not facts.publishers:", "if facts.found_in:\n    return 'domain'\nif not facts.publishers:"), ELSEWHERE),
    ]
]
