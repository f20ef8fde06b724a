"""Exercises of step 8: a thread that writes, and where a stream in a bag was interrupted."""

from tutorial.checks.gaps import gaps
from tutorial.checks.record import record

__all__ = ["record", "gaps"]  # noqa: RUF022 - in the notebook's order
