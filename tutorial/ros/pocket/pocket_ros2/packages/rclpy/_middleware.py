"""The middleware in use. The book's ``drive`` page replaces this module with a different one."""

try:
    from rclpy._cyclone import TransportError, decode_nodes, encode_nodes, join
except ImportError as error:
    if not (error.name or "").startswith("cyclonedds"):
        raise
    raise ImportError(
        "The pocket ROS 2 needs the package cyclonedds, which is not installed. If pip cannot find it (Linux on ARM), "
        "use a real ROS 2 Jazzy: https://docs.ros.org/en/jazzy/Installation.html"
    ) from error

__all__ = ["TransportError", "decode_nodes", "encode_nodes", "join"]
