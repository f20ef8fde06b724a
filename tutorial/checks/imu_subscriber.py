"""The exercise of step 5: a timer on the main thread, and state that lives as long as the controller."""

from tutorial.checks.hop import hop

__all__ = ["hop"]
