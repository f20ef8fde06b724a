"""YAML files that people write by hand: read, checked against a schema, and wrong with a line number."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Any

import jsonschema
import yaml

from tutorial.errors import TutorialError, did_you_mean

__all__ = ["YamlFile"]

SUFFIXES = (".yaml", ".yml")


class YamlFile:
    """One YAML file that matches a schema.

    Args:
        path: where it is.
        schema: what it has to look like, as a JSON schema.
        what: what the file is, as it should appear in errors, for instance ``"project"``.

    Attributes:
        path: as given.
        data: the file's content, made of dicts, lists, strings and numbers.

    Raises:
        TutorialError: there is no such file, it is no YAML, or it doesn't match; the text names the line and the mend.
    """

    def __init__(self, path: Path, schema: dict[str, Any], what: str) -> None:
        self.path = path
        self._root = self._compose(_read(path, what))
        self.data: Any = yaml.SafeLoader.construct_document(yaml.SafeLoader(""), self._root)
        errors = list(jsonschema.Draft202012Validator(schema).iter_errors(self.data))
        if errors:  # a mistyped key explains why the right one is missing, so it comes first
            mistyped = [error for error in errors if error.validator == "additionalProperties"]
            raise self._explain(mistyped[0] if mistyped else jsonschema.exceptions.best_match(errors))

    def error(self, where: Iterable[str | int], text: str) -> TutorialError:
        """Make an error about one place in the file.

        Args:
            where: the keys and indices that lead to the place.
            text: what is wrong there, and the mend.
        """
        return TutorialError(f"{self.path}, line {self._line(where)}: {text}")

    def _compose(self, text: str) -> yaml.Node:
        try:
            root = yaml.compose(text, Loader=yaml.SafeLoader)
        except yaml.MarkedYAMLError as error:
            line = error.problem_mark.line + 1 if error.problem_mark else 1
            problem = " ".join(filter(None, (error.context, error.problem)))
            raise TutorialError(f"{self.path}, line {line}: this is not YAML: {problem}.") from error
        except yaml.YAMLError as error:
            raise TutorialError(f"{self.path}, line 1: this is not YAML: {error}") from error
        if root is None:
            raise TutorialError(f"{self.path}, line 1: the file is empty.")
        return root

    def _line(self, where: Iterable[str | int]) -> int:
        node = self._root
        for step in where:
            if isinstance(node, yaml.MappingNode):
                node = next(value for key, value in node.value if key.value == step)
            elif isinstance(node, yaml.SequenceNode) and isinstance(step, int):
                node = node.value[step]
        return int(node.start_mark.line) + 1

    def _explain(self, error: jsonschema.ValidationError) -> TutorialError:
        where = list(error.absolute_path)
        schema: Any = error.schema
        instance: Any = error.instance
        if error.validator == "additionalProperties":
            known = schema["properties"]
            key = next(key for key in instance if key not in known)
            line = self._key_line(where, key)
            return TutorialError(f"{self.path}, line {line}: {key!r} is not known here.{did_you_mean(str(key), known)}")
        place = "".join(f"[{step}]" if isinstance(step, int) else f" {step}" for step in where).strip()
        mend = schema.get("description")
        text = f"{place}: {error.message}." if place else f"{error.message}."
        return self.error(where, text + (f" Expected is {mend}." if mend else ""))

    def _key_line(self, where: Sequence[str | int], key: object) -> int:
        node = self._root
        for step in where:
            node = node.value[step] if isinstance(step, int) else {k.value: v for k, v in node.value}[step]
        return next(int(k.start_mark.line) + 1 for k, _ in node.value if k.value == str(key))


def _read(path: Path, what: str) -> str:
    if not path.is_file():
        others = [p.name for p in path.parent.glob("*") if p.suffix in SUFFIXES] if path.parent.is_dir() else []
        raise TutorialError(f"there is no {what} {str(path)!r}.{did_you_mean(path.name, others) if others else ''}")
    try:
        return path.read_text(encoding="utf-8")
    except UnicodeDecodeError as error:
        raise TutorialError(f"{path}: this is not a text file in UTF-8: {error}") from error
