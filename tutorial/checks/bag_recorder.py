"""The exercise of step 8: find in a bag where a stream was interrupted."""

from tutorial.checks.gaps import gaps

__all__ = ["gaps"]
