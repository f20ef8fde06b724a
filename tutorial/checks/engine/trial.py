"""A trial: one run of an answer in one case."""

import threading
from collections import defaultdict
from collections.abc import Callable, Collection, Hashable, Iterable, Iterator
from contextlib import contextmanager, suppress
from traceback import walk_stack, walk_tb
from types import FrameType
from typing import Any

from tutorial.checks.engine.answer import files_of, name_of
from tutorial.checks.engine.exceptions import slept
from tutorial.checks.engine.failure import Failure, Misuse
from tutorial.checks.engine.verdict import Place

CHANGED = (
    "Your code probably changes its argument with sort, reverse, pop, del, append, += or =. "
    "Copy the argument first; np.asarray does not copy an array."
)


class Call:
    """An unfinished call to one of the learner's methods.

    Args:
        method: the method's name.
    """

    def __init__(self, method: str) -> None:
        self.method = method


class Trial:
    """One run of an answer in one case. The case receives the trial, which records what the answer does.

    Args:
        answer: the learner's class or function, or the solution, with or without mistakes in it.
        watched: the files whose code is observed; by default the files that contain the answer.
        is_timed: whether the check limits the total time of all calls to a method, and not only the time of each call.
        kept: objects from earlier trials that later trials can reuse.

    Attributes:
        running: the unfinished calls, by thread; each thread's innermost call comes last.
        noted: where the answer has used ``"sleep"``, ``"clock"``, ``"thread"``, ``"timer"`` or ``"touch"``.
        clocks: the readings of the answer's stopped clocks, keyed by the clock's name in `time`; None while they run.
        ahead: how far the clocks have been advanced since they were stopped [s].
        is_interleaved: whether another thread is interrupting the answer. Interrupted calls take longer.
    """

    def __init__(
        self,
        answer: Any,
        watched: Collection[str] | None = None,
        is_timed: bool = True,
        kept: dict[Hashable, Any] | None = None,
    ) -> None:
        self.answer, self.is_timed = answer, is_timed
        self.watched = files_of(answer) if watched is None else watched
        self.running = defaultdict[int, list[Call]](list)
        self.noted: dict[str, Place | None] = {}
        self.clocks: dict[str, float] | None = None
        self.ahead, self.is_interleaved = 0.0, False
        self._kept = {} if kept is None else kept

    def call(self, function: Callable[..., Any], *arguments: Any) -> Any:
        """Call one of the learner's functions and return its result. Thread-safe.

        Raises:
            Failure: the function raised an exception, or slept, which no method may do.
        """
        with self.calling(name_of(function)):
            return function(*arguments)

    def ask(self, *given: Any, read: Callable[[Any], Any], wanted: str) -> Any:
        """Call the answer, which must be a function, and read its result.

        Args:
            given: the arguments, which the answer must not change.
            read: turns the result into an observation.
            wanted: what the answer should return, as a sentence.

        Raises:
            Failure: the answer raised an exception, returned something that `read` rejects, or changed its arguments.
        """
        before = [*map(str, given)]
        with self.calling(name_of(self.answer)):
            returned = self.answer(*given)
            changed = [type(each).__name__ for each, said in zip(given, before) if str(each) != said]
            if changed:
                raise Misuse(f"it changes its argument, the {changed[0]}", CHANGED)
            if isinstance(returned, Iterator):
                wanted = f"yield, or a comprehension in parentheses, creates an iterator. {wanted}"
            else:
                with suppress(AttributeError, TypeError, ValueError):
                    return read(returned)
            if returned is None:
                raise Misuse("it returns None", f"You probably forgot return. {wanted}")
            raise Misuse(f"it returns a {type(returned).__name__}", wanted)

    @contextmanager
    def calling(self, method: str) -> Iterator[None]:
        """Run the learner's code as a call to the given method. Thread-safe.

        Raises:
            Failure: the code raised an exception, or slept, which no method may do.
        """
        calls = self.running[threading.get_ident()]
        calls.append(Call(method))
        try:
            yield
            self._check_slept(method)
        except Failure:
            raise
        except BaseException as error:
            self._check_slept(method)  # the code may have waited for something that never happened, and then failed
            raise self.failure(method, error) from error
        finally:
            calls.pop()

    def innermost(self) -> dict[int, Call]:
        """Return the innermost running call of each thread. Thread-safe."""
        return {ident: call for ident, calls in [*self.running.items()] for call in calls[-1:]}

    def failure(self, method: str, error: BaseException) -> Failure:
        """Return the failure for an exception, with the responsible line of the learner's code."""
        return Failure(method, error, self.place(reversed([*walk_tb(error.__traceback__)])))

    def note(self, what: str, frame: FrameType) -> None:
        """Record what the answer uses, such as ``"clock"``.

        Record a sleep only if the current thread is running one of the learner's methods.
        """
        if what != "sleep" or self.running[threading.get_ident()]:
            self.noted.setdefault(what, self.place(walk_stack(frame)))

    @contextmanager
    def clocks_stand(self, ahead: float = 0.0) -> Iterator[None]:
        """Stop the clocks of `time` for the answer.

        Args:
            ahead: how far ahead of the current time to stop the clocks [s].
        """
        self.clocks, self.ahead = {}, ahead
        try:
            yield
        finally:
            self.clocks = None

    def place(self, stack: Iterable[tuple[FrameType, int]]) -> Place | None:
        """Return the first line that is in a watched file, searching outwards from the innermost frame."""
        found = ((frame.f_code, line) for frame, line in stack if frame.f_code.co_filename in self.watched)
        return next((Place(code.co_filename, line, code.co_name) for code, line in found), None)

    def reuse(self, make: Callable[..., Any], *arguments: Hashable) -> Any:
        """Return ``make(*arguments)``. Only the first trial calls `make`; later trials get the same object."""
        key = make, *arguments
        if key not in self._kept:
            self._kept[key] = make(*arguments)
        return self._kept[key]

    def _check_slept(self, method: str) -> None:
        if "sleep" in self.noted:
            raise Failure(method, Misuse("it sleeps", slept(method)), self.noted.pop("sleep"))
