"""Exercises of step 2: publish joint states, and publish only changes."""

from tutorial.checks.publish import publish
from tutorial.checks.thrift import thrift

__all__ = ["publish", "thrift"]
