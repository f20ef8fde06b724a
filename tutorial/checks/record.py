"""The exercise `record`: a thread that writes to a bag, and how to end it.

Write the two methods of `MyRecorder` that `QueueRecorder` lacks:

- `write` runs on the recorder's thread. It takes entries, each a time [ns] and a payload, from the queue one by one,
  and writes each entry immediately and unchanged, with `self.bag.write(self.connection, time_ns, payload)`. It writes
  an entry even if an earlier entry had the same payload or time: a repeated message is still a message.
  `self.received.get()` waits for an entry. `None` ends the thread.
- `unconfigure` stops everything that `configure` has started. When it returns, the bag contains every received message.
  Nothing may write to the bag after `self.bag.close()`. `self.writer.join()` waits until the thread has ended.
- You may also extend `configure`. If you do, call `super().configure(config)` in it. This call starts the thread, so
  first set everything that `write` needs.

Hint 1: Go through unconfigure line by line. After each line, ask: can a message still arrive, can one still be waiting
in the queue, and can the thread still write?

Hint 2: First stop listening, so that no more messages arrive. Then put one last entry into the queue to end the thread;
wait until the thread has ended, and only then close the bag. In write, a loop takes one entry after another until it
gets None.

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
from unittest.mock import patch

from rclpy.logging import get_logger
from rclpy.time import Time

from tutorial.checks.engine.cases import Case, Cases, Mistake, Run, both, replace
from tutorial.checks.engine.failure import Failure, Misuse
from tutorial.checks.engine.trial import Trial
from tutorial.checks.exercise import Exercise
from tutorial.controller import SimpleController


class QueueRecorder(SimpleController):
    """Stand in for the notebook's class of the same name. `Surroundings` does the work of its `configure`."""


class MyRecorder(QueueRecorder):
    """Write the queue's entries on a separate thread."""

    def write(self: Any) -> None:
        """Write one entry after another, until an entry is None."""
        while received := self.received.get():
            self.bag.write(self.connection, *received)

    def unconfigure(self: Any) -> None:
        """Stop listening, let the thread write the rest, and close the bag."""
        self.node.destroy_subscription(self.subscription)
        self.received.put(None)
        self.writer.join()
        self.bag.close()


MISTAKES = [
    Mistake("your code closes the bag while the thread can still write: "
            "call self.writer.join() first, without a timeout.",
            replace("self.writer.join()", "pass", "self.bag.close()\nself.writer.join()")),
    Mistake("your code calls get twice in each iteration, and each call removes an entry: "
            "call get once, and write its result.",
            both(replace("received := self.received.get()", "self.received.get()"),
                 replace("*received)", "*self.received.get())"))),
    Mistake("your code ends the thread when the queue is empty, for example with `while "
            "not empty()` or get(timeout=...): wait for the next entry with get().",
            replace("while received := self.received.get():",
                    "while not self.received.empty() and (received := self.received.get()):")),
    Mistake("something other than None, such as a flag, ends the thread while "
            "entries are still waiting. Only None may end the thread.",
            both(replace("while received := self.received.get():",
                         "self.is_over = False\nwhile not self.is_over and (received := self.received.get()):"),
                 replace("self.received.put(None)", "self.is_over = True\nself.received.put(None)"))),
    Mistake("your code writes the messages only at the end, so they are lost if the program "
            "crashes: write each message before you get the next.",
            replace("while received := self.received.get():", "for received in [*iter(self.received.get, None)]:")),
]  # fmt: skip
MEANING = ("Compare your steps with these: stop listening, put None, join, close. "
           "Only the thread removes entries and writes them, and only None ends the thread.")  # fmt: skip
NEVER = "Your code probably calls put(None) after join, or not at all: call it before join, so that the thread ends."
PAST_NONE = "Your code probably continues after None: exit the loop after None."
STOLEN = "Your code probably removes None from the queue outside of the thread: call get only in write."
BUSY = ("A busy loop wastes CPU time: self.received.get() waits for an entry, "
        "and self.writer.join() waits for the thread.")  # fmt: skip
