"""Joint states with faults, such as those that a network or a careless or hostile program can cause.

`faults` injects the faults and does not need ROS 2; `stream` publishes the faulty messages.
"""

from tutorial.ros.chaos.faults import FAULTS, Action, Chaos, parse_fault

__all__ = ["FAULTS", "Action", "Chaos", "parse_fault"]
