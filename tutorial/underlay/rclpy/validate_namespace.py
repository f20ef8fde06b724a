"""Check a namespace."""

from rclpy import _validation
from rclpy.exceptions import InvalidNamespaceException

__all__ = ["validate_namespace"]


def validate_namespace(namespace: str) -> bool:
    """Return True if the namespace is valid.

    Raises:
        InvalidNamespaceException: it isn't; the text points at the place.
    """
    if problem := _validation.namespace(namespace):
        raise InvalidNamespaceException(namespace, *problem)
    return True
