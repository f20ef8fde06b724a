"""The exercise of step 6: publish gray images."""

from tutorial.checks.gray import gray

__all__ = ["gray"]
