"""An item of a running program: a displayed body with its controllers, and what is known of its messages."""

from __future__ import annotations

import logging
import time
from collections import Counter, defaultdict

from tutorial.body import Body
from tutorial.controller import ControllerConfig, SimpleController
from tutorial.errors import TutorialError, file_of, printable, tell
from tutorial.handoff import CallQueue, CallScope
from tutorial.joints import JointReport
from tutorial.ros.node_thread import MeteredNode

__all__ = ["Item"]

COMPLAIN_EVERY = 5.0  # [s] between two log lines about one body's messages
STALE_AFTER = 1.0  # [s] without a word of a joint, after which it is shown as stale
CONTESTED_FOR = 2.0  # [s] after the last message of another publisher, in which that is said below the view
ASK_EVERY = 1.0  # [s] between two looks at who publishes, while there is another
NAMED = 3  # of joints, or nodes; the others are counted
LONGEST_NAME = 60  # characters of a node's name

_log = logging.getLogger(__name__)


class Item:
    """A displayed body with its controllers. It belongs to the main thread.

    Args:
        body: the displayed body.

    Attributes:
        body: as given.
        controllers: those that have joined it.
        applied: how many messages it was moved by.
        joint_topics: the topics that its controllers receive joint states on.
    """

    def __init__(self, body: Body) -> None:
        self.body = body
        self.controllers: list[SimpleController] = []
        self.applied = 0
        self._tally: Counter[str] = Counter()
        self._repeats = 0  # of the last report, which are not in the tally yet
        self.joint_topics: list[str] = []
        self._scopes: list[CallScope] = []
        self._dirty = True
        self._last = JointReport()
        self._report: JointReport | None = None  # the last one of the publisher that is followed
        self._shown_at = 0.0
        self._heard: dict[str, float] = {}  # when there was a position last, by joint
        self._complained_at = self._asked_at = self._named_at = -COMPLAIN_EVERY
        self._contested_at = -CONTESTED_FOR
        self._publishers = self._named = ""  # who publishes, now and when it was logged last
        self._node: MeteredNode | None = None
        body.on_change(self._changed)

    def attach(self, controller_class: type[SimpleController], node: MeteredNode, calls: CallQueue) -> None:
        """Make a controller and have it join the body.

        Raises:
            TutorialError: it does not fit the body.
        """
        name = controller_class.__name__
        topics_before = len(node.meters)
        scope = calls.scope(f"{name} of {self.body.name}")
        try:
            controller = controller_class()
            controller.configure(ControllerConfig(self.body, node, scope.call_later, scope.call_latest))
        except TutorialError:
            raise
        except (Exception, SystemExit) as error:
            text = f"{name} could not join {self.body.name}: {tell(error, file_of(controller_class))}"
            raise TutorialError(text) from error
        self._node = node
        self.controllers.append(controller)
        self._scopes.append(scope)
        self.joint_topics += [meter.topic for meter in node.meters[topics_before:] if meter.brings_joint_states]

    @property
    def error(self) -> BaseException | None:
        """What a call that one of its controllers has posted raised last."""
        return next((scope.error for scope in self._scopes if scope.error is not None), None)

    def forget_errors(self) -> None:
        """What its calls have raised does not count any more."""
        for scope in self._scopes:
            scope.error = None

    def count_in(self, earlier: Item | None) -> None:
        """Add the counts of a body of this name that was there before; None adds nothing."""
        if earlier is not None:
            self.applied += earlier.applied
            self.tally.update(earlier.tally)

    def take_dirty(self) -> bool:
        """Whether the body has changed since this was last asked."""
        dirty, self._dirty = self._dirty, False
        return dirty

    @property
    def tally(self) -> Counter[str]:
        """The counts of all reports, and of the messages that were dropped, summed up."""
        self._sum_up()
        return self._tally

    def stale(self) -> dict[str, int]:
        """The joints that nothing was heard of for a while: for how long [s]. None before the body's first message."""
        now = time.monotonic()
        return {joint: int(now - at) for joint, at in self._heard.items() if now - at >= STALE_AFTER}

    @property
    def in_order(self) -> bool:
        """Whether messages of one publisher go on coming, for all joints, and nothing was wrong with the last."""
        contested = time.monotonic() - self._contested_at < CONTESTED_FOR
        return self._report is not None and self._report.clean and not contested and not self.stale()

    def line(self) -> str:
        """What stands below the view: the last report, who else publishes, stale joints, and the age of the data."""
        if self._report is None:
            return f"{self.body.name}: {self._nothing_yet(self.joint_topics[0])}" if self.joint_topics else ""
        said = [str(self._report)]
        if time.monotonic() - self._contested_at < CONTESTED_FOR:
            said.append(self._publishers)
        by_age: defaultdict[int, list[str]] = defaultdict(list)
        for joint, age in self.stale().items():
            by_age[age].append(joint)
        said += [f"{_some(by_age[age])}: nothing for {age} s" for age in sorted(by_age)[:NAMED]]
        return f"{self.body.name}: {'; '.join(said)} ({time.monotonic() - self._shown_at:.1f} s ago)"

    def close(self) -> None:
        """Have the controllers leave the body: first what they have posted is dropped, then they unsubscribe."""
        self._node = None
        for scope in self._scopes:
            scope.close()
        while self.controllers:
            controller = self.controllers.pop(0)
            try:
                controller.unconfigure()
            except (Exception, SystemExit):  # noqa: BLE001 - whatever it is, the others still have to leave
                _log.exception("%s of %s failed in unconfigure()", type(controller).__name__, self.body.name)

    def _changed(self, report: object) -> None:
        """Note that the body is to be drawn, and what its message was like."""
        self._dirty = True
        if not isinstance(report, JointReport):
            return
        self._count(report)
        now = time.monotonic()
        if report.another:
            self._contested_at = now
            self._name_publishers(now)
            return
        self._report, self._shown_at = report, now
        self.applied += not report.late
        self._heard = self._heard or dict.fromkeys(self.body.joint_names, now)
        self._heard.update(dict.fromkeys(report.joints, now))
        if not report.clean and now - self._complained_at >= COMPLAIN_EVERY:
            self._complained_at = now
            _log.warning("%s: %s", self.body.name, report)

    def _nothing_yet(self, topic: str) -> str:
        """Say whether nothing has come on a topic, or nothing of it was shown: a controller may wait for more."""
        meters = self._node.meters if self._node is not None else []
        if any(meter.count for meter in meters if meter.topic == topic and meter.direction == "received"):
            return f"nothing of what has come on {topic} could be shown yet"
        return f"nothing has come on {topic} yet"

    def _count(self, report: JointReport) -> None:
        if report is not self._last:  # the usual one is the same object each time, and counted in the end
            self._sum_up()
            self._last = report
        self._repeats += 1

    def _sum_up(self) -> None:
        if self._repeats:
            for kind, count in self._last.counts().items():
                self._tally[kind] += count * self._repeats
            self._repeats = 0

    def _name_publishers(self, now: float) -> None:
        """Ask now and then who publishes what reached this body; log it when it isn't what it was."""
        if now - self._asked_at < ASK_EVERY:
            return
        self._asked_at = now
        self._publishers = "another publisher is not followed"
        for topic in self.joint_topics:
            nodes = self._node.get_publishers_info_by_topic(topic) if self._node is not None else []
            if len(nodes) > 1:
                names = sorted({f"{node.node_namespace.rstrip('/')}/{node.node_name}"[:LONGEST_NAME] for node in nodes})
                self._publishers = f"{len(nodes)} publish on {topic}, one is followed: {printable(_some(names))}"
                if self._publishers != self._named and now - self._named_at >= COMPLAIN_EVERY:
                    self._named, self._named_at = self._publishers, now
                    _log.warning("%s: %s", self.body.name, self._named)


def _some(names: list[str]) -> str:
    more = f" and {len(names) - NAMED} more" if len(names) > NAMED else ""
    return ", ".join(names[:NAMED]) + more
