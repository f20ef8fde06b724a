"""Controllers that misbehave at random: for tests that nothing hangs, and that no failure is unseen."""

from __future__ import annotations

from itertools import count
from pathlib import Path

from tutorial.controller import SimpleController

NUMBERS = count()


class Unruly(SimpleController):
    """Raises, ends the program or does not return, now and then.

    Args:
        rng: decides in which method, and how.
        let: ends its hanging.
        methods: which ones; those of the main thread must not hang, nor be interrupted.

    Attributes:
        hangs: whether it does, or did until it was let.
        raised: the texts of what it has raised.
    """

    def __init__(self, rng, let, methods=("initialize", "control", "control", "control", "stop")):
        self.method = rng.choice(methods)
        self.act = rng.choice((None, None, ValueError, SystemExit, KeyboardInterrupt, "hang"))
        self.wait = rng.randrange(20)
        self.let = let
        self.hangs, self.raised = False, []

    def initialize(self, io):
        self.perhaps("initialize")

    def control(self):
        self.perhaps("control")

    def stop(self):
        self.perhaps("stop")

    def perhaps(self, method):
        if method != self.method or self.act is None:
            return
        self.wait -= 1
        if self.wait > 0 and method == "control":
            return
        if self.act == "hang":
            self.hangs = True
            self.let.wait(60)
        else:
            self.wait = 20
            self.fail(self.act)

    def fail(self, kind):
        self.raised.append(f"failure {next(NUMBERS)}.")
        raise kind(self.raised[-1])


def box_model(folder: Path) -> Path:
    """Write the smallest model that something can be done with: it is quickly loaded."""
    path = folder / "box.xml"
    path.write_text("<mujoco><worldbody><body><freejoint/><geom size='0.1'/></body></worldbody></mujoco>")
    return path
