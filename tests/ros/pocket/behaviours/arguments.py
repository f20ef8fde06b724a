# %% a bad name on the command line
rclpy.init(args=["--ros-args", "-r", "__node:=bad-name"])

# %% a bad topic on the command line
rclpy.init(args=["--ros-args", "-r", "x:=bad topic"])

# %% no remapping after -r
rclpy.init(args=["--ros-args", "-r"])

# %% no parameter after -p
rclpy.init(args=["--ros-args", "-p"])

# %% an incomplete parameter
rclpy.init(args=["--ros-args", "-p", "a"])

# %% an unknown log level
rclpy.init(args=["--ros-args", "--log-level", "loud"])

# %% a log level in capital letters
rclpy.init(args=["--ros-args", "--log-level", "arguments_capitals:=DEBUG"])
logger = logging.get_logger("arguments_capitals")
print(logger.get_effective_level().name, logger.debug("shown"))

# %% no value after other flags
for flag in ("-e", "--log-config-file", "--log-file-name", "--log-level"):
    attempt(Context().init, ["--ros-args", flag])

# %% a log configuration file that is ignored
c = Context()
c.init(["--ros-args", "--log-config-file", "x"], initialize_logging=False)
print(c.ok(), Node("t", context=c, cli_args=["--ros-args", "--log-config-file", "x"]).get_name())

# %% no logs on stdout
n = start("--disable-stdout-logs")
print(n.get_logger().info("hidden"))
rclpy.create_node("u").get_logger().warning("hidden, too")
rclpy.shutdown()
n.get_logger().info("shown after the shutdown")
start().get_logger().info("shown in the next start")

# %% logs on stdout again
start("--disable-stdout-logs", "--enable-stdout-logs").get_logger().info("shown")

# %% no logs of a single node
n = rclpy.create_node("t", cli_args=["--ros-args", "--disable-stdout-logs"]) if rclpy.init(args=[]) is None else None
n.get_logger().info("shown")
