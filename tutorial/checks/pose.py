"""Exercises of step 7: transform a point from frame to frame, and match messages from the same moment."""

from tutorial.checks.pair import pair
from tutorial.checks.where import where

__all__ = ["where", "pair"]  # noqa: RUF022 - in the notebook's order
