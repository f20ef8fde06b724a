"""Replace msgspec: the pocket ROS 2 uses one function of it, for Cyclone DDS."""


def defstruct(_name: str, _fields: list[str]) -> type:
    """Return a placeholder that is never called."""
    return object
