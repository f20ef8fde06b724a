"""Stands where numpy is, which is not in the page. Messages need it for fields with a fixed number of values alone."""

from typing import Any, NoReturn

WHY = "numpy is not in this page. On your own computer the course has it: make lab"


class ndarray:  # noqa: N801  (numpy's name)
    """What nothing in the page is."""


def frombuffer(*_: object) -> NoReturn:
    """Say that it is not there."""
    raise ImportError(WHY)


def __getattr__(name: str) -> Any:
    if name.startswith("__"):
        raise AttributeError(name)
    raise ImportError(WHY)
