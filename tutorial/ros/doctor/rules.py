"""The table of the causes that the doctor knows, with the rules that recognize them.

`tank doctor`, the notebooks' ``why``, the book and the tests share this table.
"""

from __future__ import annotations

import re
import shlex
from collections.abc import Callable, Mapping, Sequence
from difflib import SequenceMatcher
from math import inf
from typing import NamedTuple

from tutorial.errors import printable
from tutorial.ros.doctor.facts import Endpoint, Facts, Program, Topic
from tutorial.ros.loopback import TURN_ON
from tutorial.ros.topics.names import EVERY_NODE_HAS, escape_name

PLACES = 32  # maximum number of programs in one domain on one machine, with Cyclone DDS
SIMILAR = 0.8  # the minimum difflib ratio for two names to count as similar
MOST = 3  # the maximum number of causes, and of names in a list
ONCE = ("robot_description", "map", "tf_static")  # last parts of the names of topics that are usually published once
ZENOH = "rmw_zenoh_cpp"


class Found(NamedTuple):
    """The evidence for a cause.

    Attributes:
        saw: the sentence that describes the doctor's observation.
        words: replacements for the words in capitals in a rule's commands, except TOPIC.
        weak: whether the cause is reported only if there is no stronger cause.
    """

    saw: str
    words: Mapping[str, str] = {}
    weak: bool = False


class Rule(NamedTuple):
    """A cause, and how to recognize and fix it. In commands, words in capitals represent names and numbers.

    Attributes:
        title: the cause in a few words.
        find: returns the evidence for the cause; None if the facts contain no evidence.
        means: the sentence that explains the cause.
        fix: the sentence that says what to change.
        command: the command that fixes it, if there is one.
        look: the command that shows the cause, without ``tank`` or ``ros2`` in front, or a system command.
    """

    title: str
    find: Callable[[Facts], Found | None]
    means: str
    fix: str
    command: str = ""
    look: str = "topic info -v TOPIC"


class Cause(NamedTuple):
    """A cause that was found.

    Attributes:
        name: the name of the rule that recognized the cause.
        found: the evidence.
        topic: the topic being examined.
    """

    name: str
    found: Found
    topic: str

    @property
    def rule(self) -> Rule:
        """The rule that recognized the cause."""
        return RULES[self.name]

    def fill(self, command: str) -> str:
        """Replace the words in capitals in one of the rule's commands, and quote the values for a shell."""
        words = {"TOPIC": self.topic, **self.found.words}
        return re.sub(rf"\b({'|'.join(words)})\b", lambda found: shlex.quote(escape_name(words[found[1]])), command)

    def looks(self) -> list[str]:
        """Return the commands that show the cause: one for ``tank`` and one for ``ros2``, or a system command."""
        look = self.fill(self.rule.look)
        tools = ("tank topic ", "ros2 topic ") if "topic " in look else ("",)
        return [look.replace("topic ", tool, 1) for tool in tools]


def diagnose(facts: Facts) -> list[Cause]:
    """Return the likely reasons why no messages arrive, the most likely reason first; empty if all is well."""
    causes = [Cause(name, found, facts.topic) for name, rule in RULES.items() if (found := rule.find(facts))]
    strong = [cause for cause in causes if not cause.found.weak]
    return (strong or causes)[:MOST]


# Causes in this program


def _import(facts: Facts) -> Found | None:
    return Found(printable(facts.import_error)) if facts.import_error else None


def _loopback(facts: Facts) -> Found | None:
    return None if facts.loopback else Found("This machine cannot send packets to 127.0.0.1.")


def _full(facts: Facts) -> Found | None:
    if facts.participants < PLACES:
        return None
    who = "the publisher may have" if facts.joined else "this program"
    return Found(f"All {PLACES} places of domain {facts.domain} are taken, and {who} got none.")


# Causes that involve a publisher and a subscription


