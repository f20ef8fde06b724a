"""Message classes, created from recorded definitions on import; in ROS 2, rosidl generates them at build time."""
