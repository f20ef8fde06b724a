"""Joint states with faults: what a network, or a careless or hostile program, can send.

`faults` defines the faults, without ROS 2; `stream` publishes them.
"""

from tutorial.ros.chaos.faults import FAULTS, Action, Chaos, parse_fault

__all__ = ["FAULTS", "Action", "Chaos", "parse_fault"]