def misfits(publisher: Endpoint, subscription: Endpoint) -> list[str]:
    """Return the name of the rule for each mismatch between a publisher and a subscription (DDS 1.4, section 2.2.3)."""
    known = publisher.hash and subscription.hash
    tests = {
        "type": publisher.type != subscription.type,
        "hash": publisher.type == subscription.type and known and publisher.hash != subscription.hash,
        "reliability": subscription.reliable and not publisher.reliable,
        "durability": subscription.transient_local and not publisher.transient_local,
        "deadline": publisher.deadline > subscription.deadline,
        "liveliness": publisher.lease > subscription.lease or (subscription.manual and not publisher.manual),
    }
    return [name for name, misfit in tests.items() if misfit]


def _fits(subscription: Endpoint, publishers: Sequence[Endpoint]) -> bool:
    """Return whether a subscription can receive messages from at least one of the publishers."""
    return any(not misfits(publisher, subscription) for publisher in publishers)


def _apart(name: str, text: Callable[[Endpoint], str]) -> Callable[[Facts], Found | None]:
    """Return a function that finds a subscription, possibly the doctor's, that does not match any publisher.

    Args:
        name: the name of a rule for a mismatch between the subscription and the publisher that fits it best.
        text: returns the text that describes an endpoint's request or offer.
    """

    def find(facts: Facts) -> Found | None:
        if not facts.publishers:
            return None
        here = (facts.here,) if facts.here else ()
        for subscription in (*facts.subscriptions, *here):
            publisher = min(facts.publishers, key=lambda each: len(misfits(each, subscription)))
            if name in misfits(publisher, subscription):
                asks, offers = escape_name(text(subscription)), escape_name(text(publisher))
                return Found(f"{_who(subscription)} asks for {asks}, and {_who(publisher)} offers {offers}.")
        return None

    return find


def _type(facts: Facts) -> Found | None:
    if facts.installed:
        return _apart("type", lambda each: each.type)(facts)
    publisher = facts.publishers[0]
    return Found(f"{_who(publisher)} offers {escape_name(publisher.type)}, which is not installed here.")


def _late(facts: Facts) -> Found | None:
    return _not_requested(facts) or _perhaps_missed(facts)


def _not_requested(facts: Facts) -> Found | None:
    """Find a subscription that does not request the messages that the publisher stores."""
    volatile = [each for each in facts.subscriptions if not each.transient_local]
    if not facts.kept or facts.received or not volatile or any(each.lifespan < inf for each in facts.publishers):
        return None
    saw = f"{_who(facts.publishers[0])} published before the doctor subscribed, but has published nothing since then."
    return Found(f"{saw} {_who(volatile[0])} asks for VOLATILE.")


def _perhaps_missed(facts: Facts) -> Found | None:
    """Find a silent publisher that does not store messages: it may have published some before anybody subscribed."""
    if not facts.silent or facts.publishers[0].transient_local or facts.topic in EVERY_NODE_HAS:
        return None
    is_usual = facts.topic.rpartition("/")[2] in ONCE
    saw = f"{_silence(facts)} Its publisher is VOLATILE, so you missed any messages that it sent before you subscribed."
    return Found(saw, weak=not is_usual)


# Causes in the publisher's program


def _clock(facts: Facts) -> Found | None:
    waiting = [each for each in facts.publishers if each.node in facts.clock_users]
    if not facts.silent or not waiting or facts.clock_ticks:
        return None
    clock = "no message arrives there" if facts.clock_publishers else "nobody publishes it"
    return Found(f"{_who(waiting[0])} subscribes to /clock, and {clock}.")


def _stopped(facts: Facts) -> Found | None:
    program = _program(facts, lambda each: each.stopped and each.joined)
    if program is None or (facts.publishers and not facts.silent):
        return None
    return Found(f"{_process(program)}, in domain {facts.domain}, is suspended.", {"PROCESS": str(program.pid)})


def _silent(facts: Facts) -> Found | None:
    is_usual = facts.topic in EVERY_NODE_HAS  # nodes publish there only if something happens
    if not facts.silent or is_usual or (facts.here and not _fits(facts.here, facts.publishers)):
        return None
    return Found(_silence(facts), weak=all(_fits(each, facts.publishers) for each in facts.subscriptions))


def _silence(facts: Facts) -> str:
    return f"{_who(facts.publishers[0])} has sent nothing in {facts.seconds:.1f} s."


# Publishers that are elsewhere


