"""The exercise of step 6: publish gray pictures."""

from tutorial.checks.gray import gray

__all__ = ["gray"]
