"""The exercise `record`: right answers in their styles, and what no edit of the solution tells."""

from __future__ import annotations

from tutorial.checks.record import MyRecorder, QueueRecorder


class Breaks(QueueRecorder):
    def write(self):
        while True:
            entry = self.received.get()
            if entry is None:
                break
            time_ns, payload = entry
            self.bag.write(self.connection, time_ns, payload)

    def unconfigure(self):
        self.node.destroy_subscription(self.subscription)
        self.received.put(None)
        self.writer.join()
        self.bag.close()


class Iterates(MyRecorder):
    def write(self):
        for time_ns, payload in iter(self.received.get, None):
            self.bag.write(self.connection, time_ns, payload)


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


class ClosesFirst(MyRecorder):
    def unconfigure(self):
        self.bag.close()
        super().unconfigure()


class PutsNothing(MyRecorder):
    def unconfigure(self):
        self.node.destroy_subscription(self.subscription)
        self.writer.join()
        self.bag.close()


class WritesItself(MyRecorder):
    def unconfigure(self):
        self.node.destroy_subscription(self.subscription)
        self.received.put(None)
        self.write()
        self.bag.close()


RIGHT = [Breaks, Iterates, ClosesInTheThread]
WRONG = [
    (Exchanged, ["stop listening, put None, join, close"]),
    (ClosesFirst, ["the bag is closed"]),
    (PutsNothing, ["nothing puts None into the queue"]),
    (WritesItself, ["nothing puts None into the queue"]),
]
