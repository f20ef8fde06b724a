"""The exercises of step 9: find out why nothing arrives, and connect two incompatible programs."""

from tutorial.checks.find_cause import find_cause
from tutorial.checks.reach import reach

__all__ = ["find_cause", "reach"]