def _domain(facts: Facts) -> Found | None:
    if facts.publishers or not facts.found_in:
        return None
    where = _listed([str(domain) for domain in facts.found_in])
    saw = f"The topic has no publisher in your domain {facts.domain}, but it has one in domain {where}."
    return Found(saw, {"DOMAIN": str(facts.found_in[0])})


def _range(facts: Facts) -> Found | None:
    program = _program(facts, lambda each: each.reach == "OFF")
    if facts.publishers or not (program or facts.reach == "OFF"):
        return None
    who = "Your environment" if facts.reach == "OFF" or program is None else _process(program)
    return Found(f"{who} has ROS_AUTOMATIC_DISCOVERY_RANGE=OFF.")


def _rmw(facts: Facts) -> Found | None:
    program = _program(facts, lambda each: bool(each.rmw) and (each.rmw == ZENOH) != (facts.rmw == ZENOH))
    if facts.publishers or program is None:
        return None
    return Found(f"{_process(program)} uses {printable(program.rmw)}, and you use {facts.rmw}.")


def _name(facts: Facts) -> Found | None:
    types = {each.type for each in (*facts.publishers, *facts.subscriptions)}
    near = [each for each in _near(facts.topic, facts.topics) if not types or types.intersection(each.types)]
    near = [each for each in near if bool(each.publishers) != bool(facts.publishers)]
    if facts.found_in:
        # A misspelt name is a more likely cause than a different domain only if the names are nearly identical.
        near = [each for each in near if _similarity(facts.topic, each.name) == 1]
    if not near or (facts.publishers and facts.subscriptions):
        return None
    names = _listed([escape_name(each.name) for each in near])
    does, has = ("subscribes to", "a subscription") if facts.publishers else ("publishes", "a publisher")
    saw = f"Nobody {does} {escape_name(facts.topic)} in domain {facts.domain}, but {names} has {has} there."
    return Found(saw, {"OTHER": near[0].name})


def _near(topic: str, topics: Sequence[Topic]) -> list[Topic]:
    """Return the topics whose names are similar to the given one, the most similar name first."""
    similar = {each: _similarity(topic, each.name) for each in topics}
    return sorted((each for each in topics if similar[each] >= SIMILAR), key=lambda each: -similar[each])


def _similarity(one: str, other: str) -> float:
    """Return how similar two names are: at least `SIMILAR` if the last part of one name contains that of the other.

    Case, ``_`` and a plural ``s`` are ignored.
    """
    first, second = (re.sub(r"_|s(?=/|$)", "", name.lower()) for name in (one, other))
    ratio = SequenceMatcher(None, first, second).ratio()
    short, long = sorted((first.rpartition("/")[2], second.rpartition("/")[2]), key=len)
    return max(ratio, SIMILAR) if len(short) > 2 and short in long else ratio


def _nobody(facts: Facts) -> Found | None:
    if facts.publishers:
        return None
    wanted = {each.type for each in facts.subscriptions}
    alike = [escape_name(each.name) for each in facts.topics if each.publishers and wanted.intersection(each.types)]
    parts = [f"Nobody publishes {escape_name(facts.topic)} in domain {facts.domain}{_elsewhere(facts)}."]
    if alike:
        parts.append(f"Published topics of the same type: {_listed(alike)}.")
    if facts.reach == "LOCALHOST":
        parts.append("Your discovery range is LOCALHOST, so programs on other machines are not visible.")
    used = {each.domain for each in facts.programs if each.joined} - {facts.domain, *facts.looked_into}
    if used:
        parts.append(f"Some of your other programs use domain {' or '.join(map(str, sorted(used)))}.")
    return Found(" ".join(parts), weak=True)


def _elsewhere(facts: Facts) -> str:
    """Name the other domains that were searched: 0 to 10, unless the user specified others."""
    looked = facts.looked_into
    if len(looked) > MOST:
        return f", nor in domains {looked[0]} to {looked[-1]}"
    return f", nor in domain {' or '.join(map(str, looked))}" if looked else ""


# Messages that a viewer drops


def _unknown(facts: Facts) -> Found | None:
    return _drops(facts) if _complaint(facts).startswith("unknown ") else None


def _dropped(facts: Facts) -> Found | None:
    return None if _unknown(facts) else _drops(facts)


