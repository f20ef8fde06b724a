"""Message classes made on import from recorded definitions, where ROS 2 generates them at build time (rosidl)."""
