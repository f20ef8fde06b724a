"""The exercise `record`: right answers in various styles, and wrong ones."""

from contextlib import suppress
from queue import Empty

from tutorial.checks.record import NEVER, MyRecorder, QueueRecorder, record

from . import edited


class Patient(QueueRecorder):
    def write(self):
        while True:
            with suppress(Empty):
                entry = self.received.get(timeout=0.1)
                if entry is None:
                    return
                self.bag.write(self.connection, timestamp=entry[0], data=entry[1])

    def unconfigure(self):
        self.node.destroy_subscription(self.subscription)
        self.received.put(None)
        while self.writer.is_alive():
            self.writer.join(1.0)
        self.bag.close()


class ClosesInTheThread(QueueRecorder):
    def write(self):
        while entry := self.received.get(True):
            self.bag.write(self.connection, *entry)
        self.bag.close()

    def unconfigure(self):
        self.node.destroy_subscription(self.subscription)
        self.received.put(None)
        self.writer.join(10.0)


class Polls(MyRecorder):
    def write(self):
        while True:
            if not self.received.empty():
                super().write()


class Counts(MyRecorder):
    """Extend `configure`, which the notebook allows."""

    def configure(self, config):
        self.count = 0
        super().configure(config)

    def write(self):
        for entry in iter(self.received.get, None):
            self.bag.write(self.connection, *entry)
            self.count += 1


class CountsTooLate(Counts):
    def configure(self, config):
        MyRecorder.configure(self, config)
        self.count = 0

    def write(self):
        before = self.count
        super().write()
        assert self.count >= before


class CallsNoSuper(Counts):
    def configure(self, config):
        self.count = 0
        if config is None:
            super().configure(config)


class GoesOn(MyRecorder):
    def write(self):
        while True:
            if entry := self.received.get():
                self.bag.write(self.connection, *entry)


RIGHT = [Patient, ClosesInTheThread, Counts]
WRONG = [
    (edited(record, ("*received)", "*received[::-1])")), "self.bag.write(self.connection, time_ns, payload)"),
    (edited(record, ("join()", "join(0.1)")), "your code closes the bag"),
    (edited(record, ("self.writer.join()", "self.write()")), "Your code probably removes None from the queue"),
    (
        edited(
            record, ("self.received.put(None)", "pass"), ("self.bag.close", "self.received.put(None)\nself.bag.close")
        ),
        NEVER,
    ),
    (CountsTooLate, "super().configure(config) starts the thread"),
    (CallsNoSuper, "Call the method: it creates the queue"),
    (GoesOn, "Your code probably continues after None"),
    (Polls, ["get() waits for an entry"]),
]
