"""Check a node name."""

from rclpy import _validation
from rclpy.exceptions import InvalidNodeNameException

__all__ = ["validate_node_name"]


def validate_node_name(node_name: str) -> bool:
    """Return True if the node name is valid.

    Raises:
        InvalidNodeNameException: it isn't; the text points at the place.
    """
    if problem := _validation.node_name(node_name):
        raise InvalidNodeNameException(node_name, *problem)
    return True
