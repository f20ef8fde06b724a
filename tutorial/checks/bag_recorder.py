"""Exercises of step 8: find interruptions in a recorded stream, and write a bag on a separate thread."""

from tutorial.checks.gaps import gaps
from tutorial.checks.record import record

__all__ = ["gaps", "record"]
