"""Reads hand-written YAML files, checks them against a type, and reports mistakes with their line numbers."""

import re
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any, Generic, TypeVar

import msgspec
import yaml
from msgspec import inspect

from tutorial.errors import TutorialError, did_you_mean, printable

T = TypeVar("T")

WORDS = {
    "object": "a mapping",
    "array": "a list",
    "str": "text",
    "float": "a number",
    "int": "a whole number",
    "bool": "true or false",
    "null": "nothing",
}
"""YAML names for the types in msgspec's errors."""


class _Loader(yaml.SafeLoader):
    """Rejects duplicate keys and reports the line of a value that does not match its tag. PyYAML does neither."""

    def compose_mapping_node(self, anchor: Any) -> yaml.MappingNode:
        node = super().compose_mapping_node(anchor)
        seen = set()
        for key in (key for key, _ in node.value if isinstance(key, yaml.ScalarNode)):
            if key.value in seen:
                raise yaml.MarkedYAMLError(None, None, f"{key.value!r} appears twice. Keep one", key.start_mark)
            seen.add(key.value)
        return node

    def construct_object(self, node: yaml.Node, deep: bool = False) -> Any:
        try:
            return super().construct_object(node, deep)
        except (ValueError, LookupError, AttributeError, ArithmeticError) as error:
            problem = f"{node.value!r} is not a valid {node.tag.rpartition(':')[2]}"
            raise yaml.MarkedYAMLError(None, None, problem, node.start_mark) from error


_Loader.add_implicit_resolver(  # in YAML 1.2, 1e-3 is a number; PyYAML only accepts 1.0e-3
    "tag:yaml.org,2002:float", re.compile(r"[-+]?[0-9]+[eE][-+]?[0-9]+$"), list("-+0123456789")
)


class YamlFile(Generic[T]):
    """A YAML file, checked against a type.

    Args:
        path: the file.
        shape: a `msgspec.Struct`, with ``forbid_unknown_fields=True`` so that a misspelled key is an error.
        what: the kind of file, as it should appear in error messages, for instance ``"project"``.

    Attributes:
        path: as given.
        data: the file's content.

    Raises:
        TutorialError: the file is missing, is not YAML, or does not match the type; the message includes the line
            number and a suggestion.
    """

    def __init__(self, path: Path, shape: type[T], what: str) -> None:
        self.path = path
        self._root, content = self._parse(_read(path, what))
        try:
            self.data = msgspec.convert(content, shape)
        except msgspec.ValidationError as error:
            where, text = _refusal(str(error), shape)
            with self.at(*where):
                raise TutorialError(text) from None

    @contextmanager
    def at(self, *where: str | int) -> Iterator[None]:
        """Add the file and a line to every `TutorialError` that is raised inside this context.

        Args:
            where: the keys and indices that lead to the line.
        """
        try:
            yield
        except TutorialError as error:
            raise TutorialError(f"{self.path}, line {self._line(where)}: {error}") from None

    def _line(self, where: Iterable[str | int]) -> int:
        node = named = self._root
        for step in where:
            if isinstance(node, yaml.SequenceNode) and isinstance(step, int):
                node = named = node.value[step]
            else:
                keys = {key.value: (key, value) for key, value in node.value}
                named, node = keys.get(step, (named, node))
        return int(named.start_mark.line) + 1

    def _parse(self, text: str) -> tuple[yaml.Node, Any]:
        """Parse the file into nodes, which have line numbers, and convert the nodes to values."""
        try:
            root: Any = yaml.compose(text, Loader=_Loader) or yaml.compose("{}")  # an empty file has no fields
            return root, _Loader("").construct_document(root)
        except (yaml.YAMLError, ValueError, OverflowError, RecursionError) as error:
            mark = getattr(error, "problem_mark", None)
            line = mark.line if mark else text.count("\n", 0, getattr(error, "position", 0))
            problem = printable(getattr(error, "problem", None) or str(error).partition("\n")[0])
            raise TutorialError(f"{self.path}, line {line + 1}: this is not YAML: {problem}.") from error


def _refusal(error: str, shape: type) -> tuple[list[str | int], str]:
    """Return the location of the mistake that msgspec found, and a description of the mistake in YAML's terms."""
    problem, _, path = error.partition(" - at ")
    where = [int(index) if index else name for name, index in re.findall(r"\.(\w+)|\[(\d+)\]", path)]
    name = problem.partition("`")[2][:-1]
    if problem.startswith("Object contains unknown field"):
        return [*where, name], f"unknown key {name!r}.{did_you_mean(name, _fields(shape, where))}"
    if problem.startswith("Object missing required field"):
        return where, f"{name!r} is missing here."
    if path.startswith("`key` in"):
        return where, "a key here is not a string. Put it in quotes."
    place = path.strip("`$.")
    words = re.sub(r"`(\w+)`", lambda found: WORDS.get(found[1], found[1]), problem)
    return where, f"{place}{': ' * bool(place)}{words[0].lower()}{words[1:]}."


def _fields(shape: type, where: Iterable[str | int]) -> list[str]:
    """Return the field names of the structure at a location."""
    info: Any = inspect.type_info(shape)
    for step in where:
        info = info.item_type if isinstance(step, int) else {each.name: each.type for each in info.fields}[step]
    return [field.name for field in info.fields]


def _read(path: Path, what: str) -> str:
    try:
        return path.read_text(encoding="utf-8")
    except FileNotFoundError as error:
        others = [each.name for each in path.parent.glob("*.yaml")]
        raise TutorialError(f"there is no {what} {str(path)!r}.{did_you_mean(path.name, others)}") from error
    except OSError as error:
        raise TutorialError(f"{path} cannot be read: {error.strerror}.") from error
    except UnicodeDecodeError as error:
        line = error.object.count(b"\n", 0, error.start) + 1
        raise TutorialError(f"{path}, line {line}: this is not a UTF-8 text file: {error}") from error
