"""Message classes made on import from recorded definitions: what ROS 2 generates at build time (rosidl)."""
