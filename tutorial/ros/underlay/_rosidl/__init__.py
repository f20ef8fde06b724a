"""Message classes made on import from rosbags' definitions: what ROS 2 generates at build time (rosidl)."""
