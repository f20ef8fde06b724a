"""Mutants: variants of a source with one small fault each, as in mutation testing.

cosmic-ray and mutmut mutate a project's files, with a test run per mutant, but don't change the order of statements or
names. Using `ast` directly takes less code.
"""

import ast
import asyncio
import linecache
import sys
from collections import Counter, defaultdict
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cache
from itertools import pairwise, takewhile
from typing import Any

from tutorial.checks.engine.verdict import Verdict
from tutorial.checks.exercise import Exercise, listing

ARITHMETIC = (ast.Add, ast.Sub, ast.Mult, ast.Div, ast.FloorDiv, ast.Mod)
COMPARISONS = (ast.Lt, ast.LtE, ast.Gt, ast.GtE, ast.Eq, ast.NotEq)
OPPOSITES = {"min": "max", "max": "min"}  # for names that the source does not define itself
SYMMETRIC = {*OPPOSITES, "hypot"}  # functions whose arguments can be in any order
ENDS = ("create_publisher", "create_subscription")
"""Calls whose last argument, the number of waiting messages, an answer may choose."""
FILE = "mutant"  # the file name of a mutant's code

Edit = tuple[str, Any]  # a node's field, and its new value


@dataclass(frozen=True)
class Mutant:
    """A source with one change.

    Attributes:
        change: the changed lines, before and after: ``"q = 1 → q = 2"``; a number distinguishes equal changes.
        source: the whole source.
    """

    change: str
    source: str


@cache
def mutants_of(exercise: Exercise) -> tuple[Mutant, ...]:
    """Make every mutant of an exercise's right answer, without duplicates and invalid Python.

    They replace operators with similar ones, change numbers and texts, negate signs and conditions, swap
    neighbours, leave out statements and other parts, and exchange names.
    """
    tree = ast.parse(listing(exercise.right_answer))
    original = ast.unparse(tree)
    found: dict[str, Mutant] = {}
    times = Counter[str]()
    for node, field, value in _edits(tree):
        before = getattr(node, field)
        setattr(node, field, value)
        try:
            mutated = ast.unparse(tree)
            compile(mutated, FILE, "exec")
        except (SyntaxError, ValueError):
            continue
        finally:
            setattr(node, field, before)
        if mutated != original and mutated not in found:
            change = _change(original, mutated)
            times[change] += 1
            found[mutated] = Mutant(f"{change} ({times[change]})" if times[change] > 1 else change, mutated)
    return tuple(found.values())


def define(exercise: Exercise, mutant: Mutant) -> Any:
    """Define a mutant as a notebook would; names from outside its code come from the right answer's module.

    Returns:
        The class or function.
    """
    lines = mutant.source.splitlines(keepends=True)
    linecache.cache[FILE] = (len(mutant.source), None, lines, FILE)
    space = {**vars(sys.modules[exercise.module]), "__name__": "__main__"}
    exec(compile(mutant.source, FILE, "exec", dont_inherit=True), space)
    return space[exercise.right_answer.__name__]


async def rejects(exercise: Exercise, mutant: Mutant, limit: float) -> bool:
    """Return whether an exercise's check rejects a mutant, judged in a separate process.

    Args:
        exercise: the exercise of the mutated answer.
        mutant: the mutant.
        limit: the longest time that it may take [s]; a slower one is not rejected.
    """
    try:
        async with asyncio.timeout(limit):
            seen = await exercise.examine(define(exercise, mutant))
    except TimeoutError:
        return False
    return not (isinstance(seen, Verdict) and seen.right)


def _edits(tree: ast.Module) -> Iterator[tuple[ast.AST, str, Any]]:
    """Yield all possible edits: a node, a field and its new value."""
    calls = [node for node in ast.walk(tree) if isinstance(node, ast.Call)]
    depths = {id(call.args[-1]) for call in calls if ast.unparse(call.func).endswith(ENDS)}
    for node in ast.walk(tree):
        if id(node) not in depths:
            yield from ((node, field, value) for field, value in _parts_edits(node))
    yield from _exchanged_names([node for node in ast.walk(tree) if isinstance(node, ast.Attribute)], tree)
    for function in (node for node in ast.walk(tree) if isinstance(node, ast.FunctionDef)):
        names = [node for node in ast.walk(function) if isinstance(node, ast.Name)]
        own = {argument.arg for argument in function.args.args}
        own |= {name.id for name in names if isinstance(name.ctx, ast.Store)}
        yield from _exchanged_names([name for name in names if name.id in own - {"self"}], tree)
        yield from ((name, "id", OPPOSITES[name.id]) for name in names if name.id in OPPOSITES)


def _exchanged_names(nodes: Sequence[ast.Name | ast.Attribute], tree: ast.Module) -> Iterator[tuple[ast.AST, str, str]]:
    """Replace each name with every other one that is used in the same way on the same object: read, set or called."""
    uses = {id(node.func): "called" for node in ast.walk(tree) if isinstance(node, ast.Call)}
    looks = (node for node in ast.walk(tree) if isinstance(node, (ast.Attribute, ast.Subscript)))
    uses |= {id(node.value): "looked into" for node in looks}
    groups = defaultdict(list)
    for node in nodes:
        of = ast.unparse(node.value) if isinstance(node, ast.Attribute) else ""
        groups[of, uses.get(id(node), type(node.ctx).__name__)].append(node)
    for group in groups.values():
        field = "attr" if isinstance(group[0], ast.Attribute) else "id"
        names = dict.fromkeys(getattr(node, field) for node in group)
        for node in group:
            yield from ((node, field, name) for name in names if name != getattr(node, field))


