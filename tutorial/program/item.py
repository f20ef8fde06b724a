"""An item of a running program: a displayed body, its controllers, and a watch on its joint states."""

import logging
import time
from collections import Counter
from collections.abc import Callable
from typing import Any

from tutorial.body import Body
from tutorial.controller import Ask, ControllerConfig, SimpleController
from tutorial.errors import RefusedError, TutorialError, describe_error, file_of, printable
from tutorial.handoff import PATIENCE, CallQueue, CallScope
from tutorial.joints import Arrival, JointReport
from tutorial.model.couplings import not_computed
from tutorial.ros.node_thread import MeteredNode, TopicMeter
from tutorial.world import Placement

COMPLAIN_EVERY = 5.0  # [s] between log lines about a body's messages, and between queries of the publishers
STALE_AFTER = 1.0  # [s] without a new position before the view marks a joint as stale
CONTESTED_FOR = 2.0  # [s] how long the line below the view keeps naming a rival after the rival's last message
NAMED = 3  # number of stale joints or nodes to name; the rest are only counted
LONGEST_NAME = 60  # maximum number of characters of a node's name to show

_log = logging.getLogger(__name__)


class JointWatch:
    """Watches the joint states that move one body: counts them, and reports their faults and rival publishers.

    Its method `take` is called on every change to the body. Main thread only.

    Args:
        body: the displayed body.
        node: the node that the body's controllers use to subscribe.

    Attributes:
        meters: the meters of the subscriptions to the body's joint states.
        applied: the number of messages that moved the body.
        tally: each count, summed over all reports.
    """

    def __init__(self, body: Body, node: MeteredNode) -> None:
        self._body = body
        self._node = node
        self.meters: list[TopicMeter] = []
        self.applied = 0
        self.tally: Counter[str] = Counter()
        self._report: JointReport | None = None  # the last report on a message from the publisher that is followed
        self._reported_at = 0.0
        self._complained_at = -COMPLAIN_EVERY
        self._heard: dict[str, float] = {}  # when each joint last received a position
        self._contested_at = -CONTESTED_FOR  # when a rival's message last arrived
        self._asked_at = -COMPLAIN_EVERY
        self._publishers = ""  # the publishers' names, for the line below the view
        body.on_change(self.take)

    def take(self, report: JointReport | None) -> None:
        """Process the report on one message. Ignore None, which marks a change that was not caused by a message."""
        if report is None:
            return
        self.tally.update(report.counts())
        if report.arrival is Arrival.ANOTHER:
            self._ask_who_publishes()
            if report.dropped:
                return
        now = time.monotonic()
        self._report, self._reported_at = report, now
        self.applied += not report.dropped
        if not self._heard:
            self._heard = dict.fromkeys(self._body.joint_names, now)
            self._say_what_does_not_follow(report)
        self._heard.update(dict.fromkeys(report.joints, now))
        if not report.clean and now - self._complained_at >= COMPLAIN_EVERY:
            self._complained_at = now
            _log.warning("%s: %s", self._body.name, report)

    def stale(self) -> dict[str, int]:
        """For each stale joint, return the time since its last position [s]; empty before the first message.

        Coupled joints are excluded, because they follow other joints.
        """
        now, followers = time.monotonic(), self._body.followers
        silent = {joint: now - at for joint, at in self._heard.items() if joint not in followers}
        return {joint: int(age) for joint, age in silent.items() if age >= STALE_AFTER}

    @property
    def in_order(self) -> bool:
        """Whether a single publisher moves every joint, and its last message had no faults."""
        return self._report is not None and self._report.clean and not self._contested() and not self.stale()

    def line(self) -> str:
        """Return the line below the view: the last report, rival publishers, stale joints, and the report's age."""
        if self._report is None:
            return f"{self._body.name}: {self._nothing_yet()}" if self.meters else ""
        stale = _some([f"{joint}: nothing for {age} s" for joint, age in self.stale().items()])
        said = "; ".join(filter(None, (str(self._report), self._contested(), stale)))
        return f"{self._body.name}: {said} ({time.monotonic() - self._reported_at:.1f} s ago)"

    def _nothing_yet(self) -> str:
        """Explain why there is no report yet: no message has arrived, or no message could be shown."""
        topic = self.meters[0].topic
        if any(meter.count for meter in self.meters):
            return f"no message on {topic} could be shown yet"
        return f"no message on {topic} yet"

    def _contested(self) -> str:
        """Return a note about the competing publishers; empty if no rival's message has arrived for a while."""
        return self._publishers if time.monotonic() - self._contested_at < CONTESTED_FOR else ""

    def _say_what_does_not_follow(self, report: JointReport) -> None:
        """Warn if the first message omits joints and the model has couplings that the view does not compute."""
        missing = set(self._body.joint_names).difference(report.joints, self._body.followers)
        if missing and (kinds := not_computed(self._body.model)):
            _log.warning(
                "%s: its model couples links with <%s>, which the view does not compute. "
                "Joints that are not named in any message keep their positions: %s",
                *(self._body.name, ">, <".join(kinds), _some(sorted(map(repr, missing)))),
            )

    def _ask_who_publishes(self) -> None:
        """Record that a rival's message arrived. Occasionally, look up the publishers; warn if they have changed."""
        now = self._contested_at = time.monotonic()
        if now - self._asked_at < COMPLAIN_EVERY:
            return
        self._asked_at = now
        before, self._publishers = self._publishers, "another publisher is ignored"
        for topic in (meter.topic for meter in self.meters):
            nodes = self._node.get_publishers_info_by_topic(topic)
            if len(nodes) > 1:
                names = sorted({f"{node.node_namespace.rstrip('/')}/{node.node_name}"[:LONGEST_NAME] for node in nodes})
                self._publishers = (
                    f"{len(nodes)} nodes publish on {topic}; only one of these is followed: {printable(_some(names))}"
                )
                if self._publishers != before:
                    _log.warning("%s: %s", self._body.name, self._publishers)


