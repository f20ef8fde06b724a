"""An exercise: its statement, its check, its hints and its solution; with it comes what an exercise's module needs."""

import ast
import inspect
import re
from collections.abc import Iterator, Sequence
from typing import Any

from tutorial.checks._answer import check_has, misfit, name_of, unwritten
from tutorial.checks._cases import Case, Cases, ask, call, same
from tutorial.checks._contain import contain
from tutorial.checks._diagnose import AT_ONCE
from tutorial.checks._interleave import interleave, traced
from tutorial.checks._publishing import Publishing, compared, compared_stamps
from tutorial.checks._rig import Rig, Sent, early, ros_node, send
from tutorial.checks._verdict import Finding, Verdict, wrong
from tutorial.checks._viewer import Step, Viewer, hands_over, heard, side_by_side, viewing
from tutorial.checks._watch import Failure, Misuse, instrumented, watch
from tutorial.controller import SimpleController
from tutorial.errors import TutorialError
from tutorial.progress import remember

__all__ = ["AT_ONCE", "NOT_YET", "Case", "Cases", "Exercise", "Failure", "Misuse", "ask", "call", "listing", "same"]
__all__ += ["Publishing", "Rig", "Sent", "compared", "compared_stamps", "early", "interleave", "ros_node", "send"]
__all__ += ["Step", "Viewer", "hands_over", "heard", "side_by_side", "traced", "viewing", "watch"]

NOT_YET = "Not attempted yet"
"""What the text begins with that says that nothing is written yet."""

_PARTS = re.compile(r"\n\n(?:Hint \d: |(?=Notice ))")
SAYS = ("what to look at", "how it is done", "nearly the code")  # what each hint does, the weakest first


