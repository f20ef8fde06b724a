"""Exercises of step 3: match joints by name, show what another program publishes, and keep up with it."""

from tutorial.checks.by_name import by_name
from tutorial.checks.keep_up import CalmViewer, keep_up
from tutorial.checks.show import MyViewer, show

__all__ = ["CalmViewer", "MyViewer", "by_name", "keep_up", "show"]
