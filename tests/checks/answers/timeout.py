"""The exercise `timeout`: right answers in their styles, and what no edit of the solution tells."""

from copy import copy

from tutorial.checks.timeout import CommandTimeout


class Deadline:
    """It keeps until when the message is fresh."""

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
        self.message = message  # so that no other gets its id
        return seconds <= came + 0.5


class Shared(CommandTimeout):
    came: dict = {}

    def __init__(self):
        pass

    def fresh(self, message, seconds):
        if self.came.get("message") is not message:
            self.came.update(message=message, since=seconds)
        return seconds - self.came["since"] <= 0.5


class SaysTheAge(CommandTimeout):
    def fresh(self, message, seconds):
        super().fresh(message, seconds)
        return seconds - self.since


class KeepsACopy(CommandTimeout):
    def fresh(self, message, seconds):
        fresh = super().fresh(message, seconds)
        self.message = copy(message)
        return fresh


RIGHT = [Deadline, Identity]
WRONG = [(Shared, ["in __init__"]), (SaysTheAge, ["Return True or False"]), (KeepsACopy, ["keep no copy"])]
