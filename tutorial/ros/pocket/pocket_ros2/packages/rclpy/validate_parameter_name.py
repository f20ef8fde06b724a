"""Check a parameter's name."""

from rclpy.exceptions import InvalidParameterException


def validate_parameter_name(name: str) -> bool:
    """Return True if a parameter's name is valid (not empty); otherwise raise InvalidParameterException."""
    if not name:
        raise InvalidParameterException(name)
    return True
