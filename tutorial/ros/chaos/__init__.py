"""Joint states with faults, such as those that a network or a careless or hostile program can cause.

`faults` defines the faults, without ROS 2; `stream` publishes them.
"""

from tutorial.ros.chaos.faults import FAULTS, Action, Chaos, parse_fault

__all__ = ["FAULTS", "Action", "Chaos", "parse_fault"]
