"""The exercise of step 4: publish means of what a sensor measures."""

from tutorial.checks.gyro import gyro

__all__ = ["gyro"]
