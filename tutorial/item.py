"""An item of a running program: a displayed body with its controllers, and what is known of its messages."""

from __future__ import annotations

import logging
import time
from collections import Counter

from tutorial.body import Body
from tutorial.controller import ControllerConfig, SimpleController
from tutorial.errors import TutorialError, file_of, tell
from tutorial.handoff import CallQueue, CallScope
from tutorial.joints import JointReport
from tutorial.ros.node_thread import MeteredNode

__all__ = ["Item"]

COMPLAIN_EVERY = 5.0  # [s] between two log lines about one body's messages
SILENT = 1.0  # [s] without a message, after which something is wrong

_log = logging.getLogger(__name__)


class Item:
    """A displayed body with its controllers. It belongs to the main thread.

    Args:
        body: the displayed body.

    Attributes:
        body: as given.
        controllers: those that have joined it.
        applied: how many messages it was moved by.
        tally: the counts of all their reports, and of those that came late, summed up.
        joint_topics: the topics that its controllers receive joint states on.
    """

    def __init__(self, body: Body) -> None:
        self.body = body
        self.controllers: list[SimpleController] = []
        self.applied = 0
        self.tally: Counter[str] = Counter()
        self.joint_topics: list[str] = []
        self._scopes: list[CallScope] = []
        self._dirty = True
        self._report: JointReport | None = None
        self._shown_at = 0.0
        self._complained_at = -COMPLAIN_EVERY
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
    def in_order(self) -> bool:
        """Whether its messages go on coming, and there was nothing to complain about in the last one."""
        return self._report is not None and self._report.clean and time.monotonic() - self._shown_at < SILENT

    def line(self) -> str:
        """What stands below the view: the last report, and the age of the data."""
        if self._report is None:
            return f"{self.body.name}: nothing has come on {self.joint_topics[0]} yet" if self.joint_topics else ""
        return f"{self.body.name}: {self._report} ({time.monotonic() - self._shown_at:.1f} s ago)"

    def close(self) -> None:
        """Have the controllers leave the body: first what they have posted is dropped, then they unsubscribe."""
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
        self._report, self._shown_at = report, time.monotonic()
        self.applied += not report.late
        self.tally.update(report.counts())
        if not report.clean and self._shown_at - self._complained_at >= COMPLAIN_EVERY:
            self._complained_at = self._shown_at
            _log.warning("%s: %s", self.body.name, report)
