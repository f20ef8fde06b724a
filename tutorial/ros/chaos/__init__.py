"""Joint states with faults in them: what a network, a careless program or a hostile one may send.

`faults` knows which faults there are, and no ROS 2; `stream` publishes them.
"""

from tutorial.ros.chaos.faults import FAULTS, Action, Chaos, parse_fault

__all__ = ["FAULTS", "Action", "Chaos", "parse_fault"]
