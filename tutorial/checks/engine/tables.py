"""Tables of mistakes as texts, and dicts of cases, read as `Case` and `Mistake`."""

import inspect
import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from itertools import product
from string import Template
from typing import Any

from tutorial.checks.engine.cases import Case, Edit, Mistake
from tutorial.checks.engine.publishing import SHARED_BY_ROBOTS, Publishing
from tutorial.checks.engine.viewer import Viewer
from tutorial.checks.engine.viewing import (
    MISSING_CALLS,
    MOVES,
    NOT_POSTED,
    POST,
    SHARED_BY_VIEWERS,
    past_the_queue,
    steps,
)


@dataclass(frozen=True)
class Table:
    """What a table says."""

    cases: list[Case]
    mistakes: list[Mistake]
    meaning: str


def read_table(
    tried: Mapping[str, Any],
    table: str,
    crashes: Sequence[str] = (),
    shared: Mapping[str, str] | None = None,
    words: Mapping[str, str] | None = None,
    make: Callable[[Any], Any] = lambda run: run,
    mistakes: Mapping[str, Sequence[Mistake]] | None = None,
) -> Table:
    """Read a table."""
    rows, said = parse(Template(table).substitute(words or {}))
    said = {**(shared or {}), **said}
    meaning = said.get("", "")
    general = [Mistake(cause, ways) for cause, ways, part in rows if not part]
    cases, taken = list[Case](), set[str]()
    for label, run in tried.items():
        part = max((each for each in said if each in label), key=len, default="")
        own = [Mistake(cause, ways) for cause, ways, at in rows if at and at in label and at not in taken]
        taken |= {at for _, _, at in rows if at and at in label}
        own = [*(mistakes or {}).get(label, ()), *own]
        is_own = said[part] if part else ""
        cases.append(Case(label, make(run), is_own, any(each in label for each in crashes), own))
    return Table(cases, general, meaning)


def parse(table: str) -> tuple[list[tuple[str, Any, str]], dict[str, str]]:
    """Return the rows of a table, each with cause, ways and part, and what is said by part."""
    lines = re.sub(r"\n +=>", " =>", inspect.cleandoc(table)) + "\n"
    block = r"((?:^#.*\n)*)((?:^[^\s#].*\n)+)((?:^ .*=>.*\n)*)"
    left = re.sub(block, "", lines, flags=re.MULTILINE).strip()
    rows, said, parts = list[Any](), dict[str, str](), list[str]()
    for marks, text, edits in re.findall(block, lines, re.MULTILINE):
        cause, parts = " ".join(text.split()), [mark[1:].strip() for mark in marks.splitlines()] or parts
        if edits:
            rows.append((cause, tuple(product(*map(_edits, edits.splitlines()))), (parts or [""])[0]))
            said = {**dict.fromkeys(parts, f"Most likely {cause}"), **said}
        elif parts:
            said |= dict.fromkeys(parts, cause)
        else:
            left = cause
    if left:
        raise ValueError(f"this is no cause with its edits below it, indented, what => what instead: {left}")
    return rows, said


def _edits(line: str) -> list[Edit]:
    old, *new = line.split("=>")
    return [Edit(old.strip(), each.strip().replace(" // ", "\n")) for each in new]


def read_viewer_table(
    tried: Mapping[str, Any], table: str, post: str = POST, crashes: Sequence[str] = (), viewer: Any = Viewer
) -> list[Case]:
    """Read the table of a viewer, whose cases are steps."""
    shared = {"": SHARED_BY_VIEWERS, "messages come": NOT_POSTED.format(post), "after each move": MOVES}
    waits = {"a call that waits when the controller leaves": [past_the_queue(post)], "after each move": MISSING_CALLS}
    make = partial(_steps, viewer=viewer)
    return read_table(tried, table, crashes, shared, {"post": post}, make, waits).cases


def _steps(done: Sequence[Any], viewer: Any) -> Any:
    return steps(*done, viewer=viewer)


def read_publisher_table(publishing: Publishing, tried: Mapping[str, Any], table: str) -> Table:
    """Read the table of a publisher."""
    shared = {"with steps of": publishing.wrong_steps, "two robots in turns": SHARED_BY_ROBOTS}
    return read_table(tried, f"#\n{inspect.cleandoc(table)}", shared=shared)