THE_NODE = ("The node belongs to the whole program: destroy only the subscription, "
            "with self.node.destroy_subscription(self.subscription).")  # fmt: skip
NO_SUPER = "Call the method: it creates the queue, the bag, the thread and the subscription."
TOO_EARLY = "super().configure(config) starts the thread: before that line, set everything that write needs."
OFTEN = 100  # the limit on consecutive calls to empty()


class Surroundings:
    """A recorder's queue, node, thread and bag. The disk takes a second to write the first message.

    During that write, or when the queue is empty, the thread pauses until some code waits for it to end.

    Args:
        trial: the trial of the learner's recorder.
        waiting: the entries that are in the queue from the start.
        coming: entries that arrive one by one while the queue is empty; the rest arrive when the recorder stops
            listening.
    """

    def __init__(self, trial: Trial, waiting: Sequence[Any], coming: Sequence[Any]) -> None:
        self.trial, self.recorder = trial, trial.call(trial.answer)
        self.entries, self.coming = [*waiting], [*coming]
        self.written: list[str] = []
        self.taken = self.asked = 0
        self.keeps = self.hurries = False
        self.listens = self.is_open = self.rests = True
        self.failure: Failure | None = None
        self.ended_by: Thread | None = None  # the thread that took None from the queue
        self.begun, self.turn = SimpleQueue[None](), SimpleQueue[None]()
        self.thread = Thread(target=self.run, daemon=True)
        clock = Namespace(now=lambda: Time(nanoseconds=9))
        self.node = Namespace(destroy_subscription=self.destroy, destroy_node=destroy_node, get_clock=lambda: clock)
        self.node.get_logger = partial(get_logger, "tank")

    def configure(self) -> None:
        """Call the learner's `configure`, with `begin` in place of the notebook's `configure`.

        The notebook's method, or a learner's copy of it, is the first `configure` in the MRO that calls no other
        `configure`.

        Raises:
            Failure: the method raised an exception, did not call the notebook's method, or started the thread too
                early.
        """
        kinds = [each for each in type(self.recorder).__mro__ if "configure" in vars(each)]
        base = next((each for each in kinds if not _calls_configure(vars(each)["configure"])), SimpleController)
        with patch.object(base, "configure", self.begin), self.trial.calling("configure"):
            self.recorder.configure(Namespace(body=Namespace(name="Tank"), node=self.node))
            if not self.thread.ident:
                raise Misuse("it does not call super().configure(config)", NO_SUPER)
        error = self.failure and self.failure.error
        if self.failure and isinstance(error, AttributeError) and hasattr(self.recorder, str(error.name)):
            text = f"it reads self.{error.name} before configure has set it"
            raise Failure("write", Misuse(text, TOO_EARLY), self.failure.place)

    def begin(self, *_: object) -> None:
        """Do the work of the notebook's `configure`. The thread runs until its first pause."""
        recorder = self.recorder
        recorder.connection, recorder.subscription = "connection", Namespace(destroy=lambda: None)
        recorder.received = Namespace(get=self.get, put=self.entries.append, empty=self.empty)
        recorder.received.get_nowait = partial(self.get, block=False)
        recorder.node = self.node
        recorder.writer = Namespace(join=self.join, is_alive=self.thread.is_alive)
        recorder.bag = Namespace(write=self.write, close=self.close)
        self.thread.start()
        self.begun.get()
        self.rests = False

    def run(self) -> None:
        """Run the learner's `write` on its thread."""
        try:
            with self.trial.calling("write"):
                self.recorder.write()
        except Failure as failure:
            self.failure = failure
        self.begun.put(None)

    def rest(self) -> None:
        """Pause the thread until something waits for it to end, but only the first time."""
        if self.rests:
            self.begun.put(None)
            self.turn.get()

    def get(self, block: bool = True, timeout: float | None = None) -> Any:
        """Remove an entry from the queue and return it."""
        self.asked = 0
        self.keeps |= self.taken > len(self.written)
        if not self.entries and not self.coming:
            self.rest()
        if not self.entries and self.coming:
            self.entries.append(self.coming.pop(0))
            if timeout is not None or not block:
                raise Empty
        if not self.entries:
            is_stolen = self.ended_by not in (None, self.thread)
            cause = STOLEN if is_stolen else PAST_NONE if self.ended_by else NEVER
            raise Misuse("it waits for an entry that never arrives", cause)
        self.taken += 1
        entry = self.entries.pop(0)
        if entry is None:
            self.ended_by = current_thread()
        return entry

    def empty(self) -> bool:
        """Return whether the queue is empty."""
        self.asked += 1
        if self.asked > OFTEN:
            raise Misuse("it repeatedly checks whether the queue is empty", BUSY)
        return not self.entries

    def destroy(self, subscription: Any) -> None:
        """Stop listening."""
        self.entries += self.coming
        self.coming.clear()
        self.listens = subscription is not self.recorder.subscription

    def join(self, timeout: float | None = None) -> None:
        """Wait for the thread, which takes a second to end."""
        self.hurries = not self.hurries and timeout is not None and timeout <= 1.0
        if not self.hurries:
            self.end()
        if self.failure:
            raise self.failure

    def end(self) -> None:
        """Let the thread run, and wait for it to end."""
        self.turn.put(None)
        if self.thread.ident:
            self.thread.join()

    def write(self, connection: str, timestamp: int, data: bytes) -> None:
        """Write to the bag."""
        odd = " (wrong connection)" * (connection != self.recorder.connection) + " (too late)" * (not self.is_open)
        beside = " (outside of the thread)" * (current_thread() is not self.thread and self.thread.is_alive())
        self.written.append(f"{data!r} at {timestamp!r} ns{odd}{beside}")
        self.rest()

    def close(self) -> None:
        """Close the bag."""
        self.is_open = False


