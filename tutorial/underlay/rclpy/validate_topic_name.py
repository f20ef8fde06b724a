"""Check a topic name."""

from rclpy import _validation
from rclpy.exceptions import InvalidTopicNameException

__all__ = ["validate_topic_name"]


def validate_topic_name(topic_name: str) -> bool:
    """Return True if the topic name is valid.

    Raises:
        InvalidTopicNameException: it isn't; the text points at the place.
    """
    if problem := _validation.topic_name(topic_name):
        raise InvalidTopicNameException(topic_name, *problem)
    return True
