# %% a node's own remappings come first
rclpy.init(args=["--ros-args", "-r", "x:=everybody"])
n = rclpy.create_node("t", cli_args=["--ros-args", "-r", "x:=own"])
print(n.resolve_topic_name("x"))

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

# %% several unknown arguments
rclpy.init(args=["--ros-args", "--loud", "-x", "--", "mine"])

# %% ROS arguments end at --
rclpy.init(args=["--ros-args", "-r", "x:=y", "--", "-r", "mine"])
n = rclpy.create_node("t")
print(n.resolve_topic_name("x"))

# %% ROS arguments in two places
rclpy.init(args=["--ros-args", "-r", "x:=y", "--", "mine", "--ros-args", "-r", "z:=w"])
n = rclpy.create_node("t")
print(n.resolve_topic_name("x"), n.resolve_topic_name("z"))

# %% a log level in capitals
rclpy.init(args=["--ros-args", "--log-level", "arguments_capitals:=DEBUG"])
logger = logging.get_logger("arguments_capitals")
print(logger.get_effective_level().name, logger.debug("shown"))

# %% kinds of parameters on the command line
n = start(
    *(
        word
        for index, text in enumerate(("1e3", "yes", "'1'", "0x10", "-.5", "1.", "~", "a b"))
        for word in ("-p", f"p{index}:={text}")
    )
)
for index in range(8):
    print(repr(n.declare_parameter(f"p{index}", descriptor=ParameterDescriptor(dynamic_typing=True)).value))

# %% lists of parameters on the command line
n = start("-p", "a:=[a, b]", "-p", "b:=[1.0, 2.5]", "-p", "c:=[true, no]")
for name in "abc":
    print(n.declare_parameter(name, descriptor=ParameterDescriptor(dynamic_typing=True)).value)

# %% a parameter for one node
n = start("-p", "u:a:=1", "-p", "b:=2")
m = rclpy.create_node("u")
print([[node.declare_parameter(name, 0).value for name in "ab"] for node in (n, m)])

# %% remappings and parameters of one node
rclpy.init(args=["--ros-args", "-r", "one:__node:=first", "-r", "two:x:=y", "-r", "two/x:=/z", "-p", "b:=2"])
n, m = rclpy.create_node("one"), rclpy.create_node("two")
o = rclpy.create_node("own", cli_args=["--ros-args", "-r", "__ns:=/o", "-r", "x:=w"])
p = rclpy.create_node("one", use_global_arguments=False)
print([(node.get_name(), node.resolve_topic_name("x"), node.declare_parameter("b", 0).value) for node in (n, m, o, p)])
print(m.resolve_topic_name("two/x"), m.resolve_topic_name("x", only_expand=True))
