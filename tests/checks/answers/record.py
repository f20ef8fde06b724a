"""The exercise `record`: right answers in their styles, and what no edit of the solution tells."""

from contextlib import suppress
from queue import Empty

from tutorial.checks.record import MyRecorder, QueueRecorder


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


class Exchanged(MyRecorder):
    def write(self):
        while entry := self.received.get():
            self.bag.write(self.connection, *entry[::-1])


class Hurries(MyRecorder):
    def unconfigure(self):
        self.node.destroy_subscription(self.subscription)
        self.received.put(None)
        self.writer.join(0.1)
        self.bag.close()


class Polls(MyRecorder):
    def write(self):
        while True:
            if not self.received.empty():
                super().write()


class WritesItself(MyRecorder):
    def unconfigure(self):
        self.node.destroy_subscription(self.subscription)
        self.received.put(None)
        self.write()
        self.bag.close()


RIGHT = [Patient, ClosesInTheThread]
WRONG = [
    (Exchanged, ["self.bag.write(self.connection, time_ns, payload)"]),
    (Hurries, ["the bag is closed"]),
    (Polls, ["get() waits for an entry"]),
    (WritesItself, ["None is put after join, or never"]),
]
