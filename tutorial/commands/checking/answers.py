"""Finds the answers in a notebook: the arguments of checks, with only the definitions that they need.

The notebook is not run. This module extracts the imports, functions, classes and assignments that define the names used
by the answer, directly or indirectly. Therefore, an answer can be judged even if other cells fail, or wait for a
simulation that nobody has started.
"""

from __future__ import annotations

import ast
import json
import linecache
import re
import symtable
from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import Any, NamedTuple

CHECKS = "tutorial.checks."
MAGIC = re.compile(r"^([^\S\n]*)(?:[%!?].*|.*\?)$", re.MULTILINE)
"""Matches a line in IPython's own syntax."""
WRITES_DRIVER = re.compile(r"\s*%%(?:writefile|file)[^\S\n]+['\"]?my_driver\.py['\"]?[^\S\n]*\n(.*)", re.DOTALL)
"""Matches a cell that writes the driver for the race."""
_BINDING = (
    *(ast.Import, ast.ImportFrom, ast.FunctionDef, ast.AsyncFunctionDef, ast.ClassDef, ast.Assign, ast.AnnAssign),
    *(ast.AugAssign, ast.If, ast.Try),
)


class Answer(NamedTuple):
    """The argument of a check.

    Attributes:
        exercise: the exercise's name.
        given: the argument, for instance ``HeldJoint``; None if the notebook does not define it.
        statements: the statements that it needs, in the notebook's order.
        unreadable: if its definition is in a cell with a syntax error, the cell and the error; otherwise empty.
    """

    exercise: str
    given: ast.expr | None
    statements: tuple[_Statement, ...]
    unreadable: str = ""

    def define(self) -> Any:
        """Run the statements in one namespace, as a notebook does, and return the value of the argument.

        Statements that fail are skipped, so earlier definitions remain, as in a notebook.

        Raises:
            Exception: the argument cannot be evaluated. If a name is missing, the error from the last failed statement
                is raised instead, if there is one.
        """
        if self.given is None:
            return None
        space: dict[str, Any] = {"__name__": "__main__", "__builtins__": __builtins__}
        failed: Exception | None = None
        for statement in self.statements:
            try:
                module = ast.Module([statement.node], [])
                exec(compile(module, statement.file, "exec", dont_inherit=True), space)
            except Exception as error:  # noqa: BLE001 - a learner's code can raise anything
                failed = error
        try:
            return eval(compile(ast.Expression(self.given), "check", "eval", dont_inherit=True), space)
        except NameError as error:
            raise failed or error from None


class _Statement(NamedTuple):
    """A top-level statement of a cell.

    Attributes:
        node: the syntax tree.
        file: the cell's name.
        binds: the names that it defines or changes.
        uses: the global names that it uses, immediately or when a function that it defines is called.
    """

    node: ast.stmt
    file: str
    binds: frozenset[str]
    uses: frozenset[str]


class _Check(NamedTuple):
    """A call to a check: its exercise, its argument, and the index of its statement."""

    exercise: str
    given: ast.expr | None
    position: int


def cells_of(text: str) -> list[str]:
    """Return the code cells of a notebook.

    This function does not use nbformat, because importing it takes as long as judging an answer.

    Args:
        text: the content of the file.

    Raises:
        Exception: the text is not a notebook.
    """
    return ["".join(cell["source"]) for cell in json.loads(text)["cells"] if cell["cell_type"] == "code"]


def find_driver(cells: Sequence[str]) -> str:
    """Return the driver for the race, from the last cell that writes ``my_driver.py``; an empty string if none does."""
    written = filter(None, map(WRITES_DRIVER.fullmatch, cells))
    return next((match[1] for match in reversed([*written])), "")


def find_answers(cells: Sequence[str], exercises: Mapping[str, str]) -> list[Answer]:
    """Find the answers to the exercises in a notebook.

    Args:
        cells: the notebook's code cells.
        exercises: a mapping from each exercise's name to the name of its answer.

    Returns:
        An answer for each exercise that the notebook imports, checks or answers, in the order of the checks. If a check
        is called several times, the last call whose argument is the answer's own name is used; if there is none, the
        last call is used.
    """
    nodes: list[tuple[ast.stmt, str]] = []
    unreadable: dict[str, tuple[str, str]] = {}
    for number, cell in enumerate(cells, 1):
        try:
            nodes += [(node, f"cell {number}") for node in _parsed(cell, f"cell {number}")]
        except (SyntaxError, ValueError, RecursionError, MemoryError) as error:
            unreadable[f"cell {number}"] = (cell, f"{type(error).__name__}: {getattr(error, 'msg', error)}")
    known = _aliases(node for node, _ in nodes)
    checks = [check for i, (node, _) in enumerate(nodes) for check in _checks(node, i, known)]
    statements = [_statement(node, file) for node, file in nodes]
    defined = {name for each in statements for name in each.binds}
    here = {*known.values(), *(check.exercise for check in checks)}
    order = list(dict.fromkeys([*(check.exercise for check in checks), *exercises]))
    return [
        _answer(exercise, exercises[exercise], [c for c in checks if c.exercise == exercise], statements, unreadable)
        for exercise in order
        if exercise in exercises and (exercise in here or exercises[exercise] in defined)
    ]


