"""Finding the answers in a notebook: what is given to a check, and only the definitions that it needs.

A notebook is not run. Of its cells those statements are taken that bind a name which the answer uses, or which these
use in turn: imports, functions, classes and assignments. So an answer can be judged though other cells fail, or wait
for a simulation that nobody has started.
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
"""A line that is IPython's own."""
_BINDING = (
    *(ast.Import, ast.ImportFrom, ast.FunctionDef, ast.AsyncFunctionDef, ast.ClassDef, ast.Assign, ast.AnnAssign),
    *(ast.AugAssign, ast.If, ast.Try),
)


class Answer(NamedTuple):
    """What was given to a check.

    Attributes:
        exercise: the exercise's name.
        given: the expression that was given, for instance ``HeldJoint``; None where what it names is not there.
        statements: what it needs, in the notebook's order.
        unreadable: where it is not there, the cell that has it and cannot be read, and why; else empty.
    """

    exercise: str
    given: ast.expr | None
    statements: tuple[_Statement, ...]
    unreadable: str = ""

    def define(self) -> Any:
        """Run the statements in a namespace like a notebook's, and return what was given.

        A statement that fails is left out, as in a notebook, where what was defined before stays.

        Raises:
            Exception: what was given cannot be had; or why the last statement that failed did.
        """
        if self.given is None:
            return None
        space: dict[str, Any] = {"__name__": "__main__", "__builtins__": __builtins__}
        failed: Exception | None = None
        for statement in self.statements:
            try:
                module = ast.Module([statement.node], [])
                exec(compile(module, statement.file, "exec", dont_inherit=True), space)
            except Exception as error:  # noqa: BLE001 - it is a learner's code
                failed = error
        try:
            return eval(compile(ast.Expression(self.given), "check", "eval", dont_inherit=True), space)
        except NameError as error:
            raise failed or error from None


class _Statement(NamedTuple):
    """A statement at the top of a cell.

    Attributes:
        node: what it says.
        file: what its cell is called.
        binds: the names that it gives a meaning to.
        uses: the names of the notebook that it uses, at once or when it is called.
    """

    node: ast.stmt
    file: str
    binds: frozenset[str]
    uses: frozenset[str]


class _Check(NamedTuple):
    """A call of a check: of which exercise, what was given, and before which statement."""

    exercise: str
    given: ast.expr | None
    position: int


def cells_of(text: str) -> list[str]:
    """Return the code cells of a notebook.

    The library nbformat would take as long to be imported as an answer to be judged.

    Args:
        text: the file's.

    Raises:
        Exception: it is no notebook.
    """
    return ["".join(cell["source"]) for cell in json.loads(text)["cells"] if cell["cell_type"] == "code"]


def find_answers(cells: Sequence[str], exercises: Mapping[str, str]) -> list[Answer]:
    """Find the answers to the exercises that a notebook has.

    Args:
        cells: its code cells.
        exercises: by the exercise's name, what its answer is called.

    Returns:
        One for each exercise that is imported, checked or answered in the notebook, in the order of the checks. If one
        is called more than once, the last call counts that is given what the exercise asks for.
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
    """Collect what gives names their meaning, and what that uses: before a position, or else wherever it is."""
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
    """Parse a cell, and keep its lines, so that they can be quoted.

    Raises:
        Exception: it is no Python.
    """
    try:
        body = ast.parse(cell).body
    except SyntaxError:
        cell = MAGIC.sub(r"\1pass", cell)  # so that the other lines keep their numbers
        body = ast.parse(cell).body
    linecache.cache[name] = (len(cell), None, cell.splitlines(keepends=True), name)
    return body


def _aliases(nodes: Iterable[ast.stmt]) -> dict[str, str]:
    """Return the exercises that are imported, by the names that the notebook has for them."""
    imports = (each for node in nodes for each in ast.walk(node) if isinstance(each, ast.ImportFrom))
    ours = (each for each in imports if (each.module or "").startswith(CHECKS))
    return {alias.asname or alias.name: alias.name for each in ours for alias in each.names}


def _checks(node: ast.stmt, position: int, known: Mapping[str, str]) -> Iterator[_Check]:
    """Yield the checks that a statement calls: ``NAME.check(...)``."""
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
    """Whether a statement can be run here; one that awaits something only can in a running notebook."""
    try:
        compile(ast.Module([node], []), "cell", "exec", dont_inherit=True)
    except SyntaxError:
        return False
    return True


def _globals(table: symtable.SymbolTable) -> set[str]:
    """Collect the names of the notebook that functions and classes use."""
    inner = table.get_children()
    own = {symbol.get_name() for each in inner for symbol in each.get_symbols() if symbol.is_global()}
    return own.union(*(_globals(each) for each in inner))


def _names(expression: ast.expr) -> set[str]:
    return {each.id for each in ast.walk(expression) if isinstance(each, ast.Name)}


def _is_star(node: ast.stmt) -> bool:
    return isinstance(node, ast.ImportFrom) and any(alias.name == "*" for alias in node.names)
