"""Stands where msgspec is, of which the pocket ROS 2 asks for one thing, for Cyclone DDS's sake."""


def defstruct(_name: str, _fields: list[str]) -> type:
    """Return what nobody calls."""
    return object
