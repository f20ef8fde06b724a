"""Reports on the answers of a class of learners: a table, a summary, JSON and JUnit XML."""

from collections import Counter
from collections.abc import Sequence
from typing import Any
from xml.etree import ElementTree

from rich.box import SIMPLE_HEAD
from rich.table import Table
from rich.text import Text

from tutorial.commands.checking.messages import Judged, Outcome

Results = Sequence[tuple[str, dict[str, Judged]]]
"""Each notebook's name and verdicts, as returned by `judge`."""

STYLES = {
    Outcome.RIGHT: "green",
    Outcome.WRONG: "red",
    Outcome.NOT_TRIED: "dim",
    Outcome.NOT_JUDGED: "yellow",
    Outcome.SCORED: "green",
}

NO_SANDBOX = "The answers ran without a sandbox: they could read, change and send everything that you have access to."


def table(results: Results) -> Table:
    """Lay out a row for each answer."""
    columns = Table(box=SIMPLE_HEAD, pad_edge=False, padding=(0, 1, 0, 0))
    columns.add_column("notebook", overflow="fold", max_width=32)
    columns.add_column("exercise", no_wrap=True)
    columns.add_column("verdict", no_wrap=True)
    columns.add_column("cause", overflow="fold")
    for name, verdicts in results:
        if not verdicts:
            columns.add_row(Text(name), "", Text("no exercise", "dim"), "")
        for i, (exercise, judged) in enumerate(verdicts.items()):
            verdict = Text(str(judged), STYLES[judged.outcome])
            columns.add_row(Text("" if i else name), Text(exercise), verdict, Text(judged.cause))
    return columns


def summary(results: Results, is_sandboxed: bool) -> list[str]:
    """Summarize the outcomes, give the most frequent cause, and warn if there was no sandbox."""
    answers = [answer for _, verdicts in results for answer in verdicts.items() if answer[0]]
    counts = Counter(judged.outcome for _, judged in answers)
    parts = [f"{counts[outcome]} {outcome}" for outcome in Outcome if counts[outcome]]
    said = f"{_count(len(answers), 'answer')}: {', '.join(parts)}" if answers else "no answer"
    lines = [f"{_count(len(results), 'notebook')}, {said}."]
    if problems := sum("" in verdicts for _, verdicts in results):
        lines.append(f"{_count(problems, 'notebook')} could not be judged.")
    causes = Counter((name, each.cause) for name, each in answers if each.cause and each.outcome is not Outcome.SCORED)
    for (exercise, cause), times in causes.most_common(1):
        lines.append(f"The most frequent cause ({_count(times, 'answer')} to {exercise}): {cause}")
    if not is_sandboxed:
        lines.append(NO_SANDBOX)
    return lines


def _count(number: int, what: str) -> str:
    """Format a count, with the noun in the singular or plural."""
    return f"{number} {what}{'s' * (number != 1)}"


def as_json(results: Results, is_sandboxed: bool) -> dict[str, Any]:
    """Return the results and the summary as JSON data."""
    return {
        "notebooks": [
            {
                "notebook": name,
                "problem": verdicts[""].cause if "" in verdicts else "",
                "answers": [
                    {
                        "exercise": exercise,
                        "verdict": judged.outcome,
                        "score": judged.score,
                        "cause": judged.cause,
                        "text": judged.text,
                    }
                    for exercise, judged in verdicts.items()
                    if exercise
                ],
            }
            for name, verdicts in results
        ],
        "summary": summary(results, is_sandboxed),
    }


def as_junit(results: Results) -> bytes:
    """Return the results as JUnit XML for CI systems: a suite for each notebook, a case for each answer."""
    kinds = {Outcome.WRONG: "failure", Outcome.NOT_JUDGED: "error", Outcome.NOT_TRIED: "skipped"}
    suites = ElementTree.Element("testsuites", name="tank check")
    for name, verdicts in results:
        suite = ElementTree.SubElement(suites, "testsuite", name=name)
        for exercise, judged in verdicts.items():
            case = ElementTree.SubElement(suite, "testcase", classname=name, name=exercise or "notebook")
            if judged.outcome in kinds:
                ElementTree.SubElement(case, kinds[judged.outcome], message=judged.cause).text = judged.text
            elif judged.score is not None:
                ElementTree.SubElement(case, "system-out").text = f"{judged}: {judged.text}"
    ElementTree.indent(suites)
    return bytes(ElementTree.tostring(suites, encoding="utf-8", xml_declaration=True))
