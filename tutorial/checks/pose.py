"""The exercises of step 7: from one frame to the next, and two messages of one moment."""

from tutorial.checks.pair import pair
from tutorial.checks.where import where

__all__ = ["where", "pair"]  # noqa: RUF022 - in the notebook's order
