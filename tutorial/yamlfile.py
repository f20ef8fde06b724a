"""YAML files that people write by hand: read, checked against a type, and wrong with a line number."""

from __future__ import annotations

import re
import sys
from collections.abc import Iterable
from pathlib import Path
from typing import Any, Generic, TypeVar

import msgspec
import yaml
from msgspec import inspect
from yaml.reader import ReaderError

from tutorial.errors import TutorialError, did_you_mean, printable
from tutorial.paths import is_file, is_folder

__all__ = ["YamlFile"]

T = TypeVar("T")

SUFFIXES = (".yaml", ".yml")
TEXT = "tag:yaml.org,2002:str"

LARGEST = 100_000
"""Of a file [bytes]: two thousand moments of a drive, which take two seconds to read."""
DEEPEST = 20
MOST_KEYS = 100
"""Of a mapping, merged ones included: a few lines of merges of merges would make billions."""
LONGEST = 60
"""Of what is repeated in an error [characters]."""

EXPECTED: dict[type[inspect.Type], tuple[str, tuple[type, ...]]] = {
    inspect.StructType: ("a mapping", (dict,)),
    inspect.ListType: ("a list", (list,)),
    inspect.TupleType: ("a list", (list,)),
    inspect.StrType: ("a text", (str,)),
    inspect.FloatType: ("a number", (float, int)),
    inspect.IntType: ("a whole number", (int,)),
    inspect.BoolType: ("true or false", (bool,)),
}
"""What a shape may consist of: in YAML's words, and as Python has it."""

GOT = {kinds[0]: words for words, kinds in EXPECTED.values()} | {int: "a whole number", type(None): "nothing"}


class _Refused(yaml.MarkedYAMLError):
    """It is YAML, but nothing that a person would write."""


class _Loader(yaml.SafeLoader):
    """Has bounds, takes no key twice, and says which value is not what its tag says.

    PyYAML itself has no bounds, takes the last of several keys, and lets out whatever a conversion raises.
    """

    def __init__(self, text: str) -> None:
        super().__init__(text)
        self._depth = 0

    def compose_node(self, parent: yaml.Node | None, index: Any) -> yaml.Node | None:
        if self._depth == DEEPEST:
            raise _Refused(
                problem=f"nested deeper than {DEEPEST} levels, which nothing here needs",
                problem_mark=self.peek_event().start_mark,  # type: ignore[no-untyped-call]
            )
        self._depth += 1
        try:
            return super().compose_node(parent, index)
        finally:
            self._depth -= 1

    def compose_mapping_node(self, anchor: Any) -> yaml.MappingNode:
        node = super().compose_mapping_node(anchor)
        seen = set()
        for key in (key for key, _ in node.value if isinstance(key, yaml.ScalarNode)):
            if key.value in seen:
                problem = f"{_shown(key.value)} is there twice. Keep one"
                raise _Refused(problem=problem, problem_mark=key.start_mark)
            seen.add(key.value)
        return node

    def flatten_mapping(self, node: yaml.MappingNode) -> None:
        super().flatten_mapping(node)
        if len(node.value) > MOST_KEYS:
            raise _Refused(
                problem=f"a mapping of more than {MOST_KEYS} keys, which nothing here needs",
                problem_mark=node.start_mark,
            )

    def construct_object(self, node: yaml.Node, deep: bool = False) -> Any:
        try:
            return super().construct_object(node, deep)
        except (ValueError, LookupError, AttributeError, ArithmeticError) as error:
            problem = f"{_shown(str(node.value))} is no {node.tag.rpartition(':')[2]}"
            raise yaml.MarkedYAMLError(problem=problem, problem_mark=node.start_mark) from error


_Loader.add_implicit_resolver(  # YAML 1.2 has 1e-3 for a number, as everybody else; PyYAML wants 1.0e-3
    "tag:yaml.org,2002:float", re.compile(r"[-+]?[0-9]+[eE][-+]?[0-9]+$"), list("-+0123456789")
)


