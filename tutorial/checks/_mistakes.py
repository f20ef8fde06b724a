"""Mistakes: edits of a solution's source, each with the cause that it is told as; of a table, or common slips."""

from __future__ import annotations  # for what is compiled here, too: an edit may spoil an annotation

import ast
import asyncio
import inspect
import itertools
import math
import re
import sys
from collections.abc import Callable, Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass
from functools import cache
from itertools import product
from typing import Any

A_MISTAKE = "<a mistake>"  # the file of a solution with mistakes
NEW_LINE = " // "
COMPARISONS = (ast.Gt, ast.GtE, ast.Lt, ast.LtE, ast.Eq, ast.NotEq)
Slips = Iterator[tuple[str, Any, ast.AST]]  # each the cause, the part of a source that is replaced, and by what
FACTORS = (10, 0.1, 2, 0.5, 5)  # by which a number is another


@dataclass(frozen=True)
class Mistake:
    """A way to be wrong.

    Attributes:
        cause: what names it, after the words "Most likely".
        edits: what in the solution's source is replaced, and by what: all that is like it, one after the other.
        fails: a part of the text of a case that it fails; "" for any.
    """

    cause: str
    edits: tuple[tuple[str, str], ...]
    fails: str = ""

    def made_in(self, source: str) -> str | None:
        """Return the source with the mistake; None for one without what it changes."""
        for old, new in self.edits:
            if old not in source:
                return None
            line = source[: source.index(old)].rpartition("\n")[2] + old
            indent = line[: len(line) - len(line.lstrip())]
            source = source.replace(old, new.replace(NEW_LINE, f"\n{indent}"))
        return source


def read(table: str) -> tuple[tuple[Mistake, ...], dict[str, str]]:
    """Read a table: mistakes, the root causes first, and what to say of a case that none of them explains.

    Args:
        table: one block for each mistake. Its cause stands at the margin. Below it stand its edits, indented, one a
            line: ``what => what instead``. A `` // `` in an edit begins a new line, indented as the changed one.
            ``what => this => that`` makes two mistakes with the same cause; the next line may go on with ``=>``. Change
            as little as possible: two mistakes that change the same text cannot be found together.
            A line with ``#`` and a part of cases' texts begins a section; ``#`` alone is for any case. A sentence in it
            without edits is said of these cases when no mistake explains them; where there is none, its first cause is.
            Mistakes in a section explain this case alone, if the exercise's cases are tried one by one.

    Returns:
        The mistakes, and by part of a case's text, the sentence.

    Raises:
        ValueError: a cause has no edit below it, or an edit no cause.
    """
    lines = re.sub(r"\n +=>", " =>", inspect.cleandoc(table)) + "\n"
    block = r"((?:^#.*\n)*)((?:^[^\s#].*\n)+)((?:^ .*=>.*\n)*)"
    left = re.sub(block, "", lines, flags=re.MULTILINE).strip()
    known, said, parts = list[Mistake](), dict[str, str](), list[str]()
    for marks, text, edits in re.findall(block, lines, re.MULTILINE):
        cause, parts = " ".join(text.split()), [mark[1:].strip() for mark in marks.splitlines()] or parts
        if edits:
            chosen = product(*map(_edits, edits.splitlines()))
            known += [Mistake(cause, each, *parts[:1]) for each in chosen]
            said = {**dict.fromkeys(parts, f"Most likely {cause}"), **said}
        elif parts:
            said |= dict.fromkeys(parts, cause)
        else:
            left = cause
    if left:
        raise ValueError(f"this is no cause with its edits below it, indented, what => what instead: {left}")
    return tuple(known), said


def _edits(line: str) -> list[tuple[str, str]]:
    old, *new = line.split("=>")
    return [(old.strip(), each.strip()) for each in new]