class Item:
    """A displayed body with its controllers. Main thread only.

    Args:
        placement: the body's name and model.
        node: the node that its controllers use.
        calls: the main thread's queue of posted calls.
        ask: a function that has the simulation's thread call another function (see `ControllerConfig`).

    Attributes:
        body: the displayed body.
        controllers: the controllers that have joined it.
        joints: the watch on its joint states.
        failed: whether a controller failed in ``unconfigure``.

    Raises:
        TutorialError: the model cannot be loaded.
    """

    def __init__(self, placement: Placement, node: MeteredNode, calls: CallQueue, ask: Ask) -> None:
        self.body = Body.displayed(placement)
        self.controllers: list[SimpleController] = []
        self.body.on_change(self._mark_dirty)
        self.joints = JointWatch(self.body, node)
        self.failed = False
        self._node = node
        self._calls = calls
        self._ask = ask
        self._scopes: list[CallScope] = []
        self._dirty = True

    def attach(self, controller_class: type[SimpleController]) -> None:
        """Make a controller and have it join the body.

        Raises:
            TutorialError: the controller could not join the body.
        """
        name = controller_class.__name__
        before = len(self._node.meters)
        scope = self._calls.scope(f"{name} of {self.body.name}")
        self._scopes.append(scope)  # first, so that the calls of a controller that fails to join are dropped
        try:
            controller = controller_class()
            ask = _AskUntilClosed(scope, self._ask)
            controller.configure(ControllerConfig(self.body, self._node, scope.call_later, scope.call_latest, ask))
        except (Exception, SystemExit) as error:
            text = f"{name} could not join {self.body.name}: {describe_error(error, file_of(controller_class))}"
            raise TutorialError(text) from error
        self.controllers.append(controller)
        self.joints.meters += [meter for meter in self._node.meters[before:] if meter.brings_joint_states]

    def take_dirty(self) -> bool:
        """Return whether the body has changed since the last call."""
        dirty, self._dirty = self._dirty, False
        return dirty

    def drop_calls(self) -> None:
        """Drop the controllers' waiting calls, and refuse their requests. Idempotent."""
        for scope in self._scopes:
            scope.close()

    def close(self) -> None:
        """Drop the controllers' calls and requests, then have the controllers leave the body."""
        self.drop_calls()
        while self.controllers:
            controller = self.controllers.pop(0)
            try:
                controller.unconfigure()
            except (Exception, SystemExit):  # noqa: BLE001 - the other controllers still have to leave
                _log.exception("%s of %s failed in unconfigure()", type(controller).__name__, self.body.name)
                self.failed = True

    def _mark_dirty(self, _: JointReport | None) -> None:
        self._dirty = True


class _AskUntilClosed:
    """A controller's `ask` that refuses all requests, even waiting ones, once the controller's scope is closed."""

    def __init__(self, scope: CallScope, ask: Ask) -> None:
        self._scope = scope
        self._ask = ask

    def __call__(self, function: Callable[..., Any], /, *args: object, timeout: float = PATIENCE) -> Any:
        """Request that the function be called between two simulation steps. Runs on the executor's thread."""
        return self._ask(self._run, function, *args, timeout=timeout)

    def _run(self, function: Callable[..., Any], *args: object) -> Any:
        """Call the function, unless the controller has left the program. Runs on the simulation's thread."""
        if self._scope.closed:
            raise RefusedError(f"{self._scope.owner} has left the program.")
        return function(*args)


def _some(names: list[str]) -> str:
    more = f" and {len(names) - NAMED} more" if len(names) > NAMED else ""
    return ", ".join(names[:NAMED]) + more