class Exercise:
    """One exercise of a notebook.

    Args:
        name: what it is called in its module, which has this name, too. The answer has another: it would hide the
            exercise.
        text: the module's docstring: a title, the statement, which is the exercise's docstring, too, then paragraphs
            that begin with ``Hint 1: ``, what to look at, ``Hint 2: ``, how, ``Hint 3: ``, nearly the code, and
            ``Notice``, about an answer that is right.
        cases: what an answer is tried in, with the solution, whose source is shown in the notebooks' style. Their
            `judge` may raise `Failure` or `TutorialError`.
        parts: the methods that are to be written; if none are given, what a controller overrides of its base, or all
            of another class.
        imports: what the solution needs and the notebook has not imported, each an import statement.
    """

    def __init__(
        self, name: str, text: str | None, cases: Cases, parts: Sequence[str] = (), imports: Sequence[str] = ()
    ) -> None:
        _title, _, page = inspect.cleandoc(text or "").partition("\n\n")
        self.__doc__, *prose = _PARTS.split(page)
        *self._hints, self._notice = (" ".join(each.split()) for each in prose)
        self.name, self.cases, self.right_answer = name, cases, cases.solution
        self.module, self._imports = self.right_answer.__module__, imports
        self._base: type | None = None
        if isinstance(cases.solution, type):
            self._base = SimpleController if issubclass(cases.solution, SimpleController) else object
        written = [each for each in vars(cases.solution) if each[0] != "_"]
        own = [each for each in written if self._base is object or hasattr(SimpleController, each)]
        self._parts = parts or own
        self._requires = [each for each in own if self._base is object or each in ("configure", "initialize")]

    async def check(self, answer: Any = None) -> None:
        """Run an answer in a process of its own, and print what was right and what was not.

        It takes a few seconds, in which the loop goes on: views move, and an interrupt ends it.

        Args:
            answer: the class or function itself; None for none yet.
        """
        seen = await self.examine(answer)
        if isinstance(seen, Verdict) and seen.right:
            remember(self.name)
        _say(str(seen))

    async def examine(self, answer: Any) -> Verdict | str:
        """Run an answer in a process of its own; where there is nothing to run, a text says why."""
        return self._first_look(answer) or self._verdict(*await contain(self.module, self.name, answer))

    def judge(self, answer: Any) -> Verdict:
        """Judge an answer in this process, without containing it. It takes a ROS domain from the environment."""
        return self._verdict(tuple(self.findings(answer)))

    def findings(self, answer: Any) -> Iterator[Finding]:
        """Judge an answer in this process, and yield what is found as it is found."""
        watch.begin(answer)
        try:
            with instrumented():
                check_has(answer, *self._requires)
                yield from self.cases.judge(answer)
        except Failure as failure:
            yield failure.finding()
        except TutorialError as error:
            yield wrong(str(error), "The check could not go on from there.")
        except Exception as error:  # noqa: BLE001 - whatever an odd answer leads to, the learner is to hear of it
            text = f"the check could not go on: {type(error).__name__}: {error}"
            yield wrong(text, f"Something unusual is in the way: compare with {self.name}.solution().")

    def hint(self, number: int = 1) -> None:
        """Print a hint.

        Args:
            number: which one, from 1; the later, the stronger.
        """
        count = len(self._hints)
        if number not in range(1, count + 1):
            _say(f"There are {count} hints: {self.name}.hint() to {self.name}.hint({count}).")
            return
        more = f"{self.name}.hint({number + 1}) says more."
        last = f"Then there is {self.name}.solution()."
        _say(f"Hint {number} of {count}: {self._hints[number - 1]} {more if number < count else last}")

    def solution(self) -> None:
        """Print the source of a right answer, ready to be pasted into the notebook's cell."""
        imports = ["\n".join(self._imports)] if self._imports else []
        _say("\n\n\n".join([*imports, listing(self.right_answer)]))

    def _verdict(self, findings: tuple[Finding, ...], output: tuple[str, ...] = ()) -> Verdict:
        hint = _fitting(findings)
        advice = f"Stuck? {self.name}.hint({hint}) says {SAYS[hint - 1]}."
        return Verdict(findings, self._notice, output, advice)

    def _first_look(self, answer: Any) -> str:
        """Say what keeps an answer from being run; nothing if it can be."""
        name, call = self.right_answer.__name__, f"await {self.name}.check"
        if answer is None:
            return f"{NOT_YET}: write {name}, then {call}({name}). {self.name}.hint() gives a hint."
        mend = misfit(answer, name, self._base, call)
        if mend:
            return mend
        if unwritten(answer, self._parts):
            what = ", ".join(self._parts)
            return f"{NOT_YET}: {name_of(answer)} is still to be written{': ' * bool(what)}{what}."
        return ""


def listing(part: Any) -> str:
    """Return the source of a class or function as a notebook has it: without annotations and docstrings.

    So it needs no imports for them. Its comments stay, and so do its blank lines.

    Args:
        part: the class or function, written at the top level of its module.
    """
    shown = source = inspect.getsource(part).rstrip()
    for node in ast.walk(ast.parse(source)):
        match node:
            case ast.arg(annotation=ast.expr() as kind) | ast.AnnAssign(annotation=kind):
                shown = shown.replace(f": {ast.get_source_segment(source, kind)}", "")
            case ast.FunctionDef(returns=ast.expr() as kind):
                shown = shown.replace(f" -> {ast.get_source_segment(source, kind)}:", ":")
            case ast.Expr(ast.Constant(str())):
                shown = re.sub(rf"\n *{re.escape(ast.get_source_segment(source, node) or '')}", "", shown)
    return re.sub(r":\n\n", ":\n", shown)


def _fitting(findings: tuple[Finding, ...]) -> int:
    """Choose a hint: the more of an answer is right already, the closer to the code it may be."""
    rights = sum(finding.right for finding in findings)
    causes = len({finding.cause for finding in findings if not finding.right})
    return 1 if rights == 0 else 2 if rights <= 2 * causes else 3


def _say(text: str) -> None:
    print(text)  # noqa: T201 - to print is its purpose
