"""Replace numpy, which the page does not have. Messages only need it for fields with a fixed number of values."""

from typing import Any, NoReturn

WHY = "numpy is not in this page. On your own computer the course has it: make lab"


class ndarray:  # noqa: N801  (numpy's name)
    """An array. No object in the page is one."""


def frombuffer(*_: object) -> NoReturn:
    """Report that numpy is missing."""
    raise ImportError(WHY)


def __getattr__(name: str) -> Any:
    if name.startswith("__"):
        raise AttributeError(name)
    raise ImportError(WHY)
