"""Source as a notebook has it: without annotations and docstrings, so that it needs no imports for them."""

from __future__ import annotations

import ast
import inspect
from collections.abc import Iterator
from typing import Any

__all__ = ["listing"]

Span = tuple[int, int, int]  # line, from column, to column


def listing(part: Any) -> str:
    """Return the source of a class or function, ready to be pasted into a cell.

    Its comments stay, and so do its blank lines.

    Args:
        part: the class or function, written at the top level of its module.
    """
    source = inspect.getsource(part)
    tree = ast.parse(source)
    lines = source.splitlines()
    for line, begin, end in sorted(_annotations(tree, lines), reverse=True):
        lines[line] = lines[line][:begin] + lines[line][end:]
    gone = {line for node in ast.walk(tree) for line in _docstring(node)}
    kept = [line for number, line in enumerate(lines) if number not in gone]
    return "\n".join(line for i, line in enumerate(kept) if line or i == 0 or not kept[i - 1].endswith(":"))


def _annotations(tree: ast.AST, lines: list[str]) -> Iterator[Span]:
    """Yield where the annotations are, each within its line, with the colon or arrow before it."""
    for node in ast.walk(tree):
        if isinstance(node, ast.arg) and node.annotation is not None:
            yield _to_end(node.annotation, node.col_offset + len(node.arg))
        elif isinstance(node, ast.FunctionDef) and node.returns is not None:
            arrow = lines[node.returns.lineno - 1].rindex(" ->", 0, node.returns.col_offset)
            yield _to_end(node.returns, arrow)
        elif isinstance(node, ast.AnnAssign):
            yield _to_end(node.annotation, node.target.end_col_offset or 0)


def _to_end(annotation: ast.expr, begin: int) -> Span:
    return annotation.lineno - 1, begin, annotation.end_col_offset or 0


def _docstring(node: ast.AST) -> range:
    """Return the lines of the docstring, none where there is none."""
    if isinstance(node, (ast.ClassDef, ast.FunctionDef)) and ast.get_docstring(node, clean=False) is not None:
        return range(node.body[0].lineno - 1, node.body[0].end_lineno or 0)
    return range(0)
