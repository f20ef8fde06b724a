"""The exercise `pair`: every wrong answer is told its cause."""

from __future__ import annotations

from collections import OrderedDict, deque

import pytest

from tutorial.checks.pose import Pairs, pair
from tutorial.controllers.pose_subscriber import StampPairs


def stamp_of(message):
    return message.header.stamp.sec, message.header.stamp.nanosec


class Library:
    """As the library does it."""

    def __init__(self):
        self.pairs = StampPairs(lambda why: None)

    def add(self, stream, message):
        found = self.pairs.add(stream, message)
        return found and [found["joints"], found["pose"]]


class Queues:
    """Two queues of at most 50, in the order of arrival."""

    def __init__(self):
        self.queues = {"joints": deque(maxlen=50), "pose": deque(maxlen=50)}

    def other(self, stream):
        return self.queues["pose" if stream == "joints" else "joints"]

    def add(self, stream, message):
        others = self.other(stream)
        for i, each in enumerate(others):
            if self.same(each, message):
                self.past(stream, i)
                return self.both(stream, message, each)
        self.keep(self.queues[stream], message)
        return None

    def same(self, a, b):
        return stamp_of(a) == stamp_of(b)

    def past(self, stream, i):
        self.queues[stream].clear()
        for _ in range(i + 1):
            self.other(stream).popleft()

    def keep(self, queue, message):
        queue.append(message)

    def both(self, stream, message, other):
        return (message, other) if stream == "joints" else (other, message)


class TwoDicts:
    def __init__(self):
        self.waiting = {"joints": OrderedDict(), "pose": OrderedDict()}

    def add(self, stream, message):
        stamp = stamp_of(message)
        others = self.waiting["pose" if stream == "joints" else "joints"]
        self.waiting[stream][stamp] = message
        if stamp in others:
            found = tuple(self.waiting[each][stamp] for each in ("joints", "pose"))
            for waiting in self.waiting.values():
                while waiting.popitem(last=False)[0] != stamp:
                    pass
            return found
        if len(self.waiting[stream]) > 50:
            self.waiting[stream].popitem(last=False)
        return None


@pytest.mark.parametrize("answer", [Pairs, Library, Queues, TwoDicts])
def test_right_answers_are_right(answer):
    verdict = pair.judge(answer)
    assert verdict.right, str(verdict)


class SecondsAlone(Queues):
    def same(self, a, b):
        return a.header.stamp.sec == b.header.stamp.sec


class NanosecondsAlone(Queues):
    def same(self, a, b):
        return a.header.stamp.nanosec == b.header.stamp.nanosec


class AnyStamp(Queues):
    def add(self, stream, message):
        others = self.other(stream)
        if others:
            newest = others[-1]
            self.past(stream, len(others) - 1)
            return self.both(stream, message, newest)
        self.keep(self.queues[stream], message)
        return None


class FirstThatWaits(Queues):
    def same(self, a, b):
        return True


class AlmostTheSame(Queues):
    def same(self, a, b):
        (s, n), (t, m) = stamp_of(a), stamp_of(b)
        return abs((s - t) + (n - m) / 1e9) < 0.0201


class AsTheyCame(Queues):
    def both(self, stream, message, other):
        return other, message


class PoseFirst(Queues):
    def both(self, stream, message, other):
        return super().both(stream, message, other)[::-1]


class OnlyWhenAPoseComes(Queues):
    def add(self, stream, message):
        if stream == "joints":
            self.keep(self.queues[stream], message)
            return None
        return super().add(stream, message)


class OnlyWhenJointsCome(Queues):
    def add(self, stream, message):
        if stream == "pose":
            self.keep(self.queues[stream], message)
            return None
        return super().add(stream, message)


class NothingIsPast(Queues):
    def past(self, stream, i):
        del self.other(stream)[i]


class AllIsPast(Queues):
    def past(self, stream, i):
        for queue in self.queues.values():
            queue.clear()