class YamlFile(Generic[T]):
    """One YAML file that has the shape of a type.

    Args:
        path: where it is.
        shape: a `msgspec.Struct`, with ``forbid_unknown_fields=True`` so that a mistyped key is found.
        what: what the file is, as it should appear in errors, for instance ``"project"``.

    Attributes:
        path: as given.
        data: the file's content.

    Raises:
        TutorialError: there is no such file, it is no YAML, or it has another shape; the text names the line and the
            mend.
    """

    def __init__(self, path: Path, shape: type[T], what: str) -> None:
        self.path = path
        self._root, content = self._parse(_read(path, what))
        self._check(self._root, content, inspect.type_info(shape), "")
        self.data = msgspec.convert(content, shape)

    def error(self, where: Iterable[str | int], text: str) -> TutorialError:
        """Make an error about one place in the file.

        Args:
            where: the keys and indices that lead to the place.
            text: what is wrong there, and the mend.
        """
        return self._error(self._node(where), text)

    def _error(self, node: yaml.Node, text: str) -> TutorialError:
        return TutorialError(f"{self.path}, line {node.start_mark.line + 1}: {text}")

    def _node(self, where: Iterable[str | int]) -> yaml.Node:
        node = self._root
        for step in where:
            node = node.value[step] if isinstance(step, int) else {k.value: v for k, v in node.value}[step]
        return node

    def _parse(self, text: str) -> tuple[yaml.Node, Any]:
        """Read the file as nodes, which know their lines, and as what they say."""
        try:
            root = yaml.compose(text, Loader=_Loader)
            if root is not None:
                return root, _Loader("").construct_document(root)
        except yaml.MarkedYAMLError as error:
            line = error.problem_mark.line + 1 if error.problem_mark else 1
            problem = printable(" ".join(filter(None, (error.context, error.problem)))[:200])
            verdict = "" if isinstance(error, _Refused) else "this is not YAML: "
            raise TutorialError(f"{self.path}, line {line}: {verdict}{problem}.") from error
        except ReaderError as error:
            line = text.count("\n", 0, error.position) + 1
            problem = f"there is no character {error.character:#x} in a text"
            raise TutorialError(f"{self.path}, line {line}: this is not YAML: {problem}.") from error
        except (yaml.YAMLError, ValueError, OverflowError, RecursionError) as error:  # a character that there is not
            raise TutorialError(f"{self.path}, line 1: this is not YAML: {error}") from error
        raise TutorialError(f"{self.path}, line 1: the file is empty.")

    def _check(self, node: yaml.Node, content: Any, info: inspect.Type, place: str) -> None:
        """Compare a place of the file, and all below it, with what it should be.

        Args:
            node: the place.
            content: what it says.
            info: what it should be.
            place: what to call it, for instance ``"bodies[0].position"``; empty for the whole file.

        Raises:
            TutorialError: it is something else.
        """
        words, kinds = EXPECTED[type(info)]
        at = f"{place}: " if place else ""
        if type(content) not in kinds:
            got = GOT.get(type(content), f"a {type(content).__name__}")
            raise self._error(node, f"{at}expected {words}, got {got}.")
        if lacking := _lacking(content, info):
            raise self._error(node, f"{at}expected {words} {lacking}.")
        if isinstance(info, inspect.StructType):
            fields = {field.encode_name: field.type for field in info.fields}
            self._check_keys(node, info, list(fields))
            for key, value in {key.value: value for key, value in node.value}.items():  # after merged ones, its own
                self._check(value, content[key], fields[key], f"{place}.{key}".lstrip("."))
        elif isinstance(info, inspect.ListType | inspect.TupleType):
            types = info.item_types if isinstance(info, inspect.TupleType) else [info.item_type] * len(content)
            for i, (item, each, kind) in enumerate(zip(node.value, content, types, strict=True)):
                self._check(item, each, kind, f"{place}[{i}]")

    def _check_keys(self, node: yaml.Node, info: inspect.StructType, known: list[str]) -> None:
        for key, _ in node.value:
            if key.tag != TEXT or key.value not in known:
                raise self._error(
                    key, f"{_shown(key.value)} is not known here.{did_you_mean(key.value[:LONGEST], known)}"
                )
        there = {key.value for key, _ in node.value}
        for field in info.fields:
            if field.required and field.encode_name not in there:
                raise self._error(node, f"{field.encode_name!r} is missing here.")


def _lacking(content: Any, info: inspect.Type) -> str:
    """What something of the right kind still lacks, for instance ``"<= 0.01"``; empty if nothing."""
    wanted: dict[str, bool] = {}
    if isinstance(info, inspect.FloatType | inspect.IntType):
        wanted = {
            "that is finite": abs(content) <= sys.float_info.max,
            f"> {info.gt}": info.gt is None or content > info.gt,
            f">= {info.ge}": info.ge is None or content >= info.ge,
            f"<= {info.le}": info.le is None or content <= info.le,
        }
    elif isinstance(info, inspect.TupleType):
        wanted = {f"of length {len(info.item_types)}, got {len(content)}": len(content) == len(info.item_types)}
    elif isinstance(info, inspect.ListType):
        wanted = {
            f"of length >= {info.min_length}": len(content) >= (info.min_length or 0),
            f"of length <= {info.max_length}": info.max_length is None or len(content) <= info.max_length,
        }
    return next((text for text, holds in wanted.items() if not holds), "")


def _shown(text: str) -> str:
    """Repeat a text from the file, in quotes, as far as somebody wants to read it."""
    return repr(text if len(text) <= LONGEST else f"{text[:LONGEST]}...")


def _read(path: Path, what: str) -> str:
    if not is_file(path):
        others = [p.name for p in path.parent.glob("*") if p.suffix in SUFFIXES] if is_folder(path.parent) else []
        raise TutorialError(f"there is no {what} {str(path)!r}.{did_you_mean(path.name, others) if others else ''}")
    try:
        with path.open("rb") as file:
            content = file.read(LARGEST + 1)
    except OSError as error:
        raise TutorialError(f"{path} cannot be read: {error.strerror}.") from error
    if len(content) > LARGEST:
        raise TutorialError(f"{path} has more than {LARGEST:,} bytes, which is no {what} that a person writes.")
    try:
        return content.decode("utf-8")
    except UnicodeDecodeError as error:
        line = content.count(b"\n", 0, error.start) + 1
        raise TutorialError(f"{path}, line {line}: this is not a text file in UTF-8: {error}") from error
