# %% a start counts once
import os

rclpy.init(args=[])
attempt(rclpy.init, args=[])
print(rclpy.ok())
print(rclpy.get_default_context().get_domain_id() == int(os.environ["ROS_DOMAIN_ID"]))

# %% a shutdown counts once
rclpy.init(args=[])
rclpy.shutdown()
attempt(rclpy.shutdown)
rclpy.try_shutdown()
print(rclpy.ok())

# %% a context is started once
c = Context()
c.init(args=[])
attempt(c.init, args=[])
c.shutdown()
attempt(c.init, args=[])
attempt(c.shutdown)
print(c.try_shutdown(), c.ok())

# %% a context that was not started
c = Context()
attempt(c.shutdown)
print(c.try_shutdown(), c.ok())
attempt(c.get_domain_id)

# %% the default context is a new one after a shutdown
c = rclpy.get_default_context()
print(c is rclpy.get_default_context())
rclpy.init(args=[])
print(c is rclpy.get_default_context())
rclpy.shutdown()
print(c is rclpy.get_default_context(), c.ok())

# %% the default context is not that of others
c = Context()
rclpy.init(args=[], context=c)
print(rclpy.ok(), rclpy.ok(context=c), c is rclpy.get_default_context())
rclpy.shutdown(context=c)
print(rclpy.ok(context=c))

# %% one context ends, the other goes on
c = Context()
c.init(args=[])
n = start()
m = Node("m", context=c)
c.shutdown()
attempt(m.create_publisher, String, "x", 1)
print(n.create_publisher(String, "x", 1).topic_name, rclpy.ok(), c.ok())

# %% the default context ends, another one goes on
c = Context()
c.init(args=[])
rclpy.init(args=[])
rclpy.shutdown()
m = Node("m", context=c)
print(rclpy.ok(), c.ok(), m.get_name(), m.context is c)

# %% nodes of two contexts see each other
c = Context()
c.init(args=[])
n, m = start(), Node("m", context=c)
for node in (n, m):
    while {"t", "m"} - set(node.get_node_names()):
        pass
    print("sees both")

# %% messages go from one context to another
c = Context()
c.init(args=[])
n, m = start(), Node("m", context=c)
got = []
n.create_subscription(String, "x", lambda message: got.append(message.data), 1)
p = m.create_publisher(String, "x", QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL))
p.publish(String(data="hi"))
while p.get_subscription_count() < 1:
    rclpy.spin_once(n, timeout_sec=0.01)
p.publish(String(data="again"))
while "again" not in got:
    rclpy.spin_once(n, timeout_sec=0.1)
print(got[-1])

# %% a node of another context in the global executor
c = Context()
c.init(args=[])
rclpy.init(args=[])
m = Node("m", context=c)
m.create_timer(0.0, lambda: print("called"))
rclpy.spin_once(m, timeout_sec=1.0)

# %% a context as a context manager
with Context() as c:
    n = Node("t", context=c)
    print(c.ok(), n.get_name())
print(c.ok())
attempt(n.create_publisher, String, "x", 1)

# %% a context that fails within
c = Context()
try:
    with c:
        raise ValueError("mine")
except ValueError as error:
    print(repr(error), c.ok())

# %% what a shutdown calls back
c = Context()
calls = []
c.init(args=[])
print(c.on_shutdown(lambda: calls.append("called")))
c.shutdown()
print(calls)

# %% a shutdown calls back in the order of asking
c = Context()
calls = []


def first():
    calls.append("first")


def second():
    calls.append("second")


c.init(args=[])
c.on_shutdown(first)
c.on_shutdown(second)
c.shutdown()
c.try_shutdown()
print(calls)

# %% domains that there are not
attempt(rclpy.init, args=[], domain_id=-1)
attempt(Context().init, args=[], domain_id=-5)

# %% a context's domain
c = Context()
c.init(args=[], domain_id=7)
print(c.get_domain_id())

# %% arguments of init have to be named
attempt(rclpy.init, [], Context(), 3, 4, 5)

# %% what init returns
print(rclpy.init(args=[]), rclpy.shutdown())

# %% a shutdown of another context leaves the nodes of the default one
c = Context()
c.init(args=[])
n = start()
rclpy.shutdown(context=c)
attempt(rclpy.spin_once, n, timeout_sec=0.0)
print(rclpy.ok(), c.ok())

# %% the executor of a context that ends
c = Context()
c.init(args=[])
e = SingleThreadedExecutor(context=c)
c.shutdown()
attempt(e.spin_once, timeout_sec=0.0)
print(e.spin(), e.shutdown())
try:
    SingleThreadedExecutor(context=c)
except RuntimeError as error:
    print("the given context is not valid" in str(error))

# %% a new start after a shutdown
for number in range(3):
    n = start(name=f"n{number}")
    print(n.get_name(), rclpy.ok())
    n.destroy_node()
    rclpy.shutdown()
print(rclpy.ok())

# %% nodes of one context with their own arguments
rclpy.init(args=["--ros-args", "-r", "__ns:=/all"])
n = rclpy.create_node("a")
m = rclpy.create_node("b", cli_args=["--ros-args", "-r", "__ns:=/own"])
o = rclpy.create_node("c", use_global_arguments=False)
print([node.get_fully_qualified_name() for node in (n, m, o)])