def _drops(facts: Facts) -> Found | None:
    if facts.unmoved * 2 <= facts.received:
        return None
    return Found(f"{facts.unmoved} of {facts.received} messages move no joint: {_complaint(facts)}.")


def _complaint(facts: Facts) -> str:
    return printable(facts.complaint).removeprefix("0 joints shown; ").rstrip(".")


def _program(facts: Facts, test: Callable[[Program], bool]) -> Program | None:
    """Return the first program in the same domain that passes a test."""
    return next((each for each in facts.programs if each.domain == facts.domain and test(each)), None)


def _process(program: Program) -> str:
    return f"Process {program.pid} ({printable(program.command)})"


def _who(endpoint: Endpoint) -> str:
    return escape_name(endpoint.node) if endpoint.node else "a program whose node is unknown"


def _listed(names: Sequence[str]) -> str:
    more = f" and {len(names) - MOST} more" if len(names) > MOST else ""
    return ", ".join(names[:MOST]) + more


def _limit(what: str, duration: float) -> str:
    return f"{what} of {duration:g} s" if duration < inf else f"{what} of any length"


def _liveliness(endpoint: Endpoint) -> str:
    return _limit(f"{'MANUAL_BY_TOPIC' if endpoint.manual else 'AUTOMATIC'} liveliness with a lease", endpoint.lease)


