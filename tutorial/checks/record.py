"""The exercise `record`: a thread that writes, and how it ends.

Write two methods of `MyRecorder`, the rest of a recorder:

- `write` is the thread's function. It writes each entry of the queue, a time and a payload, with
  `self.bag.write(self.connection, time_ns, payload)`. `self.received.get()` waits for an entry. `None` ends the
  thread.
- `unconfigure` ends all that `configure` has begun. Every message that has come is then in the bag, and nothing writes
  into it after `self.bag.close()`. `self.writer.join()` waits for the thread's end.

Hint 1: Look at what may still happen in each line of unconfigure: may a message come, does one wait in the queue, does
the thread write?

Hint 2: First let nothing more come, then end the thread with an entry that comes after all others, wait for it, and
only then close the bag. In write a loop takes one entry after the other, until None.

Hint 3: while received := self.received.get(): self.bag.write(self.connection, *received). And unconfigure has four
lines: self.node.destroy_subscription(self.subscription), self.received.put(None), self.writer.join() and
self.bag.close().

Notice that the callback never waits for the disk, and that no message is lost at the end.
"""

from __future__ import annotations

from collections.abc import Sequence
from types import SimpleNamespace as Namespace
from typing import Any

from tutorial.checks._cases import Case, Cases, call, mistakes
from tutorial.checks._diagnose import Misuse
from tutorial.checks._watch import Failure, watch
from tutorial.checks.exercise import Exercise
from tutorial.controller import SimpleController

__all__ = ["MyRecorder", "record"]


class QueueRecorder(SimpleController):
    """The rest of the recorder, in the notebook. Here `Surroundings` gives it what its `configure` makes there."""


class MyRecorder(QueueRecorder):
    """Write what is in the queue, on a thread of its own."""

    def write(self: Any) -> None:
        """Write the entries of the queue, until None comes."""
        while received := self.received.get():
            self.bag.write(self.connection, *received)

    def unconfigure(self: Any) -> None:
        """Stop listening, let the thread write the rest, and close the bag."""
        self.node.destroy_subscription(self.subscription)
        self.received.put(None)
        self.writer.join()
        self.bag.close()


MISTAKES = mistakes("""
the bag is closed while the thread may still write: wait for it before, self.writer.join().
    self.writer.join() => pass

None comes into the queue while messages may still come, and those after it are lost: stop listening first.
    self.node.destroy => self.received.put(None) // self.node.destroy

only one entry is written: take one after the other, in a loop.
    *received) => *received) // break

the thread ends as soon as the queue is empty, and the next message finds none: get waits, and None is the end.
    while received := self.received.get(): => while not self.received.empty() and (received := self.received.get()):
""")
STUCK = "Most likely nothing puts None into the queue, self.received.put(None), or write does not end at None."


class Surroundings:
    """A recorder's queue, node, thread and bag. The thread's turn comes when somebody waits for it.

    Args:
        recorder: the learner's.
        waiting: entries in the queue.
        coming: those that come one by one when the queue is empty, or all at once when it stops listening.
    """

    def __init__(self, recorder: Any, waiting: Sequence[Any], coming: Sequence[Any]) -> None:
        self.recorder, self.entries, self.coming = recorder, [*waiting], [*coming]
        self.written: list[str] = []
        self.listens = self.is_open = self.runs = True
        recorder.connection, recorder.subscription = "connection", "subscription"
        recorder.received = Namespace(get=self.get, put=self.put, put_nowait=self.put, empty=lambda: not self.entries)
        recorder.node = Namespace(destroy_subscription=self.destroy)
        recorder.writer = Namespace(join=self.join, is_alive=lambda: self.runs)
        recorder.bag = Namespace(write=self.write, close=self.close)

    def get(self, *_how: Any, **_more: Any) -> Any:
        """Take an entry out of the queue."""
        if not self.entries and self.coming:
            self.entries.append(self.coming.pop(0))
        if not self.entries:
            raise Failure("write", Misuse("it waits for ever for another entry", STUCK))
        return self.entries.pop(0)

    def put(self, entry: Any, *_how: Any, **_more: Any) -> None:
        """Put an entry into the queue."""
        self.entries.append(entry)

    def destroy(self, subscription: str) -> None:
        """Stop listening."""
        self.entries += self.coming
        self.coming.clear()
        self.listens = subscription != self.recorder.subscription

    def join(self, *_how: Any, **_more: Any) -> None:
        """Let the thread run to its end."""
        if self.runs:
            self.runs = False
            with watch.call("write"):
                self.recorder.write()

    def write(self, connection: str, time_ns: int, payload: bytes) -> None:
        """Write into the bag."""
        right = self.is_open and connection == self.recorder.connection
        self.written.append(f"{payload!r} of {time_ns!r} ns" + ", too late or to another connection" * (not right))

    def close(self) -> None:
        """Close the bag."""
        self.is_open = False


def tried(*waiting: Any, coming: Sequence[Any] = (), leaves: bool = True) -> Case:
    """Observe what is written, and what is left of a recorder that has left its body.

    Args:
        waiting, coming: as for `Surroundings`.
        leaves: whether it leaves its body.
    """

    def case(answer: Any) -> str:
        scene = Surroundings(call(answer), waiting, coming)
        if leaves:
            with watch.call("unconfigure"):
                scene.recorder.unconfigure()
        scene.join()
        also = ["the bag is open"] * scene.is_open + ["it still listens"] * scene.listens
        return ", ".join([*(scene.written or ["nothing is written"]), *(also if leaves else ())])

    return case


A, B, C = (5, b"A"), (7, b"B"), (7, b"C")  # the time [ns], and the payload
TRIED = {
    "three messages wait": tried(A, B, C),
    "a message comes while it stops listening": tried(A, coming=[B]),
    "messages come one by one": tried(coming=[A, B, None], leaves=False),
}
CASES = Cases(MyRecorder, TRIED, MISTAKES, str, {"": "Compare with: stop listening, put None, join, close."})

record = Exercise("record", __doc__, CASES.judge, MyRecorder, ("write", "unconfigure"))
