"""Mutants: a source with one small fault each, as a tool for mutation testing would make them.

cosmic-ray and mutmut mutate the files of a project, one test run a mutant, and know neither the order of statements nor
names: `ast` needs less than they would.
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
OPPOSITES = {"min": "max", "max": "min"}  # of the names that are not the source's own
SYMMETRIC = {*OPPOSITES, "hypot"}  # take their arguments in any order
ENDS = ("create_publisher", "create_subscription")
"""The calls whose last argument, how many messages may wait, is left to an answer."""
FILE = "mutant"  # what a mutant's code has for a file

Edit = tuple[str, Any]  # the field of a node, and what it becomes


@dataclass(frozen=True)
class Mutant:
    """A source that differs in one place.

    Attributes:
        change: the lines that differ, before and after: ``"q = 1 → q = 2"``; a number tells apart what differs alike.
        source: the whole.
    """

    change: str
    source: str


@cache
def mutants_of(exercise: Exercise) -> tuple[Mutant, ...]:
    """Make every mutant of an exercise's right answer, each once, without those that are no Python.

    Its operators are replaced by others of their kind, numbers and texts changed, signs and conditions turned round,
    what stands side by side is exchanged, statements and other parts are left out, and names stand for one another.
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
    """Define a mutant as a notebook would; what its code takes from outside is the right answer's.

    Returns:
        The class or function.
    """
    lines = mutant.source.splitlines(keepends=True)
    linecache.cache[FILE] = (len(mutant.source), None, lines, FILE)
    space = {**vars(sys.modules[exercise.module]), "__name__": "__main__"}
    exec(compile(mutant.source, FILE, "exec", dont_inherit=True), space)
    return space[exercise.right_answer.__name__]


async def rejects(exercise: Exercise, mutant: Mutant, limit: float) -> bool:
    """Whether an exercise's check finds that a mutant is wrong, judged in a process of its own.

    Args:
        exercise: whose right answer it is a mutant of.
        mutant: the mutant.
        limit: how long it may take [s]; what takes longer is not rejected.
    """
    try:
        async with asyncio.timeout(limit):
            seen = await exercise.examine(define(exercise, mutant))
    except TimeoutError:
        return False
    return not (isinstance(seen, Verdict) and seen.right)


def _edits(tree: ast.Module) -> Iterator[tuple[ast.AST, str, Any]]:
    """Yield what can be done to the nodes, each with a field and its new value."""
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
    """Have each name stand for each other that is used alike, of the same object: read, set, called, or looked into."""
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
    """Whether two assignments may stand in either order: neither uses what the other sets, nor begins to listen."""
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
    """Turn the sign round; of a number that is done by `_other_constants`."""
    return value if isinstance(value, ast.Constant) else ast.UnaryOp(ast.USub(), value)


def _one_left_out(items: list[Any]) -> list[list[Any]]:
    return [[*items[:i], *items[i + 1 :]] for i in range(len(items))]


def _exchanged(items: list[Any]) -> list[list[Any]]:
    """Return the list with each two neighbours exchanged."""
    return [[*items[:i], items[i + 1], items[i], *items[i + 2 :]] for i in range(len(items) - 1)]


def _change(before: str, after: str) -> str:
    """Tell the lines that differ."""
    old, new = before.splitlines(), after.splitlines()
    begin = sum(1 for _ in takewhile(lambda pair: pair[0] == pair[1], zip(old, new)))
    rest = reversed(old[begin:]), reversed(new[begin:])
    end = sum(1 for _ in takewhile(lambda pair: pair[0] == pair[1], zip(*rest)))
    differing = ("; ".join(line.strip() for line in lines[begin : len(lines) - end]) for lines in (old, new))
    return " → ".join(text or "nothing" for text in differing)
