"""An exercise as the learner sees it: its statement, its check, its hints and its solution."""

import ast
import inspect
import re
from collections.abc import Hashable, Iterator, Sequence
from typing import Any

from tutorial.checks.engine.answer import check_has, misfit, name_of, unwritten
from tutorial.checks.engine.cases import Cases
from tutorial.checks.engine.contain import contain
from tutorial.checks.engine.diagnose import diagnose
from tutorial.checks.engine.failure import Failure
from tutorial.checks.engine.instruments import Instruments
from tutorial.checks.engine.observe import observe
from tutorial.checks.engine.report import finding_of, report
from tutorial.checks.engine.twins import Twins
from tutorial.checks.engine.verdict import Finding, Verdict, right, wrong
from tutorial.checks.progress import remember
from tutorial.controller import SimpleController
from tutorial.errors import TutorialError

NOT_YET = "Not attempted yet"
"""The beginning of the message about an answer that has no code yet."""

_PARTS = re.compile(r"\n\n(?:Hint \d: |(?=Notice ))")
SAYS = ("what to look at", "how it is done", "nearly the code")  # what each hint shows, the weakest hint first


class Exercise:
    """An exercise in a notebook.

    Args:
        name: the name of the exercise and its module. The answer must have a different name; otherwise it
            would shadow the exercise.
        text: the module's docstring: a title; the statement, which becomes the exercise's docstring; and paragraphs
            that begin with ``Hint 1: `` (what to look at), ``Hint 2: `` (how it is done), ``Hint 3: `` (nearly the
            code), and ``Notice`` (about a right answer).
        cases: the cases that an answer has to pass, the known mistakes, and the solution.
        parts: the methods that the learner has to write. By default, all public methods of the solution; for a
            controller, only those that it overrides.
        imports: the import statements that the solution needs and the notebook lacks.
    """

    def __init__(
        self, name: str, text: str | None, cases: Cases, parts: Sequence[str] = (), imports: Sequence[str] = ()
    ) -> None:
        _title, _, page = inspect.cleandoc(text or "").partition("\n\n")
        self.__doc__, *prose = _PARTS.split(page)
        *self._hints, self._notice = (" ".join(each.split()) for each in prose)
        self.name, self.cases, self.right_answer = name, cases, cases.solution
        self.module, self._imports = self.right_answer.__module__, imports
        self._base = _base_of(cases.solution)
        own = _own_methods(cases.solution, self._base)
        self._parts = parts or own
        self._requires = [each for each in own if self._base is object or each in ("configure", "initialize")]
        self._seen = dict[Hashable, Any]()  # the twins, and the observations of the solution and its twins

    async def check(self, answer: Any = None) -> None:
        """Run an answer in a separate process, and print what is right and what is wrong.

        This takes a few seconds. Meanwhile the event loop keeps running: views keep moving, and an interrupt stops the
        check.

        Args:
            answer: the class or function itself; None if it does not exist yet.
        """
        seen = await self.examine(answer)
        if isinstance(seen, Verdict) and seen.right:
            remember(self.name)
        _say(str(seen))

    async def examine(self, answer: Any) -> Verdict | str:
        """Run an answer in a separate process and return the verdict, or a message that explains why it cannot run."""
        return self._first_look(answer) or self._verdict(*await contain(self.module, self.name, answer))

    def judge(self, answer: Any) -> Verdict:
        """Judge an answer in this process, not in a separate one. `ROS_DOMAIN_ID` has to be set."""
        with Instruments() as instruments:
            return self._verdict(tuple(self.findings(answer, instruments)))

    def findings(self, answer: Any, instruments: Instruments) -> Iterator[Finding]:
        """Judge an answer in this process, and yield each finding as soon as it is known.

        Args:
            answer: the learner's class or function.
            instruments: the instruments for the trials. Iterate over the findings inside the instruments'
                ``with`` block.
        """
        try:
            check_has(answer, *self._requires)
            yield from self._judge(answer, instruments)
        except Failure as failure:
            yield finding_of(failure, answer)
        except TutorialError as error:
            yield wrong(str(error), "The check stopped there.")
        except Exception as error:  # noqa: BLE001 - an odd answer may cause any exception; the learner has to see it
            text = f"the check cannot continue: {type(error).__name__}: {error}"
            yield wrong(text, f"Something unusual happened. Compare your answer with {self.name}.solution().")

    def _judge(self, answer: Any, instruments: Instruments) -> Iterator[Finding]:
        twins = Twins(self.cases, instruments.begin, self._seen)
        seen = observe(self.cases, answer, instruments.begin, twins.expected)
        yield from report(self.cases, answer, seen, diagnose(seen, twins))
        if self.cases.on_ros and not seen.odd:
            yield right(f"with another program: {self.cases.on_ros(instruments.begin(answer))}")

    def hint(self, number: int = 1) -> None:
        """Print a hint.

        Args:
            number: the hint's number, starting from 1. Later hints reveal more.
        """
        count = len(self._hints)
        if number not in range(1, count + 1):
            _say(f"There are {count} hints: {self.name}.hint() to {self.name}.hint({count}).")
            return
        more = f"{self.name}.hint({number + 1}) reveals more."
        last = f"Still stuck? {self.name}.solution() prints a solution."
        _say(f"Hint {number} of {count}: {self._hints[number - 1]} {more if number < count else last}")

    def solution(self) -> None:
        """Print the source of the solution, ready to paste into a notebook cell."""
        imports = ["\n".join(self._imports)] if self._imports else []
        _say("\n\n\n".join([*imports, listing(self.right_answer)]))

    def _verdict(self, findings: tuple[Finding, ...], output: tuple[str, ...] = ()) -> Verdict:
        hint = _fitting(findings)
        advice = f"Stuck? {self.name}.hint({hint}) says {SAYS[hint - 1]}."
        return Verdict(findings, self._notice, output, advice)

    def _first_look(self, answer: Any) -> str:
        """Return a message if an answer cannot be run, or an empty string if it can."""
        name, call = self.right_answer.__name__, f"await {self.name}.check"
        if answer is None:
            return f"{NOT_YET}: write {name}, then {call}({name}). {self.name}.hint() gives a hint."
        instead = misfit(answer, name, self._base, call)
        if instead:
            return instead
        if unwritten(answer, self._parts):
            what = ", ".join(self._parts)
            return f"{NOT_YET}: {name_of(answer)} is still to be written{': ' * bool(what)}{what}."
        return ""


