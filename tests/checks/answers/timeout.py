"""The exercise `timeout`: right answers in various styles, and wrong ones."""

from tutorial.checks.timeout import CommandTimeout, timeout

from . import edited


class Deadline:
    """Keep the time until which the message is fresh."""

    def __init__(self):
        self.last = self.until = None

    def fresh(self, message, seconds):
        if self.last is not message:
            self.last, self.until = message, seconds + 0.5
        return not seconds > self.until


class Identity:
    kept = (None, 0)

    def fresh(self, message, seconds):
        came = self.kept[1] if self.kept[0] == id(message) else seconds
        self.kept = id(message), came
        self.message = message  # keeps its id from being reused
        return seconds <= came + 0.5


class Shared(CommandTimeout):
    came: dict = {}

    def __init__(self):
        pass

    def fresh(self, message, seconds):
        if self.came.get("message") is not message:
            self.came.update(message=message, since=seconds)
        return seconds - self.came["since"] <= 0.5


RIGHT = [Deadline, Identity]
WRONG = [
    (Shared, "in __init__"),
    (edited(timeout, (" <= 0.5", "")), "Return True or False"),
    (edited(timeout, ("self.message = message", "self.message = Joy(axes=message.axes)")), "don't store a copy"),
]
