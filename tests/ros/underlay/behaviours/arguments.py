# %% a node's name and namespace are remapped
n = start("-r", "__node:=viewer", "-r", "__ns:=/lab")
print(n.get_fully_qualified_name(), n.get_logger().name)

# %% __name is __node
n = start("-r", "__name:=viewer")
print(n.get_name())

# %% only one node is remapped
n = start("-r", "u:__node:=viewer")
print(n.get_name(), rclpy.create_node("u").get_name())

# %% of two remappings the first counts
n = start("-r", "x:=a", "-r", "x:=b", "-r", "__node:=first", "-r", "__node:=second")
print(n.resolve_topic_name("x"), n.get_name())

# %% remappings do not chain
n = start("-r", "x:=y", "-r", "y:=z")
print(n.resolve_topic_name("x"), n.resolve_topic_name("y"))

# %% the long name of -r
n = start("--remap", "x:=y")
print(n.resolve_topic_name("x"))

# %% remappings of relative, absolute and private names
n = start("-r", "a:=/b", "-r", "/c:=d", "-r", "~/e:=f", "-r", "g:=~/h", namespace="/Tank")
print([n.resolve_topic_name(name) for name in ("a", "/Tank/a", "/a", "/c", "c", "~/e", "/Tank/t/e", "g")])

# %% a node's own remappings come first
rclpy.init(args=["--ros-args", "-r", "x:=everybody"])
n = rclpy.create_node("t", cli_args=["--ros-args", "-r", "x:=own"])
print(n.resolve_topic_name("x"))

# %% the namespace of the command line wins
n = start("-r", "__ns:=/line", namespace="/program")
print(n.get_namespace(), n.resolve_topic_name("x"))

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

# %% unknown arguments before --ros-args are the program's
rclpy.init(args=["program", "--loud", "-r", "x", "--ros-args", "-r", "y:=z"])
print(rclpy.create_node("t").resolve_topic_name("y"))

# %% ROS arguments end at --
rclpy.init(args=["--ros-args", "-r", "x:=y", "--", "-r", "mine"])
n = rclpy.create_node("t")
print(n.resolve_topic_name("x"))

# %% ROS arguments in two places
rclpy.init(args=["--ros-args", "-r", "x:=y", "--", "mine", "--ros-args", "-r", "z:=w"])
n = rclpy.create_node("t")
print(n.resolve_topic_name("x"), n.resolve_topic_name("z"))

# %% a node's unknown arguments
rclpy.init(args=[])
rclpy.create_node("t", cli_args=["--ros-args", "--loud"])

# %% what is left of a command line
print(remove_ros_args([]))
print(remove_ros_args(["p", "--ros-args"]))
print(remove_ros_args(["p", "a", "--ros-args", "-r", "x:=y"]))
print(remove_ros_args(["p", "--ros-args", "-p", "a:=1", "--", "b", "--ros-args", "--", "c"]))
print(remove_ros_args(["p", "--", "a"]))

# %% a log level for all
n = start("--log-level", "arguments_all:=warn")
print(logging.get_logger("arguments_all").get_effective_level().name)

# %% a log level in capitals
rclpy.init(args=["--ros-args", "--log-level", "arguments_capitals:=DEBUG"])
logger = logging.get_logger("arguments_capitals")
print(logger.get_effective_level().name, logger.debug("shown"))

# %% a log level for one logger
n = start("--log-level", "arguments_one:=error", name="arguments_one")
print(n.get_logger().warn("hidden"), n.get_logger().error("shown"))

# %% parameters on the command line
n = start("-p", "i:=3", "-p", "f:=0.5", "-p", "b:=true", "-p", "s:=text", "-p", "l:=[1, 2]")
for name, default in (("i", 0), ("f", 0.0), ("b", False), ("s", ""), ("l", [0])):
    print(repr(n.declare_parameter(name, default).value))

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

# %% of two parameters the last counts
n = start("-p", "a:=1", "-p", "a:=2")
print(n.declare_parameter("a", 0).value)

# %% a parameter of another type on the command line
n = start("-p", "a:=text")
attempt(n.declare_parameter, "a", 1)
print(n.has_parameter("a"))

# %% an integer is no double on the command line
n = start("-p", "a:=1")
n.declare_parameter("a", 0.5)

# %% a parameter of the command line is not declared by it
n = start("-p", "a:=1")
print(n.has_parameter("a"), n.get_parameter_or("a").value)

# %% the command line is ignored
n = start("-p", "a:=1")
print(n.declare_parameter("a", 5, ignore_override=True).value)

# %% the program's overrides win over the command line
n = start("-p", "a:=1", parameter_overrides=[Parameter("a", value=2)])
print(n.declare_parameter("a", 0).value)

# %% switches of the log
n = start("--disable-rosout-logs", "--enable-stdout-logs", "--disable-external-lib-logs")
print(n.get_name())

# %% an enclave
n = start("-e", "/here")
print(n.get_name())
