"""A trial: one attempt at an answer in one case."""

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
    "You probably change it with sort, reverse, pop, del, append, += or =. Copy it first; np.asarray makes no copy."
)


class Call:
    """A call of one of the learner's methods that has not returned yet.

    Args:
        method: its name.
    """

    def __init__(self, method: str) -> None:
        self.method = method


class Trial:
    """One attempt at an answer in one case. It is handed to the case, and knows what the answer does meanwhile.

    Args:
        answer: the learner's class or function, or the solution, with or without mistakes in it.
        watched: the files whose code is observed; by default those that the answer is written in.
        is_timed: whether the calls of one method may not take long together either.
        kept: what earlier trials have made and later ones may use again.

    Attributes:
        running: by thread, the calls that have not returned, the innermost last.
        noted: what the answer has done besides its work, and where: ``"sleep"``, ``"clock"``, ``"thread"``,
            ``"timer"``, ``"touch"``.
        clocks: by name, what the clocks of `time` say to the answer while they stand still; None while they run.
        ahead: by how much these clocks have been put ahead [s].
        is_interleaved: whether another thread interrupts the answer on purpose, so that its calls take long.
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
        """Call a function of the learner's and return what it returns. Any thread.

        Raises:
            Failure: it raised an exception, or it slept, which no method may.
        """
        with self.calling(name_of(function)):
            return function(*arguments)

    def ask(self, *given: Any, read: Callable[[Any], Any], wanted: str) -> Any:
        """Call the answer, a function, and read what it returns.

        Args:
            given: its arguments, which it may not change.
            read: turns what was returned into an observation.
            wanted: what it should return, as a sentence.

        Raises:
            Failure: it raised an exception, returned something that cannot be read, or changed its arguments.
        """
        before = [*map(str, given)]
        with self.calling(name_of(self.answer)):
            returned = self.answer(*given)
            changed = [type(each).__name__ for each, said in zip(given, before) if str(each) != said]
            if changed:
                raise Misuse(f"it changes the {changed[0]} that it is given", CHANGED)
            if isinstance(returned, Iterator):
                wanted = f"yield and parentheses make an iterator. {wanted}"
            else:
                with suppress(AttributeError, TypeError, ValueError):
                    return read(returned)
            if returned is None:
                raise Misuse("it returns None", f"You probably forgot return. {wanted}")
            raise Misuse(f"it returns a {type(returned).__name__}", wanted)

    @contextmanager
    def calling(self, method: str) -> Iterator[None]:
        """Run code of the learner's as a call of one of the methods. Any thread.

        Raises:
            Failure: it raised an exception, or it slept, which no method may.
        """
        calls = self.running[threading.get_ident()]
        calls.append(Call(method))
        try:
            yield
            self._check_slept(method)
        except Failure:
            raise
        except BaseException as error:
            self._check_slept(method)  # what it waited for has not come
            raise self.failure(method, error) from error
        finally:
            calls.pop()

    def innermost(self) -> dict[int, Call]:
        """Return the innermost running call of each thread. Any thread."""
        return {ident: call for ident, calls in [*self.running.items()] for call in calls[-1:]}

    def failure(self, method: str, error: BaseException) -> Failure:
        """Return the failure for an exception, with the line of the learner's code that raised it."""
        return Failure(method, error, self.place(reversed([*walk_tb(error.__traceback__)])))

    def note(self, what: str, frame: FrameType) -> None:
        """Note what the answer does, such as ``"clock"``; a sleep only on a thread that runs one of the methods."""
        if what != "sleep" or self.running[threading.get_ident()]:
            self.noted.setdefault(what, self.place(walk_stack(frame)))

    @contextmanager
    def clocks_stand(self, ahead: float = 0.0) -> Iterator[None]:
        """Stop the clocks of `time` for the answer.

        Args:
            ahead: by how much they are put ahead first [s].
        """
        self.clocks, self.ahead = {}, ahead
        try:
            yield
        finally:
            self.clocks = None

    def place(self, stack: Iterable[tuple[FrameType, int]]) -> Place | None:
        """Return the innermost watched line of a stack, whose innermost frame comes first."""
        found = ((frame.f_code, line) for frame, line in stack if frame.f_code.co_filename in self.watched)
        return next((Place(code.co_filename, line, code.co_name) for code, line in found), None)

    def reuse(self, make: Callable[..., Any], *arguments: Hashable) -> Any:
        """Return what `make` makes of these arguments. It is made once, and later trials get the same object."""
        key = make, *arguments
        if key not in self._kept:
            self._kept[key] = make(*arguments)
        return self._kept[key]

    def _check_slept(self, method: str) -> None:
        if "sleep" in self.noted:
            raise Failure(method, Misuse("it sleeps", slept(method)), self.noted.pop("sleep"))
