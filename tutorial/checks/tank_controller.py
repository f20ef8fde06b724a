"""Exercises of step 1: read a button, read axes from any message, hold a joint, drive, and stop."""

from tutorial.checks.aim import aim
from tutorial.checks.bound import bound
from tutorial.checks.drive import drive
from tutorial.checks.fire import fire
from tutorial.checks.timeout import timeout

__all__ = ["fire", "bound", "aim", "drive", "timeout"]  # noqa: RUF022 - in the notebook's order