RULES: dict[str, Rule] = {
    "python": Rule(
        "this Python cannot import ROS 2",
        _import,
        "Each ROS 2 installation is compiled for one version of Python. This Python found no ROS 2 that it can import.",
        "Use the version of Python that your ROS 2 supports, or use the pocket ROS 2.",
        command="export TUTORIAL_ROS=pocket",
        look="python3 -c 'import rclpy'",
    ),
    "loopback": Rule(
        "the loopback interface is down",
        _loopback,
        "Programs on one machine find each other through the loopback interface (127.0.0.1). "
        "In some containers, this interface is down at first.",
        "Bring the interface up.",
        command=TURN_ON,
        look="ip link show lo",
    ),
    "participants": Rule(
        "the domain is full",
        _full,
        f"With Cyclone DDS, a domain has room for only {PLACES} programs per machine. When the domain is full, "
        "no more programs can start in it.",
        "Stop programs that you no longer need, or start some programs in another domain.",
        command="export ROS_DOMAIN_ID=1",
        look="ss -ulnp",
    ),
    "stopped": Rule(
        "a program is suspended",
        _stopped,
        "Ctrl-Z suspends a program. A suspended program sends nothing until it is resumed.",
        "Type fg in the program's terminal, or resume the program from any other terminal.",
        command="kill -CONT PROCESS",
        look="ps -o stat,args PROCESS",
    ),
    "name": Rule(
        "the topic's name differs",
        _name,
        "Two names refer to the same topic only if they are identical, including the namespace and "
        "the case of each letter.",
        "Correct the name in one of the programs, or remap the checked topic when you start the program that uses it:",
        command="--ros-args -r TOPIC:=OTHER",
        look="topic list -t",
    ),
    "domain": Rule(
        "the publisher is in a different domain",
        _domain,
        "Programs only see each other if they have the same ROS_DOMAIN_ID. The default is 0.",
        "If the publisher is yours, restart the receiving program in the publisher's domain.",
        command="export ROS_DOMAIN_ID=DOMAIN",
        look="ROS_DOMAIN_ID=DOMAIN topic info -v TOPIC",
    ),
    "type": Rule(
        "the message types differ",
        _type,
        "A subscription only receives messages of its own type. A topic's name does not determine its type.",
        "Decide which type is right, and use it in both programs. If that type is not installed, build or source "
        "its package.",
    ),
    "hash": Rule(
        "the definitions of the message type differ",
        _apart("hash", lambda each: f"{each.type} {each.hash[:14]}..."),
        "The type has the same name on both sides, but its fields differ, and so do the type hashes.",
        "Build both programs with the same version of the message package, and source that version in both terminals.",
    ),
    "reliability": Rule(
        "the reliability settings are incompatible",
        _apart("reliability", lambda each: "RELIABLE" if each.reliable else "BEST_EFFORT"),
        "A RELIABLE subscription refuses a BEST_EFFORT publisher. (A BEST_EFFORT subscription accepts both kinds.)",
        "Make the subscription BEST_EFFORT, for instance with qos_profile_sensor_data, or make the publisher RELIABLE.",
    ),
    "durability": Rule(
        "the durability settings are incompatible",
        _apart("durability", lambda each: "TRANSIENT_LOCAL" if each.transient_local else "VOLATILE"),
        "A TRANSIENT_LOCAL subscription refuses a VOLATILE publisher, which keeps no messages for late subscriptions.",
        "If the publisher sends only one message, make the publisher TRANSIENT_LOCAL. Otherwise, make the subscription "
        "VOLATILE.",
    ),
    "deadline": Rule(
        "the deadlines are incompatible",
        _apart("deadline", lambda each: _limit("a deadline", each.deadline)),
        "A subscription with a deadline refuses a publisher that offers no deadline, or a longer one.",
        "Remove or lengthen the subscription's deadline, or give the publisher a deadline that is at least as short.",
    ),
    "liveliness": Rule(
        "the liveliness settings are incompatible",
        _apart("liveliness", _liveliness),
        "A subscription refuses a publisher that offers weaker liveliness or a longer lease than the subscription "
        "asks for.",
        "Remove the subscription's liveliness setting, or give the publisher the same kind of liveliness and "
        "an equal or shorter lease.",
    ),
    "clock": Rule(
        "the publisher waits for /clock",
        _clock,
        "With use_sim_time, a node's timers follow /clock. If no messages arrive on /clock, the timers never fire.",
        "Start the program that publishes /clock, such as a simulator, or restart the node with use_sim_time off.",
        command="--ros-args -p use_sim_time:=false",
        look="topic info /clock",
    ),
    "silent": Rule(
        "the publisher is silent",
        _silent,
        "Perhaps nothing spins the publisher's node, a callback blocks the node, the simulation is paused, or "
        "messages are published only rarely.",
        "Check the publisher's program: something has to spin the node, as rclpy.spin(node) does, and each callback "
        "has to return.",
        look="topic hz TOPIC",
    ),
    "late": Rule(
        "the subscription was created too late",
        _late,
        "A VOLATILE subscription only receives messages that are published after the publisher has discovered "
        "the subscription.",
        "Make both the publisher and the subscription TRANSIENT_LOCAL: the publisher then keeps its last messages.",
    ),
    "range": Rule(
        "discovery is switched off",
        _range,
        "A program whose discovery range is OFF finds no other programs, not even on the same machine.",
        "Unset ROS_AUTOMATIC_DISCOVERY_RANGE, or set it to LOCALHOST, and restart the program.",
        command="export ROS_AUTOMATIC_DISCOVERY_RANGE=LOCALHOST",
        look="printenv ROS_AUTOMATIC_DISCOVERY_RANGE",
    ),
    "rmw": Rule(
        "the programs use different middleware",
        _rmw,
        "Programs that use Zenoh and programs that use DDS cannot find each other. "
        "Programs that use Cyclone DDS and programs that use Fast DDS can find each other.",
        "Start all programs with the same RMW_IMPLEMENTATION.",
        command="export RMW_IMPLEMENTATION=rmw_cyclonedds_cpp",
        look="printenv RMW_IMPLEMENTATION",
    ),
    "unknown": Rule(
        "messages arrive, but with unknown joint names",
        _unknown,
        "A viewer moves only the joints of its robot's model. It ignores all other joint names.",
        "In the publisher's program, use exactly the joint names of the robot's model.",
        look="topic echo TOPIC",
    ),
    "dropped": Rule(
        "messages arrive, but viewers drop them",
        _dropped,
        "A viewer ignores messages that are older than the message it last showed, and positions that it cannot use, "
        "such as NaN.",
        "Publish each joint's position from only one publisher, with stamps that never jump backwards and "
        "with usable values.",
        look="topic echo TOPIC",
    ),
    "nobody": Rule(
        "nobody publishes the topic",
        _nobody,
        "A subscription receives nothing if its topic has no publisher, and ROS 2 does not warn you.",
        "Start the program that publishes the topic. If it is already running, look for an error in its terminal.",
        look="topic list",
    ),
}
"""All rules by name, the most likely cause first."""
