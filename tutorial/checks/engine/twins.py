"""Twins: copies of the solution with mistakes in them, and how they and the solution behave in the cases."""

from __future__ import annotations  # compiled twins inherit this import: an edit can break an annotation

import asyncio
import functools
import inspect
import itertools
import math
import sys
from collections.abc import Callable, Hashable, Iterator
from contextlib import redirect_stderr, redirect_stdout, suppress
from functools import cached_property
from io import StringIO
from typing import Any

from tutorial.checks.engine.cases import Case, Cases, Fault
from tutorial.checks.engine.observe import attempt, same
from tutorial.checks.engine.slips import Kind, slips
from tutorial.checks.engine.trial import Trial

A_MISTAKE = "<a mistake>"  # the file name in every twin's code


class Twins:
    """Run the solution and its twins through the cases.

    Args:
        cases: the cases, the solution and the known mistakes.
        begin: begins a trial; see `Trial` for the arguments.
        seen: a cache of twins, and of observations of the twins and the solution.
    """

    def __init__(
        self, cases: Cases, begin: Callable[..., Trial] = Trial, seen: dict[Hashable, Any] | None = None
    ) -> None:
        self.cases = cases
        self._begin, self._seen = begin, {} if seen is None else seen

    def expected(self, case: Case) -> Any:
        """Return the observation that a case makes of the solution."""
        if case.label not in self._seen:
            # The solution is known to use time and threads correctly, so its files need not be watched.
            self._seen[case.label] = case.run(self._begin(self.cases.solution, ()))
        return self._seen[case.label]

    def does(self, case: Case, *faults: Fault) -> Any:
        """Return the observation that a case makes of the solution with mistakes; None if they cannot be combined."""
        if (case.label, faults) not in self._seen:
            twin = self.make(*faults)
            self._seen[case.label, faults] = twin and self.attempt(case, twin)
        return self._seen[case.label, faults]

    def shows(self, case: Case, fault: Fault) -> bool:
        """Return whether a mistake alone changes the observation that a case makes."""
        return not same(self.does(case, fault), self.expected(case))

    def attempt(self, case: Case, twin: Any) -> Any:
        """Return the observation that a case makes of a twin.

        The twin's output is discarded, because the learner's code did not print it. Twins are not watched, because
        interrupting all of them at every instruction would take too long.
        """
        trial = self._begin(twin, (), False)
        with redirect_stdout(StringIO()), redirect_stderr(StringIO()):
            return attempt(case.run, trial)

    def slips(self, kind: Kind) -> Iterator[Fault]:
        """Yield every possible slip of one kind in the solution."""
        return slips(kind, self.source)

    def make(self, *faults: Fault) -> Any:
        """Return the solution with mistakes in it; None if one mistake removes text that another mistake changes."""
        if faults not in self._seen:
            self._seen[faults] = self._define(*faults)
        return self._seen[faults]

    def _define(self, *faults: Fault) -> Any:
        source: str | None = self.source
        for fault in faults:
            source = source and fault.made_in(source)
        if source is None:
            return None
        solution = self.cases.solution
        modules = asyncio, functools, math, itertools, sys.modules[solution.__module__]
        names = {name: value for module in modules for name, value in vars(module).items()}
        with suppress(SyntaxError):  # two mistakes together can make a statement invalid
            exec(compile(source, A_MISTAKE, "exec"), names)
            return names[solution.__name__]
        return None

    @cached_property
    def source(self) -> str:
        """The source that mistakes change: the functions in `Cases.beside`, then the solution."""
        return "\n\n".join(map(inspect.getsource, (*self.cases.beside, self.cases.solution)))
