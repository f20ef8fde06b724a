"""Check a parameter's name."""

from rclpy.exceptions import InvalidParameterException


def validate_parameter_name(name: str) -> bool:
    """Return True if a parameter's name is valid, else raise InvalidParameterException: it must not be empty."""
    if not name:
        raise InvalidParameterException(name)
    return True
