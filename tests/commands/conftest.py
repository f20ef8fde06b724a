"""Run the commands of ``tank`` within the test's own process."""

import gc
import io
import logging
import sys
import threading
from collections.abc import Callable
from contextlib import nullcontext, redirect_stderr, redirect_stdout

import pytest
from programs import until

from tutorial.commands.tank import main

SIGNALLED = ("terminal", "tank", "bag", "chaos", "launcher")
"""The modules that install signal handlers. Here pytest has its own handlers."""


class Run:
    """One run of ``tank``: its output so far, its exit status, and the functions that Ctrl-C calls."""

    def __init__(self) -> None:
        self.out, self.err = io.StringIO(), io.StringIO()
        self.status: int | None = None
        self.stops: list[Callable[[], object]] = []
        self.timed_out = False

    @property
    def stdout(self) -> str:
        return self.out.getvalue()

    @property
    def stderr(self) -> str:
        return self.err.getvalue()

    @property
    def output(self) -> str:
        return self.stdout + self.stderr

    def watch(self, so: Callable[[], object], then: Callable[[], object] | None) -> None:
        """Wait until `so` is true, then call `then`. Without `then`, or after a timeout, press Ctrl-C."""
        try:
            until(lambda: (self.stops and so()) or self.status is not None)
        except AssertionError:
            self.timed_out, then = True, None
        (then or self.stops[-1])()


@pytest.fixture
def tank(domain: int, monkeypatch: pytest.MonkeyPatch) -> Callable[..., Run]:
    """Run ``tank`` with the words in `line`. Press Ctrl-C when it has printed `once`, or when that condition holds."""

    def run(line: str, *words: object, once: str | Callable[[], object] | None = None, then=None) -> Run:
        done = Run()
        with monkeypatch.context() as patch, redirect_stdout(done.out), redirect_stderr(done.err):
            for module in SIGNALLED:
                patch.setattr(f"tutorial.commands.{module}.handle_signals", lambda ask, **_: done.stops.append(ask))
            patch.setattr("tutorial.commands.terminal.logging_redirect_tqdm", nullcontext)  # changes all handlers
            patch.setattr(gc, "freeze", lambda: None)
            patch.setattr(logging.root, "handlers", [])
            patch.setattr(logging.root, "level", logging.WARNING)
            patch.setattr(logging.getLogger("tutorial"), "propagate", True)  # tutorial.notebook disables it
            patch.setattr(sys, "argv", ["tank", *line.split(), *map(str, words)])
            if once is not None:
                so = once if callable(once) else lambda: once in done.output
                watcher = threading.Thread(target=done.watch, args=(so, then))
                watcher.start()
            try:
                main()
            except SystemExit as end:
                done.status = int(end.code or 0)
            if once is not None:
                watcher.join()
        print(done.output)  # pytest shows this if the test fails
        assert "Traceback" not in done.output
        assert not done.timed_out, "what it waits for has not happened"
        return done

    return run
