"""What a cell shows that ends with a call whose ``await`` was left out."""

from __future__ import annotations

from types import CoroutineType
from typing import Any

from IPython.core.getipython import get_ipython

__all__ = ["explain_coroutines"]


def explain_coroutines() -> None:
    """Have a coroutine that a cell would display say what it lacks. Does nothing outside IPython."""
    shell = get_ipython()
    if shell is not None and shell.display_formatter is not None:
        shell.display_formatter.formatters["text/plain"].for_type(CoroutineType, _explain)


def _explain(coroutine: CoroutineType[Any, Any, Any], printer: Any, _cycle: bool) -> None:
    name = coroutine.__qualname__
    printer.text(f"{name} has not run yet: this takes a while, so write await before it.")
    coroutine.close()  # it cannot be awaited by its name any more; this keeps Python from complaining of it later
