# %% a start counts once
import os

rclpy.init(args=[])
attempt(rclpy.init, args=[])
print(rclpy.ok())
print(rclpy.get_default_context().get_domain_id() == int(os.environ["ROS_DOMAIN_ID"]))

# %% a context is started once
c = Context()
c.init(args=[])
attempt(c.init, args=[])
c.shutdown()
attempt(c.init, args=[])
attempt(c.shutdown)
print(c.try_shutdown(), c.ok())

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

# %% a node of another context in the global executor
c = Context()
c.init(args=[])
rclpy.init(args=[])
m = Node("m", context=c)
m.create_timer(0.0, lambda: print("called"))
rclpy.spin_once(m, timeout_sec=1.0)

# %% a context that fails within
c = Context()
try:
    with c:
        raise ValueError("mine")
except ValueError as error:
    print(repr(error), c.ok())

# %% what init returns
print(rclpy.init(args=[]), rclpy.shutdown())

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


# %% a context calls back at its shutdown, but no method of what is gone
class Caller:
    def __init__(self, name):
        self.name = name

    def call(self):
        print(self.name)


c, kept = Context(), Caller("a method")
attempt(c.on_shutdown, 3)
c.on_shutdown(kept.call)
c.try_shutdown()
c.init(args=[])
c.on_shutdown(lambda: print("a function"))
c.on_shutdown(Caller("a method of what is gone").call)
print("running")
c.shutdown()
c.try_shutdown()
c.on_shutdown(kept.call)

# %% a failing callback is an error of the shutdown
c = Context()
c.init(args=[])
c.on_shutdown(lambda: 1 / 0)
attempt(c.shutdown)
print(c.ok())
