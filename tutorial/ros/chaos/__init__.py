"""Joint states with faults in them: what a network, a careless program or a hostile one may send.

`faults` knows which faults there are, `script` when, and `stream` publishes them. The first two know no ROS 2.
"""

from tutorial.ros.chaos.faults import FAULTS, Action, Chaos, parse_fault, share_of

__all__ = ["FAULTS", "Action", "Chaos", "parse_fault", "share_of"]
