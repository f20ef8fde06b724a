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

from tutorial.commands.checking.messages import Outcome
from tutorial.commands.checking.submission import Submission

__all__ = ["as_json", "as_junit", "count", "summary", "table"]

STYLES = {Outcome.RIGHT: "green", Outcome.WRONG: "red", Outcome.NOT_TRIED: "dim", Outcome.NOT_JUDGED: "yellow"}


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
        if not submission.verdicts:
            columns.add_row(Text(name), "", Text("no exercise", "dim"), "")
        for exercise, judged in submission.verdicts.items():
            verdict = Text(judged.outcome, STYLES[judged.outcome])
            columns.add_row(Text(name), Text(exercise), verdict, Text(judged.cause))
            name = ""
    return columns


def summary(submissions: Sequence[Submission]) -> list[str]:
    """Sum it up: how many of which outcome, and the cause that is the most frequent."""
    answers = [answer for submission in submissions for answer in submission.judged.items()]
    counts = Counter(judged.outcome for _, judged in answers)
    parts = [f"{counts[outcome]} {outcome}" for outcome in Outcome if counts[outcome]]
    lines = [f"{count(len(submissions), 'notebook')}, {count(len(answers), 'answer')}: {', '.join(parts)}."]
    problems = sum(bool(each.problem) for each in submissions)
    if not answers:
        lines = [f"{count(len(submissions), 'notebook')}, no answer."]
    if problems:
        lines.append(f"{count(problems, 'notebook')} could not be judged.")
    causes = Counter((exercise, judged.cause) for exercise, judged in answers if judged.cause)
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
                    {"exercise": exercise, "verdict": judged.outcome, "cause": judged.cause, "text": judged.text}
                    for exercise, judged in each.judged.items()
                ],
            }
            for each in submissions
        ],
        "summary": summary(submissions),
    }


def as_junit(submissions: Iterable[Submission], names: dict[Path, str]) -> bytes:
    """Return it as the XML of JUnit, which CI systems read: a suite for each notebook, a case for each answer."""
    kinds = {Outcome.WRONG: "failure", Outcome.NOT_JUDGED: "error", Outcome.NOT_TRIED: "skipped"}
    suites = ElementTree.Element("testsuites", name="tank check")
    for submission in submissions:
        name = names[submission.path]
        suite = ElementTree.SubElement(suites, "testsuite", name=name)
        for exercise, judged in submission.verdicts.items():
            case = ElementTree.SubElement(suite, "testcase", classname=name, name=exercise or "notebook")
            if judged.outcome in kinds:
                ElementTree.SubElement(case, kinds[judged.outcome], message=judged.cause).text = judged.text
    ElementTree.indent(suites)
    return bytes(ElementTree.tostring(suites, encoding="utf-8", xml_declaration=True))
