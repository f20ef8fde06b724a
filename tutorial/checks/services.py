"""The exercises of step 10. They need a real ROS 2."""

from tutorial.checks.answer import AngleServer, answer
from tutorial.checks.ask import PitCrew, ask
from tutorial.checks.tune import TrackLimits, tune

__all__ = ["answer", "ask", "tune", "AngleServer", "PitCrew", "TrackLimits"]  # noqa: RUF022 - in the notebook's order
