"""Write the doctor's findings as text."""

from __future__ import annotations

import textwrap
from collections.abc import Sequence

from tutorial.ros.doctor.facts import Endpoint, Facts
from tutorial.ros.doctor.rules import MOST, Cause, diagnose
from tutorial.ros.topics.names import escape_name

WIDTH = 100  # columns


def report(facts: Facts) -> str:
    """Explain why no messages arrive on a topic.

    Returns:
        Lines that list the topic's publishers and subscriptions, and then either give the likely causes, the most
            likely cause first, or report that all is well.
    """
    causes = diagnose(facts)
    if not causes:
        return f"{_summary(facts)}\n{_all_is_well(facts)}\n"
    parts = [_cause_text(number, cause) for number, cause in enumerate(causes, 1)]
    return ("" if facts.blind else f"{_summary(facts)}{_arrived(facts)}\n\n") + "\n".join(parts)


def _summary(facts: Facts) -> str:
    """Return the line that names the publishers and subscriptions."""
    publishers, subscriptions = _nodes("publisher", facts.publishers), _nodes("subscription", facts.subscriptions)
    return f"{escape_name(facts.topic)} in domain {facts.domain}: {publishers}, {subscriptions}."


def _arrived(facts: Facts) -> str:
    """Describe how many messages the doctor received. The doctor's QoS is compatible with any publisher's."""
    if not facts.seconds:
        return ""
    messages = f"{facts.received or 'No'} message{'s' * (facts.received != 1)}"
    return f"\n{messages} arrived at the doctor, which accepts any QoS, in {facts.seconds:.1f} s."


def _nodes(noun: str, endpoints: Sequence[Endpoint]) -> str:
    """Count publishers or subscriptions, and name the first few of their nodes."""
    if not endpoints:
        return f"no {noun}"
    names = [escape_name(each.node) or "unknown" for each in endpoints[:MOST]]
    more = ", ..." * (len(endpoints) > MOST)
    return f"{len(endpoints)} {noun}{'s' * (len(endpoints) > 1)} ({', '.join(names)}{more})"


def _all_is_well(facts: Facts) -> str:
    if facts.received > 1:
        return f"All is well: {facts.rate:.1f} messages a second arrive."
    if facts.received:
        return f"All is well: 1 message arrived in {facts.seconds:.1f} s."
    if not facts.kept:
        return f"No message arrived in {facts.seconds:.1f} s, but nothing seems to be wrong."
    kept = f"{facts.kept} message{'s' * (facts.kept != 1)}"
    return f"All is well: the publisher keeps {kept} for late subscriptions, but has published nothing new."


def _cause_text(number: int, cause: Cause) -> str:
    """Return a cause's heading, evidence, explanation, fix and commands."""
    rule = cause.rule
    lines = [f"{number}. {rule.title[0].upper()}{rule.title[1:]}"]
    lines += [_labelled("saw", cause.found.saw), _labelled("means", rule.means), _labelled("fix", rule.fix)]
    if rule.command:
        lines.append(f"{'':11}{cause.fill(rule.command)}")
    lines += [f"{label:>8}   {text}" for label, text in zip(("look", "or"), cause.looks())]
    return "\n".join(lines) + "\n"


def _labelled(label: str, text: str) -> str:
    wrapper = textwrap.TextWrapper(WIDTH, f"{label:>8}   ", " " * 11, break_long_words=False, break_on_hyphens=False)
    return wrapper.fill(text)
