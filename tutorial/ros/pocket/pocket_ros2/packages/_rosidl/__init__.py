"""Message classes, made from recorded definitions on import; ROS 2 generates them at build time (rosidl)."""
