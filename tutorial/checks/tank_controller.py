"""Exercises of step 1: hear a button, read axes from anybody, hold a joint where the stick has put it, and drive."""

from tutorial.checks.aim import aim
from tutorial.checks.bound import bound
from tutorial.checks.drive import drive
from tutorial.checks.fire import fire

__all__ = ["fire", "bound", "aim", "drive"]  # noqa: RUF022 - in the notebook's order
