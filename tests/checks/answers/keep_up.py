"""The exercise `keep_up`: right answers in various styles, and wrong ones."""

import threading

from tutorial.checks.joint_state_subscriber import CalmViewer, keep_up

from . import edited


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


BUSY = "self.node = config.node", "self.node, self.busy = config.node, False"
TAKE = 'lambda: [self.update(self.message), setattr(self, "busy", False)])'
POST = "self.call_latest("
ONCE = f"if self.busy: return\nself.busy = True\n{POST}"
WRONG = [
    (WithoutAKey, "The first argument of call_latest is a key"),
    (edited(keep_up, ("config.call_latest", "lambda _, *call: config.call_later(*call)")), "or under different keys"),
    (edited(keep_up, BUSY, (POST, ONCE), ("self.body.calc", "self.busy = False\nself.body.calc")), "an older message"),
    (
        edited(keep_up, BUSY, ("self.update, message)", TAKE), (POST, f"self.message = message\n{ONCE}")),
        "clears the flag of a waiting call too late",
    ),
]