def with_mistakes(solution: Any, chosen: Sequence[Mistake], beside: Sequence[Any] = ()) -> Any:
    """Define a solution with mistakes in it; None where one leaves nothing for another to change.

    Args:
        solution: the right answer.
        chosen: the mistakes.
        beside: functions of the solution's module that a mistake may change, too.
    """
    source: str | None = _source((*beside, solution))
    for mistake in chosen:
        source = source and mistake.made_in(source)
    if source is None:
        return None
    names = {**vars(asyncio), **vars(math), **vars(itertools), **vars(sys.modules[solution.__module__])}
    with suppress(SyntaxError):  # one has left half of a statement for another to change
        exec(compile(source, A_MISTAKE, "exec"), names)
        return names[solution.__name__]
    return None


@cache
def _source(parts: tuple[Any, ...]) -> str:
    return "\n\n".join(map(inspect.getsource, parts))


def slips(kind: Callable[[ast.AST], Slips], solution: Any, beside: Sequence[Any] = ()) -> Iterator[Mistake]:
    """Make mistakes that need no table, the smallest first.

    Args:
        kind: `missing` for statements that are missing, `another` for parts of them that are another.
        solution: the right answer.
        beside: functions of the solution's module that a mistake may change, too.
    """
    source = _source((*beside, solution))
    for cause, part, other in (slip for node in reversed([*ast.walk(ast.parse(source))]) for slip in kind(node)):
        yield Mistake(cause, (_changed_lines(source, part, other),))


def missing(node: ast.AST) -> Slips:
    """Leave out a statement."""
    if isinstance(node, ast.Expr | ast.Assign | ast.AnnAssign | ast.Return):
        yield f"`{ast.unparse(node)}` is missing, or not reached.", node, ast.Pass()


def another(node: ast.AST) -> Slips:
    """Change a part of an expression, or a condition."""
    code = ast.unparse(node)
    match node:
        case ast.BinOp(left, op, right):
            unit = 0 if isinstance(op, ast.Add | ast.Sub) else 1  # leaves the other operand as it is
            for each in (left, right):
                yield f"`{ast.unparse(each)}` is missing, or always {unit}: it is `{code}`.", each, ast.Constant(unit)
            for each in (left, right, node) if unit == 0 else ():
                yield f"a sign is wrong: it is `{code}`.", each, ast.UnaryOp(ast.USub(), each)
        case ast.Compare(left, [op], [right]) if isinstance(op, COMPARISONS):
            for kind in (each for each in COMPARISONS if not isinstance(op, each)):
                yield f"the comparison is another: it is `{code}`.", node, ast.Compare(left, [kind()], [right])
        case ast.BoolOp(op, values):
            asked = ast.Constant(isinstance(op, ast.And))
            yield from ((f"`{ast.unparse(each)}` is not asked: it is `{code}`.", each, asked) for each in values)
        case ast.If(test) | ast.IfExp(test) | ast.comprehension(ifs=[test]):
            yield f"`{ast.unparse(test)}` is not asked.", test, ast.Constant(True)
            yield f"the condition is turned round: it is `{ast.unparse(test)}`.", test, ast.UnaryOp(ast.Not(), test)
    for number in ast.iter_child_nodes(node):
        if isinstance(number, ast.Constant) and type(number.value) in (int, float):
            for factor in map(ast.Constant, FACTORS):
                yield f"the number is another, or none: it is `{code}`.", number, ast.BinOp(number, ast.Mult(), factor)


def _changed_lines(source: str, part: Any, other: ast.AST) -> tuple[str, str]:
    """Return the lines of a part of a source, with as many before as make them unique, and what they become."""
    lines = source.splitlines()
    begin, end = part.lineno - 1, part.end_lineno
    instead = f"({ast.unparse(other)})" if isinstance(part, ast.expr) else ast.unparse(other)
    changed = lines[begin][: part.col_offset] + instead + lines[end - 1][part.end_col_offset :]
    while source.count("\n".join(lines[begin:end])) > 1:
        begin -= 1
    return "\n".join(lines[begin:end]), "\n".join([*lines[begin : part.lineno - 1], changed])
