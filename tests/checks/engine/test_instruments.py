"""Recording of an answer's calls, and clocks that stand still only for the answer."""

import threading
import time

from tutorial.checks.engine.instruments import Instruments


def asks():
    threading.Thread(target=int).start()
    return time.monotonic(), time.time_ns()


def test_calls_by_the_answer_are_recorded():
    sleep = time.sleep
    with Instruments() as instruments:
        assert asks()
        watched, other = instruments.begin(asks), instruments.begin(asks, ())
        asks()
        assert not other.noted
        instruments.trial = watched
        asks()
    assert watched.noted.keys() == {"thread", "clock"}
    assert watched.noted["clock"].function == "asks"
    assert time.sleep is sleep


def test_clocks_stand():
    with Instruments() as instruments:
        trial = instruments.begin(asks)
        with trial.clocks_stand():
            before = asks()
            trial.ahead += 2.0
            assert asks() == (before[0] + 2.0, before[1] + 2_000_000_000)
