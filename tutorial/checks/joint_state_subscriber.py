"""Exercises of step 3: match joints by name, show joint states from another program, and keep up with them."""

from tutorial.checks.by_name import by_name
from tutorial.checks.keep_up import CalmViewer, keep_up
from tutorial.checks.show import MyViewer, show

__all__ = ["by_name", "show", "keep_up", "CalmViewer", "MyViewer"]  # noqa: RUF022 - in the notebook's order
