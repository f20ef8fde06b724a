"""Exercises of step 8: where a stream in a bag was interrupted, and a thread that writes."""

from tutorial.checks.gaps import gaps
from tutorial.checks.record import record

__all__ = ["gaps", "record"]