def _answer(
    exercise: str,
    name: str,
    calls: Sequence[_Check],
    statements: Sequence[_Statement],
    unreadable: Mapping[str, tuple[str, str]],
) -> Answer:
    own = ast.parse(name, mode="eval").body
    proper = [call for call in calls if isinstance(call.given, ast.Name) and call.given.id == name]
    check = [_Check(exercise, own, len(statements)), *calls, *proper][-1]
    given = check.given or own
    needed = _needed(_names(given), statements, check.position)
    if not isinstance(given, ast.Name) or any(given.id in each.binds for each in needed):
        return Answer(exercise, given, tuple(needed))
    begins = re.compile(rf"^\s*(class|def)\s+{re.escape(given.id)}\b", re.MULTILINE)
    why = (f"{where} cannot be read: {error}" for where, (cell, error) in unreadable.items() if begins.search(cell))
    return Answer(exercise, None, (), next(why, ""))


def _needed(names: Iterable[str], statements: Sequence[_Statement], position: int) -> list[_Statement]:
    """Collect the statements that define names, recursively.

    If a name is defined before the given position, ignore its definitions after that position.
    """
    found: set[int] = {i for i, each in enumerate(statements) if _is_star(each.node)}
    waiting, seen = list(names), set(names)
    while waiting:
        name = waiting.pop()
        binding = [i for i, each in enumerate(statements) if name in each.binds]
        binding = [i for i in binding if i < position] or binding
        found.update(binding)
        new = {use for i in binding for use in statements[i].uses} - seen
        seen |= new
        waiting += new
    return [statements[i] for i in sorted(found)]


def _parsed(cell: str, name: str) -> list[ast.stmt]:
    """Parse a cell, and store its lines for tracebacks.

    Raises:
        Exception: the cell is not valid Python.
    """
    try:
        body = ast.parse(cell).body
    except SyntaxError:
        cell = MAGIC.sub(r"\1pass", cell)  # does not change the line numbers
        body = ast.parse(cell).body
    linecache.cache[name] = (len(cell), None, cell.splitlines(keepends=True), name)
    return body


def _aliases(nodes: Iterable[ast.stmt]) -> dict[str, str]:
    """Return the imported exercises, by their names in the notebook."""
    imports = (each for node in nodes for each in ast.walk(node) if isinstance(each, ast.ImportFrom))
    ours = (each for each in imports if (each.module or "").startswith(CHECKS))
    return {alias.asname or alias.name: alias.name for each in ours for alias in each.names}


def _checks(node: ast.stmt, position: int, known: Mapping[str, str]) -> Iterator[_Check]:
    """Yield the checks that a statement calls, as in ``NAME.check(...)``."""
    for call in ast.walk(node):
        if not (isinstance(call, ast.Call) and isinstance(call.func, ast.Attribute) and call.func.attr == "check"):
            continue
        if isinstance(call.func.value, ast.Name) and call.func.value.id in known:
            given = [*call.args, *(keyword.value for keyword in call.keywords)]
            yield _Check(known[call.func.value.id], given[0] if given else None, position)


def _statement(node: ast.stmt, file: str) -> _Statement:
    if not isinstance(node, _BINDING) or not _compiles(node):
        return _Statement(node, file, frozenset(), frozenset())
    table = symtable.symtable(ast.unparse(node), file, "exec")
    symbols = table.get_symbols()
    binds = {symbol.get_name() for symbol in symbols if symbol.is_assigned() or symbol.is_imported()}
    uses = {symbol.get_name() for symbol in symbols if symbol.is_referenced()}
    changed = {name for target in getattr(node, "targets", ()) for name in _names(target)}  # HeldJoint.aim = ...
    return _Statement(node, file, frozenset(binds | changed), frozenset(uses | _globals(table)))


def _compiles(node: ast.stmt) -> bool:
    """Return whether a statement compiles here; a top-level ``await`` compiles only in a notebook."""
    try:
        compile(ast.Module([node], []), "cell", "exec", dont_inherit=True)
    except SyntaxError:
        return False
    return True


def _globals(table: symtable.SymbolTable) -> set[str]:
    """Collect the global names that functions and classes use."""
    inner = table.get_children()
    own = {symbol.get_name() for each in inner for symbol in each.get_symbols() if symbol.is_global()}
    return own.union(*(_globals(each) for each in inner))


def _names(expression: ast.expr) -> set[str]:
    return {each.id for each in ast.walk(expression) if isinstance(each, ast.Name)}


def _is_star(node: ast.stmt) -> bool:
    return isinstance(node, ast.ImportFrom) and any(alias.name == "*" for alias in node.names)
