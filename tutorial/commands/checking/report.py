"""What became of a class's answers: a table, a summary, JSON, and JUnit's XML."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

from rich.box import SIMPLE_HEAD
from rich.table import Table
from rich.text import Text

from tutorial.commands.checking.messages import Judged, Outcome
from tutorial.commands.checking.submission import Submission

__all__ = ["as_json", "as_junit", "count", "summary", "table"]

STYLES = {Outcome.RIGHT: "green", Outcome.WRONG: "red", Outcome.NOT_TRIED: "dim", Outcome.NOT_JUDGED: "yellow"}

NO_EXERCISE = "no exercise"


def table(submissions: Iterable[Submission], names: dict[Path, str]) -> Table:
    """Lay out a row for each answer.

    Args:
        submissions: the notebooks.
        names: what each is called.
    """
    columns = Table(box=SIMPLE_HEAD, pad_edge=False, padding=(0, 1, 0, 0))
    columns.add_column("notebook", overflow="fold", max_width=32)
    columns.add_column("exercise", no_wrap=True)
    columns.add_column("verdict", no_wrap=True)
    columns.add_column("cause", overflow="fold")
    for submission in submissions:
        name = names[submission.path]
        if submission.problem:
            columns.add_row(Text(name), "", Text(Outcome.NOT_JUDGED, "yellow"), Text(submission.problem))
            name = ""
        elif not submission.judged:
            columns.add_row(Text(name), "", Text(NO_EXERCISE, "dim"), "")
        for judged in submission.judged.values():
            columns.add_row(
                Text(name), Text(judged.exercise), Text(judged.outcome, STYLES[judged.outcome]), Text(judged.cause)
            )
            name = ""
    return columns


def summary(submissions: Sequence[Submission]) -> list[str]:
    """Sum it up: how many of which outcome, and the cause that is the most frequent."""
    answers = _answers(submissions)
    counts = Counter(each.outcome for each in answers)
    parts = [f"{counts[outcome]} {outcome}" for outcome in Outcome if counts[outcome]]
    lines = [f"{count(len(submissions), 'notebook')}, {count(len(answers), 'answer')}: {', '.join(parts)}."]
    problems = sum(bool(each.problem) for each in submissions)
    if not answers:
        lines = [f"{count(len(submissions), 'notebook')}, no answer."]
    if problems:
        lines.append(f"{count(problems, 'notebook')} could not be judged.")
    causes = Counter((each.exercise, each.cause) for each in answers if each.cause)
    if causes:
        (exercise, cause), times = causes.most_common(1)[0]
        lines.append(f"The most frequent cause ({count(times, 'answer')} to {exercise}): {cause}")
    return lines


def count(number: int, what: str) -> str:
    """Say how many, in the singular or the plural."""
    return f"{number} {what}{'s' * (number != 1)}"


def as_json(submissions: Sequence[Submission], names: dict[Path, str]) -> dict[str, Any]:
    """Return all of it as what JSON can hold."""
    return {
        "notebooks": [
            {
                "notebook": names[each.path],
                "problem": each.problem,
                "answers": [
                    {"exercise": a.exercise, "verdict": a.outcome, "cause": a.cause, "text": a.text}
                    for a in each.judged.values()
                ],
            }
            for each in submissions
        ],
        "summary": summary(submissions),
    }


def as_junit(submissions: Iterable[Submission], names: dict[Path, str]) -> bytes:
    """Return it as the XML of JUnit, which CI systems read: a suite for each notebook, a case for each answer."""
    suites = ElementTree.Element("testsuites", name="tank check")
    for submission in submissions:
        name = names[submission.path]
        cases = list(submission.judged.values())
        outcomes = Counter(case.outcome for case in cases)
        suite = ElementTree.SubElement(
            suites,
            "testsuite",
            name=name,
            tests=str(len(cases) + bool(submission.problem)),
            failures=str(outcomes[Outcome.WRONG]),
            errors=str(outcomes[Outcome.NOT_JUDGED] + bool(submission.problem)),
            skipped=str(outcomes[Outcome.NOT_TRIED]),
        )
        if submission.problem:
            case = ElementTree.SubElement(suite, "testcase", classname=name, name="notebook")
            ElementTree.SubElement(case, "error", message=submission.problem)
        for judged in cases:
            case = ElementTree.SubElement(suite, "testcase", classname=name, name=judged.exercise)
            kind = {Outcome.WRONG: "failure", Outcome.NOT_JUDGED: "error", Outcome.NOT_TRIED: "skipped"}
            if judged.outcome in kind:
                ElementTree.SubElement(case, kind[judged.outcome], message=judged.cause).text = judged.text
    ElementTree.indent(suites)
    return bytes(ElementTree.tostring(suites, encoding="utf-8", xml_declaration=True))


def _answers(submissions: Iterable[Submission]) -> list[Judged]:
    return [judged for submission in submissions for judged in submission.judged.values()]
