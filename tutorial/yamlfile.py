"""YAML files that people write by hand: read, checked against a type, and wrong with a line number."""

from __future__ import annotations

import re
from collections.abc import Iterable
from pathlib import Path
from typing import Any, Generic, TypeVar

import msgspec
import msgspec.inspect
import yaml

from tutorial.errors import TutorialError, did_you_mean

__all__ = ["YamlFile"]

T = TypeVar("T")

SUFFIXES = (".yaml", ".yml")
YAML_WORDS = {"`object`": "a mapping", "`array`": "a list", "`null`": "nothing", "`str`": "a text"} | {
    "`float`": "a number",
    "`int`": "a whole number",
    "`bool`": "true or false",
}


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
        try:
            self.data = msgspec.convert(content, shape)
        except msgspec.ValidationError as error:
            raise self._explain(error, shape) from None

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
            root = yaml.compose(text, Loader=yaml.SafeLoader)
            if root is not None:
                return root, yaml.SafeLoader("").construct_document(root)
        except yaml.MarkedYAMLError as error:
            line = error.problem_mark.line + 1 if error.problem_mark else 1
            problem = " ".join(filter(None, (error.context, error.problem)))
            raise TutorialError(f"{self.path}, line {line}: this is not YAML: {problem}.") from error
        except (yaml.YAMLError, ValueError) as error:  # ValueError: a date that there is not
            raise TutorialError(f"{self.path}, line 1: this is not YAML: {error}") from error
        raise TutorialError(f"{self.path}, line 1: the file is empty.")

    def _explain(self, error: msgspec.ValidationError, shape: type[T]) -> TutorialError:
        """Say an error of msgspec's, such as ``Expected `float`, got `str` - at `$.drive```, in YAML's words."""
        problem, _, place = str(error).partition(" - at `$")
        where = [int(index) if index else key for index, key in re.findall(r"\[(\d+)\]|\.?(\w+)", place)]
        key = problem.split("`")[1]
        if "unknown field" in problem:
            node = next(k for k, _ in self._node(where).value if k.value == key)
            return self._error(node, f"{key!r} is not known here.{did_you_mean(key, _keys(shape, where))}")
        if "missing required field" in problem:
            return self.error(where, f"{key!r} is missing here.")
        for word, yaml_word in YAML_WORDS.items():
            problem = problem.replace(word, yaml_word)
        problem = problem[0].lower() + problem[1:]
        return self.error(where, f"{place.strip('.`')}: {problem}." if where else f"{problem}.")


def _keys(shape: type, where: Iterable[str | int]) -> list[str]:
    """The keys that a mapping may have at some place of a type."""
    info = _struct(msgspec.inspect.type_info(shape))
    for step in where:
        inner = info.item_type if isinstance(step, int) else {f.encode_name: f.type for f in info.fields}[step]
        info = _struct(inner)
    return [field.encode_name for field in info.fields]


def _struct(info: Any) -> Any:
    """Of something optional, what it is if it is there."""
    if isinstance(info, msgspec.inspect.UnionType):
        return next(kind for kind in info.types if isinstance(kind, msgspec.inspect.StructType))
    return info


def _read(path: Path, what: str) -> str:
    if not path.is_file():
        others = [p.name for p in path.parent.glob("*") if p.suffix in SUFFIXES] if path.parent.is_dir() else []
        raise TutorialError(f"there is no {what} {str(path)!r}.{did_you_mean(path.name, others) if others else ''}")
    try:
        return path.read_text(encoding="utf-8")
    except UnicodeDecodeError as error:
        raise TutorialError(f"{path}: this is not a text file in UTF-8: {error}") from error
    except OSError as error:
        raise TutorialError(f"{path} cannot be read: {error.strerror}.") from error
