"""The exercise `keep_up`: right answers in their styles, and what no edit of the solution tells."""

import threading

from tutorial.checks.joint_state_subscriber import CalmViewer


class WithAnAttribute(CalmViewer):
    def on_joint_state(self, message):
        self.message = message
        self.call_latest("joints", self.draw)

    def draw(self):
        self.update(self.message)


class TakesUnderALock(CalmViewer):
    def configure(self, config):
        self.lock, self.newest, self.call_later = threading.Lock(), None, config.call_later
        super().configure(config)

    def on_joint_state(self, message):
        with self.lock:
            first, self.newest = self.newest is None, message
        if first:
            self.call_later(self.draw)

    def draw(self):
        with self.lock:
            message, self.newest = self.newest, None
        self.update(message)


RIGHT = [WithAnAttribute, TakesUnderALock]


class WithoutAKey(CalmViewer):
    def on_joint_state(self, message):
        self.call_latest(self.update, message)


class TakesBeforeItLetsTheNextCome(CalmViewer):
    waits = False

    def on_joint_state(self, message):
        self.message = message
        if not self.waits:
            self.waits = True
            self.call_latest("joints", self.draw)

    def draw(self):
        self.update(self.message)
        self.waits = False


class TakesTheOldest(CalmViewer):
    def configure(self, config):
        self.queue = []
        super().configure(config)

    def on_joint_state(self, message):
        self.queue.append(message)
        self.call_latest("joints", self.draw)

    def draw(self):
        self.update(self.queue.pop(0))


WRONG = [
    (WithoutAKey, "takes a key first"),
    (TakesTheOldest, "you draw the oldest message of a queue"),
    (TakesBeforeItLetsTheNextCome, "clear the flag of a waiting call after you take the message"),
]