class Stays:
    def __init__(self):
        self.waiting = {}

    def add(self, stream, message):
        together = self.waiting.setdefault(stamp_of(message), {})
        together[stream] = message
        if len(together) == 2:
            for stamp in list(self.waiting):
                if stamp == stamp_of(message):
                    break
                del self.waiting[stamp]
            return together["joints"], together["pose"]
        if len(self.waiting) > 50:
            del self.waiting[next(iter(self.waiting))]
        return None


class OnlyOne(Queues):
    def __init__(self):
        self.queues = {"joints": deque(maxlen=1), "pose": deque(maxlen=1)}


class NoLimit(Queues):
    def __init__(self):
        self.queues = {"joints": deque(), "pose": deque()}


class SmallestGivesWay(NoLimit):
    def keep(self, queue, message):
        queue.append(message)
        if len(queue) > 50:
            queue.remove(min(queue, key=stamp_of))


class AllGiveWay(NoLimit):
    def keep(self, queue, message):
        queue.append(message)
        if len(queue) > 50:
            queue.clear()


class NoRoom(NoLimit):
    def keep(self, queue, message):
        if len(queue) < 50:
            queue.append(message)


class NeverBack(Queues):
    newest = (-1, 0)

    def add(self, stream, message):
        if stamp_of(message) < self.newest:
            return None
        found = super().add(stream, message)
        if found:
            self.newest = stamp_of(message)
        return found


class OnTheClass(Queues):
    queues = {"joints": deque(maxlen=50), "pose": deque(maxlen=50)}

    def __init__(self):
        pass


class NoReturn(Queues):
    def add(self, stream, message):
        super().add(stream, message)


class AsDict(Queues):
    def both(self, stream, message, other):
        return dict(zip(("joints", "pose"), super().both(stream, message, other)))


class HalfAPair(Queues):
    def add(self, stream, message):
        return super().add(stream, message) or self.both(stream, message, None)


class Stamps(Queues):
    def both(self, stream, message, other):
        return stamp_of(message), stamp_of(other)


class StampAsKey(Stays):
    def add(self, stream, message):
        self.waiting.setdefault(message.header.stamp, {})[stream] = message


class TakesItForGranted(Stays):
    def add(self, stream, message):
        together = self.waiting.setdefault(stamp_of(message), {})
        together[stream] = message
        return together["joints"], together["pose"]


WRONG = [
    (SecondsAlone, "only the seconds are compared"),
    (NanosecondsAlone, "only nanosec is compared"),
    (AnyStamp, "the newest of the other stream is taken"),
    (FirstThatWaits, "the first that waits is taken"),
    (AlmostTheSame, "stamps that are almost the same"),
    (AsTheyCame, "joints come first in a pair"),
    (PoseFirst, "joints come first in a pair"),
    (OnlyWhenAPoseComes, "only when a pose comes"),
    (OnlyWhenJointsCome, "only when joints come"),
    (NothingIsPast, "what came before a pair still waits"),
    (AllIsPast, "a pair drops all that waits"),
    (Stays, "a pair goes on waiting after it was returned"),
    (OnlyOne, "only one message of a stream is kept"),
    (NoLimit, "there is no limit to what waits"),
    (SmallestGivesWay, "the smallest stamp gives way"),
    (AllGiveWay, "of more than 50 all are dropped"),
    (NoRoom, "what comes when 50 wait is not kept"),
    (NeverBack, "an older stamp than the last is refused"),
    (OnTheClass, "belongs to the class"),
    (NoReturn, "return is missing"),
    (AsDict, "Return the two messages"),
    (HalfAPair, "Return the two messages"),
    (Stamps, "Return the messages themselves"),
    (StampAsKey, "the stamp itself is the key of a dict"),
    (TakesItForGranted, "a partner is taken for granted"),
]


@pytest.mark.parametrize(("answer", "cause"), WRONG, ids=lambda value: getattr(value, "__name__", ""))
def test_wrong_answers_are_told_their_cause(answer, cause):
    verdict = pair.judge(answer)
    assert not verdict.right
    assert cause in verdict.causes[0], str(verdict)