def listing(part: Any) -> str:
    """Return the source of a class or function in the notebooks' style: without annotations and docstrings.

    Annotations would require imports. Comments and blank lines remain.

    Args:
        part: the class or function, which has to be defined at the top level of its module.
    """
    shown = source = inspect.getsource(part).rstrip()
    for node in ast.walk(ast.parse(source)):
        match node:
            case ast.arg(annotation=ast.expr() as kind) | ast.AnnAssign(annotation=kind):
                shown = shown.replace(f": {ast.get_source_segment(source, kind)}", "")
            case ast.FunctionDef(returns=ast.expr() as kind) | ast.AsyncFunctionDef(returns=ast.expr() as kind):
                shown = shown.replace(f" -> {ast.get_source_segment(source, kind)}:", ":")
            case ast.Expr(ast.Constant(str())):
                shown = re.sub(rf"\n *{re.escape(ast.get_source_segment(source, node) or '')}", "", shown)
    return re.sub(r":\n\n", ":\n", shown)


def _base_of(solution: Any) -> type | None:
    """Return the class that an answer has to inherit from; None for a function."""
    if not isinstance(solution, type):
        return None
    return SimpleController if issubclass(solution, SimpleController) else object


def _own_methods(solution: Any, base: type | None) -> list[str]:
    """Return a solution's public methods; for a controller, only the methods that it overrides."""
    written = [each for each in vars(solution) if each[0] != "_"]
    return [each for each in written if base is object or hasattr(SimpleController, each)]


def _fitting(findings: tuple[Finding, ...]) -> int:
    """Choose a hint: the more of an answer is already right, the more the hint reveals."""
    rights = sum(finding.right for finding in findings)
    causes = len({finding.cause for finding in findings if not finding.right})
    return 1 if rights == 0 else 2 if rights <= 2 * causes else 3


def _say(text: str) -> None:
    print(text)  # noqa: T201 - printing is its purpose