def destroy_node() -> None:
    """Refuse to destroy the program's node."""
    raise Misuse("it destroys the program's node", THE_NODE)


def _calls_configure(function: Any) -> bool:
    code = getattr(function, "__code__", None)
    return code is not None and "configure" in code.co_names


def tried(*waiting: Any, coming: Sequence[Any] = ()) -> Run:
    """Make a case that observes the written entries, and what is still running or open after `unconfigure`.

    If `coming` contains None, which ends the thread, `unconfigure` is not called.

    Args:
        waiting, coming: as for `Surroundings`.
    """

    def case(trial: Trial) -> str:
        scene = Surroundings(trial, waiting, coming)
        also, leaves = list[str](), None not in coming
        try:
            scene.configure()
            if leaves:
                with trial.calling("unconfigure"):
                    scene.recorder.unconfigure()
                also += ["the node still listens"] * scene.listens
                also += ["the thread still runs"] * scene.thread.is_alive()
        finally:
            scene.end()
        scene.join()
        also += ["the bag is still open"] * (leaves and scene.is_open)
        are_all = len(scene.written) == sum(each is not None for each in (*waiting, *coming))
        also += ["each entry is written only after the next one is removed from the queue"] * (scene.keeps and are_all)
        return ", ".join([*(scene.written or ["nothing is written"]), *also])

    return case


A, B, C = (5, b"A"), (7, b"B"), (7, b"")  # the time [ns], and the payload, which may be empty
CASES = [
    Case("messages arrive one by one", tried(coming=[A, B, None]),
         "Your code probably continues after None, or changes an entry: get an entry, exit the loop if it is None, and "
         "otherwise write it unchanged, with self.bag.write(self.connection, time_ns, payload).", crashes=True),
    Case("three messages are waiting in the queue", tried(A, B, C)),
    Case("identical messages are waiting in the queue", tried(A, B, B, (9, b"A")),
         "Your code probably skips a message that is identical to an earlier one. "
         "Write every entry: a repeated message is still a message."),
    Case("a message arrives just as the recorder stops listening", tried(A, coming=[B]),
         "Your code probably stops listening too late, after put(None). Messages that arrive "
         "after None are never written: first destroy the subscription, then call put(None)."),
]  # fmt: skip
record = Exercise("record", __doc__, Cases(MyRecorder, CASES, MISTAKES, MEANING), ("write", "unconfigure"))