def _parts_edits(node: ast.AST) -> Iterator[Edit]:
    if isinstance(node, (ast.If, ast.IfExp, ast.While)):
        conditions = (_negated(node.test), ast.Constant(True), ast.Constant(False))
        yield from (("test", other) for other in conditions)
    match node:
        case ast.BinOp(left, op, right):
            yield from (("op", other()) for other in ARITHMETIC if not isinstance(op, other))
            yield from (("left", _negative(left)), ("right", _negative(right)))
        case ast.Compare(left, [op], [right]):
            yield from (("ops", [other]) for other in _other_comparisons(op))
            if isinstance(op, COMPARISONS):
                yield from (("left", _negative(left)), ("comparators", [_negative(right)]))
        case ast.BoolOp(op, values):
            yield "op", ast.And() if isinstance(op, ast.Or) else ast.Or()
            yield from (("values", [*values[:i], _negated(each), *values[i + 1 :]]) for i, each in enumerate(values))
            yield from (("values", rest) for rest in _one_left_out(values) if len(values) > 2)
            yield from (("values", [each, each]) for each in values if len(values) == 2)
        case ast.Constant(value):
            yield from (("value", other) for other in _other_constants(value))
        case ast.comprehension(ifs=[test]):
            yield from (("ifs", [_negated(test)]), ("ifs", []))
        case ast.Tuple(elements) | ast.List(elements):
            yield from (("elts", others) for others in _exchanged(elements))
            yield from (("elts", rest) for rest in _one_left_out(elements))
        case ast.Call(function, arguments, keywords):
            if ast.unparse(function) not in SYMMETRIC:
                yield from (("args", others) for others in _exchanged(arguments))
            for others in _exchanged(keywords):
                yield "keywords", [ast.keyword(each.arg, other.value) for each, other in zip(keywords, others)]
            yield from (("keywords", rest) for rest in _one_left_out(keywords))
        case ast.Assign([_, _, *_] as targets):
            yield from (("targets", rest) for rest in _one_left_out(targets))
        case ast.Return(ast.expr()):
            yield "value", None
        case ast.stmt(body=[*body]):
            yield from (("body", rest or [ast.Pass()]) for rest in _one_left_out(body))
            if not isinstance(node, ast.ClassDef):
                swaps = zip(pairwise(body), _exchanged(body))
                yield from (("body", others) for pair, others in swaps if not _are_unrelated(*pair))


def _are_unrelated(one: ast.stmt, other: ast.stmt) -> bool:
    """Return whether two assignments can be swapped: neither uses the other's target, and neither subscribes."""
    if not (isinstance(one, ast.Assign) and isinstance(other, ast.Assign)) or ".create_" in ast.unparse([one, other]):
        return False
    sets, uses = [], []
    for each in (one, other):
        targets = [part for target in each.targets for part in ast.walk(target)]
        sets.append({ast.unparse(part) for part in targets if isinstance(getattr(part, "ctx", None), ast.Store)})
        uses.append({ast.unparse(part) for part in ast.walk(each) if isinstance(part, ast.expr)})
    return sets[0].isdisjoint(uses[1]) and sets[1].isdisjoint(uses[0])


def _other_comparisons(op: ast.cmpop) -> list[ast.cmpop]:
    opposites = {ast.In: ast.NotIn, ast.NotIn: ast.In, ast.Is: ast.IsNot, ast.IsNot: ast.Is}
    if type(op) in opposites:
        return [opposites[type(op)]()]
    return [other() for other in COMPARISONS if not isinstance(op, other)]


def _other_constants(value: object) -> list[object]:
    match value:
        case bool():
            return [not value]
        case int():
            return [value + 1, value - 1, *([-value] if value else [])]
        case float():
            return [1.1 * value, 0.5 * value, -value] if value else [1.0, -1.0]
        case str():
            return [f"{value}_", ""]
    return []


def _negated(test: ast.expr) -> ast.expr:
    if isinstance(test, ast.UnaryOp) and isinstance(test.op, ast.Not):
        return test.operand
    return ast.UnaryOp(ast.Not(), test)


def _negative(value: ast.expr) -> ast.expr:
    """Negate an expression; `_other_constants` negates numbers."""
    return value if isinstance(value, ast.Constant) else ast.UnaryOp(ast.USub(), value)


def _one_left_out(items: list[Any]) -> list[list[Any]]:
    return [[*items[:i], *items[i + 1 :]] for i in range(len(items))]


def _exchanged(items: list[Any]) -> list[list[Any]]:
    """Return the list with each pair of neighbours swapped."""
    return [[*items[:i], items[i + 1], items[i], *items[i + 2 :]] for i in range(len(items) - 1)]


def _change(before: str, after: str) -> str:
    """Describe the lines that differ."""
    old, new = before.splitlines(), after.splitlines()
    begin = sum(1 for _ in takewhile(lambda pair: pair[0] == pair[1], zip(old, new)))
    rest = reversed(old[begin:]), reversed(new[begin:])
    end = sum(1 for _ in takewhile(lambda pair: pair[0] == pair[1], zip(*rest)))
    differing = ("; ".join(line.strip() for line in lines[begin : len(lines) - end]) for lines in (old, new))
    return " → ".join(text or "nothing" for text in differing)
