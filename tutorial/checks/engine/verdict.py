"""Verdicts: the findings of a check, and their text."""

import linecache
import re
from collections.abc import Iterator
from dataclasses import dataclass

WRONG_SHOWN = 2  # number of causes to show; later causes are often consequences of the first
OUTPUT_SHOWN = 20  # lines
WIDTH = 200  # characters per line

_STAMP = re.compile(r"^\[(\w+)\] \[\d+\.\d+\] ")  # a log line's time, which differs in every run


@dataclass(frozen=True)
class Place:
    """A line of the learner's code.

    Attributes:
        file: the name of the file or notebook cell, as in Python's code objects.
        line: the line number.
        function: the function that contains the line.
    """

    file: str
    line: int
    function: str

    def __str__(self) -> str:
        text = linecache.getline(self.file, self.line).strip()
        return f"in {self.function}, line {self.line}{': ' if text else ''}{text}"


@dataclass(frozen=True)
class Finding:
    """The result of one case, as the learner reads it.

    Attributes:
        right: whether the answer passed the case.
        text: what the case tried, and what happened.
        cause: the most likely cause, as a sentence, if the answer is wrong.
        place: the responsible line of the learner's code, if known.
    """

    right: bool
    text: str
    cause: str = ""
    place: Place | None = None

    def lines(self) -> Iterator[str]:
        """Yield the lines that the learner reads."""
        yield f"{'✓' if self.right else '✗'} {self.text}"
        if self.place is not None:
            yield f"  {cut(str(self.place))}"
        if self.cause:
            yield f"  {self.cause}"


@dataclass(frozen=True)
class Verdict:
    """All findings of a check.

    Attributes:
        findings: the findings in the order of the cases; root causes come before their consequences.
        notice: what to notice about a right answer.
        output: the lines that the learner's code printed.
        advice: the last line of the text if the answer is wrong.
    """

    findings: tuple[Finding, ...]
    notice: str = ""
    output: tuple[str, ...] = ()
    advice: str = ""

    @property
    def right(self) -> bool:
        """Whether there are findings, and all of them are right."""
        return bool(self.findings) and all(finding.right for finding in self.findings)

    @property
    def causes(self) -> tuple[str, ...]:
        """The distinct causes of the wrong findings, in order."""
        return tuple(dict.fromkeys(finding.cause for finding in self.findings if not finding.right))

    def __str__(self) -> str:
        lines, untold = list[str](), [*self.causes[:WRONG_SHOWN]]
        for finding in self.findings:
            if finding.right:
                lines += finding.lines()
            elif finding.cause in untold:
                untold.remove(finding.cause)
                lines += finding.lines()
        if self.right:
            lines.append(f"All right. {self.notice}")
        elif len(self.causes) > WRONG_SHOWN:
            lines.append("There is more to fix. Start with this.")
        lines += _quoted(self.output)
        if self.advice and not self.right:
            lines.append(self.advice)
        return "\n".join(lines)


def cut(text: str) -> str:
    """Shorten text to one line, with an ellipsis, and escape characters that UTF-8 cannot encode."""
    shown = text[: WIDTH + 1].encode(errors="backslashreplace").decode()
    return shown if len(shown) <= WIDTH else f"{shown[: WIDTH - 1]}…"


def right(text: str) -> Finding:
    """Make the finding for a case that the answer passed."""
    return Finding(True, cut(text))


def wrong(text: str, cause: str, place: Place | None = None) -> Finding:
    """Make the finding for a case that the answer failed."""
    return Finding(False, cut(text), cause, place)


def _quoted(output: tuple[str, ...]) -> Iterator[str]:
    if not output:
        return
    yield "Your code printed:"
    for line in output[:OUTPUT_SHOWN]:
        shown = _STAMP.sub(r"[\1] ", line)
        yield f"  | {cut(shown)}"
    if len(output) > OUTPUT_SHOWN:
        yield "  | ... and more"
