"""The exercise of step 4: publish averages of a sensor's measurements."""

from tutorial.checks.gyro import gyro

__all__ = ["gyro"]
