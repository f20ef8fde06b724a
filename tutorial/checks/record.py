"""The exercise `record`: a thread that writes, and how it ends.

Write two methods of `MyRecorder`, the rest of a recorder:

- `write` is the thread's function. It writes each entry of the queue, a time and a payload, as it comes, with
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

from collections.abc import Sequence
from functools import partial
from queue import Empty, SimpleQueue
from threading import Thread, current_thread
from types import SimpleNamespace as Namespace
from typing import Any

from rclpy.time import Time

from tutorial.checks.exercise import Case, Cases, Exercise, Failure, Misuse, call, watch
from tutorial.controller import SimpleController


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


MISTAKES = """
the bag is closed while the thread may still write: wait for it before, self.writer.join(), however long it takes.
    self.writer.join() => pass => self.bag.close() // self.writer.join()

None comes into the queue while messages may still come, and those after it are lost: stop listening first.
    self.node.destroy => self.received.put(None) // self.node.destroy

get is called twice in a turn, and each call takes an entry out: take one, keep it, and write that.
    received := self.received.get() => self.received.get()
    *received) => *self.received.get())

the thread ends where the queue is empty, as with `while not empty()` or get(timeout=...): get() waits for the next.
    while received := self.received.get(): => while not self.received.empty() and (received := self.received.get()):

the thread ends before it has written what waits in the queue: let only None end it, which comes behind all others.
    received := self.received.get() => not vars(self).get("ends") and (received := self.received.get())
    self.received.put(None) => self.ends = True // self.received.put(None)

the messages are kept until the end, and lost if the program dies: write each one as it comes.
    while received := self.received.get(): => for received in [*iter(self.received.get, None)]:

# one by one
Take one entry after the other, end if it is None, else self.bag.write(self.connection, time_ns, payload), as it stands.

#
Compare with: stop listening, put None, join, close. The thread alone writes, until it takes None.
"""
STUCK = "Most likely write does not end at None, or None is put after join, or never, or somebody else takes it out."
BUSY = "That keeps the processor busy: self.received.get() waits for an entry by itself, and join for the thread's end."
OFTEN = 100  # times that somebody asks whether the queue is empty


class Surroundings:
    """A recorder's queue, node, thread and bag. The disk takes a second for the first message.

    So the thread rests there, or where the queue is empty, until somebody waits for its end.

    Args:
        recorder: the learner's.
        waiting: entries in the queue.
        coming: those that come one by one when the queue is empty, or all at once when it stops listening.
    """

    def __init__(self, recorder: Any, waiting: Sequence[Any], coming: Sequence[Any]) -> None:
        self.recorder, self.entries, self.coming = recorder, [*waiting], [*coming]
        self.written: list[str] = []
        self.taken = self.asked = 0
        self.keeps = self.hurries = False
        self.listens = self.is_open = self.rests = True
        self.failure: Failure | None = None
        self.begun, self.turn = SimpleQueue[None](), SimpleQueue[None]()
        self.thread = Thread(target=self.run, daemon=True)
        recorder.connection, recorder.subscription = "connection", Namespace(destroy=lambda: None)
        recorder.received = Namespace(get=self.get, put=self.entries.append, empty=self.empty)
        recorder.received.get_nowait = partial(self.get, block=False)
        clock = Namespace(now=lambda: Time(nanoseconds=9))
        recorder.node = Namespace(destroy_subscription=self.destroy, get_clock=lambda: clock)
        recorder.writer = Namespace(join=self.join, is_alive=self.thread.is_alive)
        recorder.bag = Namespace(write=self.write, close=self.close)

    def run(self) -> None:
        """Run the learner's thread."""
        try:
            with watch.call("write"):
                self.recorder.write()
        except Failure as failure:
            self.failure = failure
        self.begun.put(None)

    def rest(self) -> None:
        """Have the thread rest, once, until somebody waits for its end."""
        if self.rests:
            self.begun.put(None)
            self.turn.get()

    def get(self, block: bool = True, timeout: float | None = None) -> Any:
        """Take an entry out of the queue."""
        self.asked = 0
        self.keeps |= self.taken > len(self.written)
        if not self.entries and not self.coming:
            self.rest()
        if not self.entries and self.coming:
            self.entries.append(self.coming.pop(0))
            if timeout is not None or not block:
                raise Empty
        if not self.entries:
            raise Misuse("it waits for ever for another entry", STUCK)
        self.taken += 1
        return self.entries.pop(0)

    def empty(self) -> bool:
        """Say whether nothing is in the queue."""
        self.asked += 1
        if self.asked > OFTEN:
            raise Misuse("it asks again and again whether the queue is empty", BUSY)
        return not self.entries

    def destroy(self, subscription: Any) -> None:
        """Stop listening."""
        self.entries += self.coming
        self.coming.clear()
        self.listens = subscription is not self.recorder.subscription

    def join(self, timeout: float | None = None) -> None:
        """Wait for the thread's end, which takes a second."""
        self.hurries = not self.hurries and timeout is not None and timeout <= 1.0
        if not self.hurries:
            self.end()
        if self.failure:
            raise self.failure

    def end(self) -> None:
        """Let the thread run, and wait for its end."""
        self.turn.put(None)
        self.thread.join()

    def write(self, connection: str, timestamp: int, data: bytes) -> None:
        """Write into the bag."""
        odd = ", to another connection" * (connection != self.recorder.connection) + ", too late" * (not self.is_open)
        beside = ", beside the thread" * (current_thread() is not self.thread and self.thread.is_alive())
        self.written.append(f"{data!r} of {timestamp!r} ns{odd}{beside}")
        self.rest()

    def close(self) -> None:
        """Close the bag."""
        self.is_open = False


def tried(*waiting: Any, coming: Sequence[Any] = ()) -> Case:
    """Observe what is written, and what is left of a recorder; unless its end has come already, it leaves its body.

    Args:
        waiting, coming: as for `Surroundings`.
    """

    def case(answer: Any) -> str:
        scene = Surroundings(call(answer), waiting, coming)
        scene.thread.start()
        scene.begun.get()
        scene.rests = False
        also, leaves = list[str](), None not in coming
        try:
            if leaves:
                with watch.call("unconfigure"):
                    scene.recorder.unconfigure()
                also += ["it still listens"] * scene.listens + ["the thread goes on"] * scene.thread.is_alive()
        finally:
            scene.end()
        scene.join()
        also += ["the bag is open"] * (leaves and scene.is_open) + ["it takes the next one first"] * scene.keeps
        return ", ".join([*(scene.written or ["nothing is written"]), *also])

    return case


A, B, C = (5, b"A"), (7, b"B"), (7, b"")  # the time [ns], and the payload, which may be empty
TRIED = {
    "messages come one by one": tried(coming=[A, B, None]),
    "three messages wait": tried(A, B, C),
    "a message comes while it stops listening": tried(A, coming=[B]),
}
CASES = Cases(MyRecorder, TRIED, MISTAKES, str, crashes=["one by one"])
record = Exercise("record", __doc__, CASES, ("write", "unconfigure"))
