"""What a check has found, and how it is said."""

import linecache
import re
from collections.abc import Iterator
from dataclasses import dataclass

WRONG_SHOWN = 2  # one thing after the other; what is wrong further down often follows from the first
OUTPUT_SHOWN = 20  # lines
WIDTH = 200  # characters of a line

_STAMP = re.compile(r"^\[(\w+)\] \[\d+\.\d+\] ")  # a log line's time, different in every run


@dataclass(frozen=True)
class Place:
    """A line of the learner's code.

    Attributes:
        file: as Python knows it; a notebook's cell has one, too.
        line: its number.
        function: which function it is in.
    """

    file: str
    line: int
    function: str

    def __str__(self) -> str:
        text = linecache.getline(self.file, self.line).strip()
        return f"in {self.function}, line {self.line}{': ' if text else ''}{text}"


@dataclass(frozen=True)
class Finding:
    """One thing that was looked at.

    Attributes:
        right: whether it was as it should be.
        text: what was looked at, and what was seen.
        cause: for what is wrong, the most likely cause, as a sentence.
        place: the line to look at, where there is one.
    """

    right: bool
    text: str
    cause: str = ""
    place: Place | None = None

    def lines(self) -> Iterator[str]:
        """Say it."""
        yield f"{'✓' if self.right else '✗'} {self.text}"
        if self.place is not None:
            yield f"  {cut(str(self.place))}"
        if self.cause:
            yield f"  {self.cause}"


@dataclass(frozen=True)
class Verdict:
    """All that a check has found.

    Attributes:
        findings: in the order of their looking, the root cause before what follows from it.
        notice: what to notice about an answer that is right.
        output: the lines that the learner's code has printed.
        advice: what to do about an answer that is wrong; the last line.
    """

    findings: tuple[Finding, ...]
    notice: str = ""
    output: tuple[str, ...] = ()
    advice: str = ""

    @property
    def right(self) -> bool:
        """Whether everything was as it should be."""
        return bool(self.findings) and all(finding.right for finding in self.findings)

    @property
    def causes(self) -> tuple[str, ...]:
        """The causes named, in order, each once."""
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
            lines.append("More is not right yet; mend this first.")
        lines += _quoted(self.output)
        if self.advice and not self.right:
            lines.append(self.advice)
        return "\n".join(lines)


def cut(text: str) -> str:
    """Shorten a text to one line's width; an ellipsis shows it. What UTF-8 has no bytes for is spelled out."""
    shown = text[: WIDTH + 1].encode(errors="backslashreplace").decode()
    return shown if len(shown) <= WIDTH else f"{shown[: WIDTH - 1]}…"


def right(text: str) -> Finding:
    """Make the finding that something is as it should be."""
    return Finding(True, cut(text))


def wrong(text: str, cause: str, place: Place | None = None) -> Finding:
    """Make the finding that something is not as it should be."""
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
