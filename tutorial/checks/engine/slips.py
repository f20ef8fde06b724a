"""Slips: small mistakes derived from the solution's source, such as a missing statement or a different number."""

import ast
from collections.abc import Callable, Iterator
from typing import Any

from tutorial.checks.engine.cases import Edit, Fault

COMPARISONS = (ast.Gt, ast.GtE, ast.Lt, ast.LtE, ast.Eq, ast.NotEq)
FACTORS = (10, 0.1, 2, 0.5, 5)  # a number in the source is multiplied by each of these

Slips = Iterator[tuple[str, Any, ast.AST]]  # each slip's cause, the part that it changes, and the new part
Kind = Callable[[ast.AST], Slips]


def slips(kind: Kind, source: str) -> Iterator[Fault]:
    """Yield every possible slip of one kind in the source, starting with its smallest parts.

    Args:
        kind: `missing` for missing statements, `another` for wrong parts of statements.
        source: the solution's source.
    """
    for node in reversed([*ast.walk(ast.parse(source))]):
        for cause, part, other in kind(node):
            yield Fault(cause, (_changed_lines(source, part, other),))


def missing(node: ast.AST) -> Slips:
    """Remove a statement that is not a docstring."""
    is_docstring = isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant)
    if isinstance(node, ast.Expr | ast.Assign | ast.AnnAssign | ast.Return) and not is_docstring:
        yield f"`{ast.unparse(node)}` is missing or never reached.", node, ast.Pass()


def another(node: ast.AST) -> Slips:
    """Change a part of an expression, or a condition."""
    match node:
        case ast.BinOp():
            yield from _other_operands(node)
        case ast.Compare(_, [op], [_]) if isinstance(op, COMPARISONS):
            yield from _other_comparisons(node)
        case ast.BoolOp():
            yield from _missing_operands(node)
        case ast.If(test) | ast.IfExp(test) | ast.comprehension(ifs=[test]):
            yield f"your code doesn't test `{ast.unparse(test)}`.", test, ast.Constant(True)
            yield f"your condition is reversed. Write `{ast.unparse(test)}`.", test, ast.UnaryOp(ast.Not(), test)
    yield from _other_numbers(node)


def _other_operands(node: ast.BinOp) -> Slips:
    code, is_sum = ast.unparse(node), isinstance(node.op, ast.Add | ast.Sub)
    unit = 0 if is_sum else 1  # leaves the other operand unchanged
    for each in (node.left, node.right):
        yield f"`{ast.unparse(each)}` is missing, or always {unit}. Write `{code}`.", each, ast.Constant(unit)
    for signed in (node.left, node.right, node) if is_sum else ():
        yield f"a sign is wrong. Write `{code}`.", signed, ast.UnaryOp(ast.USub(), signed)


def _other_comparisons(node: ast.Compare) -> Slips:
    for kind in COMPARISONS:
        if not isinstance(node.ops[0], kind):
            other = ast.Compare(node.left, [kind()], node.comparators)
            yield f"your code uses the wrong comparison. Write `{ast.unparse(node)}`.", node, other


def _missing_operands(node: ast.BoolOp) -> Slips:
    neutral = ast.Constant(isinstance(node.op, ast.And))
    for each in node.values:
        yield f"your code doesn't test `{ast.unparse(each)}`. Write `{ast.unparse(node)}`.", each, neutral


def _other_numbers(node: ast.AST) -> Slips:
    for number in ast.iter_child_nodes(node):
        if isinstance(number, ast.Constant) and type(number.value) in (int, float):
            for factor in map(ast.Constant, FACTORS):
                cause = f"a number is wrong or missing. Write `{ast.unparse(node)}`."
                yield cause, number, ast.BinOp(number, ast.Mult(), factor)


def _changed_lines(source: str, part: Any, other: ast.AST) -> Edit:
    """Return the edit that changes a part of the source by replacing the part's lines.

    The edit starts early enough to make the replaced lines unique in the source.
    """
    lines = source.splitlines()
    begin, end = part.lineno - 1, part.end_lineno
    instead = f"({ast.unparse(other)})" if isinstance(part, ast.expr) else ast.unparse(other)
    changed = lines[begin][: part.col_offset] + instead + lines[end - 1][part.end_col_offset :]
    while source.count("\n".join(lines[begin:end])) > 1:
        begin -= 1
    return Edit("\n".join(lines[begin:end]), "\n".join([*lines[begin : part.lineno - 1], changed]))
