# %% a bad name on the command line
rclpy.init(args=["--ros-args", "-r", "__node:=bad-name"])

# %% a bad topic on the command line
rclpy.init(args=["--ros-args", "-r", "x:=bad topic"])

# %% no remapping after -r
rclpy.init(args=["--ros-args", "-r"])

# %% no parameter after -p
rclpy.init(args=["--ros-args", "-p"])

# %% half a parameter
rclpy.init(args=["--ros-args", "-p", "a"])

# %% a log level that there is not
rclpy.init(args=["--ros-args", "--log-level", "loud"])

# %% a log level in capitals
rclpy.init(args=["--ros-args", "--log-level", "arguments_capitals:=DEBUG"])
logger = logging.get_logger("arguments_capitals")
print(logger.get_effective_level().name, logger.debug("shown"))
