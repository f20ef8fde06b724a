"""The cases of controllers that publish at a fixed rate."""

from tutorial.checks.engine.publishing import compared, compared_stamps, describe
from tutorial.checks.engine.trial import Trial
from tutorial.checks.publish import PUBLISHING, SlowPublisher


class EverySecond(SlowPublisher):
    def initialize(self, io):
        super().initialize(io)
        self.steps_per_message *= 2


def test_the_rate():
    assert PUBLISHING.rate(1)(Trial(SlowPublisher)) == "25 times per simulated second"
    assert PUBLISHING.rate(1)(Trial(EverySecond)) == {"12.5 times per simulated second, starting at 0 s": [80, 80]}


def test_words():
    assert compared([(1, 1), (3, 2)], "right", str) == {"3 instead of 2": [1, 3]}
    assert compared_stamps([(10**19, 0)]) == "the wall clock's time"
    assert compared_stamps([(5, 5)]) == "the simulated time"
    assert describe([{"a": 1}, "b"]) == "a; b"
