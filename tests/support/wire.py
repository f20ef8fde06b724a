"""Messages of ROS 2 as Cyclone DDS alone has them: their types on the wire, made without anything of ROS 2."""

from __future__ import annotations

from typing import Any

from cyclonedds.idl import make_idl_struct, types


def struct(name: str, /, **fields: Any) -> Any:
    """A wire type; it has an array of octets under the name that the pocket ROS 2 gives it."""
    package, _, short = name.split("/")
    made = make_idl_struct(f"{short}_", f"{package}::msg::dds_::{short}_", fields)
    made.__idl__.populate()
    return made


STRING = struct("std_msgs/msg/String", data=str)
TIME = struct("builtin_interfaces/msg/Time", sec=types.int32, nanosec=types.uint32)
HEADER = struct("std_msgs/msg/Header", stamp=TIME, frame_id=str)
NUMBERS = types.sequence[types.float64]
JOINT_STATE = struct(
    "sensor_msgs/msg/JointState",
    header=HEADER,
    name=types.sequence[str],
    position=NUMBERS,
    velocity=NUMBERS,
    effort=NUMBERS,
)
