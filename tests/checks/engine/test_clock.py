"""An event loop on a simulated clock."""

from concurrent.futures import ThreadPoolExecutor
from contextlib import closing

import pytest

from tutorial.checks.engine.clock import ClockedLoop
from tutorial.checks.engine.failure import Misuse
from tutorial.checks.engine.trial import Trial


def test_timers():
    trial, rung = Trial(int), []
    with closing(ClockedLoop(trial)) as loop:
        for seconds in (2.0, 1.0, 1e6):
            loop.call_later(seconds, rung.append, seconds)
        loop.advance(3.0)
        assert rung == [1.0, 2.0]
        assert len(loop.timers) == 1
        assert 3.0 <= trial.ahead < 3.01
        with pytest.raises(Misuse, match="instead of a function"):
            loop.call_later(1.0, None)
        with ThreadPoolExecutor(1) as other, pytest.raises(RuntimeError, match="Non-thread-safe"):
            other.submit(loop.call_soon, print).result()
