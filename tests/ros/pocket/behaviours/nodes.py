n = start()

# %% two nodes of one name
n, m = start(enable_rosout=False), rclpy.create_node("t", enable_rosout=False)
print(n.get_name() == m.get_name(), n == m)
n.destroy_node()
print(m.get_name())

# %% a node after the shutdown tells its name
n = start(namespace="/Tank")
rclpy.shutdown()
print(n.get_name(), n.get_namespace(), n.get_logger().name)

# %% a node after the shutdown makes nothing
rclpy.shutdown()
attempt(n.create_publisher, String, "x", 1)
attempt(n.create_subscription, String, "x", print, 1)

# %% a timer after the shutdown
rclpy.shutdown()
n.create_timer(1.0, print)

# %% a node after the shutdown can be destroyed
p = n.create_publisher(String, "x", 1)
rclpy.shutdown()
print(n.destroy_publisher(p), n.destroy_node(), n.destroy_node())

# %% no node with a context that has been shut down
c = Context()
c.init(args=[])
c.shutdown()
Node("t", context=c)

# %% a node as a context manager
with rclpy.create_node("u") as n:
    print(n.get_name())
attempt(n.get_name)


# %% executors of a node
print(n.executor)
e, f = SingleThreadedExecutor(), SingleThreadedExecutor()
n.executor = e
print(n.executor is e, e.get_nodes() == [n])
n.executor = f
print(n.executor is f, e.get_nodes(), f.get_nodes() == [n])
print(e.add_node(n), n.executor is e, f.get_nodes())

# %% the executor of a node is given up
e = SingleThreadedExecutor()
e.add_node(n)
n.executor = None
print(n.executor, e.get_nodes())

# %% a node without rosout
n = start(enable_rosout=False)
topics = []
while not topics:
    with suppress(RuntimeError):  # the node does not know of itself yet
        topics = [topic for topic, _ in n.get_publisher_names_and_types_by_node("t", "/")]
print(topics)

# %% topics of nodes that are not there
try:
    n.get_publisher_names_and_types_by_node("nobody", "/")
except Exception as error:
    print(type(error).__name__, isinstance(error, RuntimeError))

# %% parts of a node that cannot be replaced
for part in ("publishers", "subscriptions", "timers", "context"):
    attempt(setattr, n, part, None)

# %% publishers of a node are asked for anew
n = start(enable_rosout=False)
publishers = n.publishers
p = n.create_publisher(String, "x", 1)
print(p in n.publishers, iter(n.publishers) is n.publishers)

# %% the order of a node's entities
for topic in ("c", "a", "b"):
    n.create_subscription(String, topic, print, 1)
print([subscription.topic_name for subscription in n.subscriptions])
