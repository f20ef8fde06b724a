"""The exercise `pair`: right answers in various styles, and wrong ones."""

from collections import deque

from tutorial.checks.pair import Pairs
from tutorial.controllers.pose_subscriber import StampPairs


def stamp_of(message):
    return message.header.stamp.sec, message.header.stamp.nanosec


class Library(StampPairs):
    """Match messages like the library."""

    def __init__(self):
        super().__init__(lambda why: None)

    def add(self, stream, message):
        found = super().add(stream, message)
        return found and [*found]


class Queues:
    """Keep two queues of at most 50 messages, in the order of arrival."""

    def __init__(self, most=50):
        self.queues = {"joints": deque(maxlen=most), "pose": deque(maxlen=most)}

    def add(self, stream, message):
        others = self.queues["pose" if stream == "joints" else "joints"]
        for i, each in enumerate(others):
            if stamp_of(each) == stamp_of(message):
                self.queues[stream].clear()
                for _ in range(i + 1):
                    others.popleft()
                return (message, each) if stream == "joints" else (each, message)
        self.queues[stream].append(message)
        return None


RIGHT = [Pairs, Library, Queues]


class ADefault(Pairs):
    def __init__(self, waiting={}):  # noqa: B006 - it is what is looked at
        self.waiting = waiting


class OnlyTwenty(Queues):
    def __init__(self):
        super().__init__(20)


def returning(shape):
    class Shaped(Queues):
        def add(self, stream, message):
            return shape(super().add(stream, message))

    return Shaped


class NeverBehind(Queues):
    newest = (-1, 0)

    def add(self, stream, message):
        if stamp_of(message) < (self.newest[0] - 100, 0):
            return None
        self.newest = max(self.newest, stamp_of(message))
        return super().add(stream, message) if self.newest[0] < 5 or stamp_of(message)[0] >= 5 else None


class OneLate(Pairs):
    earlier = None

    def add(self, stream, message):
        pair, self.earlier = self.earlier, super().add(stream, message)
        return pair


WRONG = [
    (OneLate, "Return a pair when its second message arrives"),
    (ADefault, "on the class, or in a parameter's default value"),
    (OnlyTwenty, "Your code probably keeps fewer or more than 50 waiting messages"),
    (returning(lambda found: found and dict(zip(("joints", "pose"), found))), "Return the two messages"),
    (NeverBehind, "After a restart, stamps start at 0"),
]
