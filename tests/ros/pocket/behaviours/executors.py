n = start()

# %% a node is added twice
e = SingleThreadedExecutor()
print(e.add_node(n), e.add_node(n), e.get_nodes() == [n])

# %% a node is removed twice
e = SingleThreadedExecutor()
e.add_node(n)
print(e.remove_node(n), e.remove_node(n), e.get_nodes())

# %% an executor shut down twice
e = SingleThreadedExecutor()
print(e.shutdown(), e.shutdown(), e.shutdown(timeout_sec=1.0))

# %% an executor that has been shut down does not spin
e = SingleThreadedExecutor()
e.add_node(n)
n.create_timer(0.0, lambda: print("called"))
e.shutdown()
print(e.spin_once(timeout_sec=0.01), e.spin())

# %% an executor as a context manager
with SingleThreadedExecutor() as e:
    print(type(e).__name__, e.add_node(n), len(e.get_nodes()))
print(e.get_nodes())

# %% an executor's context
e = SingleThreadedExecutor()
print(e.context is rclpy.get_default_context())

# %% a shutdown in a callback ends the spin
n.create_timer(0.0, rclpy.shutdown)
attempt(rclpy.spin, n)
print(rclpy.ok())

# %% a shutdown of the executor in a callback ends its spin
e = SingleThreadedExecutor()
e.add_node(n)
n.create_timer(0.0, e.shutdown)
print(e.spin(), rclpy.ok())

# %% a node destroyed in a callback
calls = []
n.create_timer(0.0, lambda: calls.append(n.destroy_node()))
for _ in range(3):
    rclpy.spin_once(n, timeout_sec=0.01)
print(calls)

# %% callbacks run on the thread that spins
threads = []
n.create_timer(0.0, lambda: threads.append(threading.current_thread()))
thread = threading.Thread(target=rclpy.spin_once, args=(n,), kwargs={"timeout_sec": 1.0})
thread.start()
thread.join(30)
print(threads == [thread])

# %% spinning needs a node
attempt(rclpy.spin_once)
attempt(rclpy.spin_once, None, timeout_sec=0.0)

# %% spin_once with its own executor
e = SingleThreadedExecutor()
n.create_timer(0.0, lambda: print(n.executor is e))
rclpy.spin_once(n, executor=e, timeout_sec=1.0)
print(e.get_nodes())

# %% after spin_once the node has no executor any more
rclpy.spin_once(n, timeout_sec=0.0)
print(rclpy.get_global_executor().get_nodes())

# %% nodes share an executor
n, m = start(), rclpy.create_node("u")
e = SingleThreadedExecutor()
calls = set()
for node in (n, m):
    e.add_node(node)
    node.create_timer(0.0, partial(calls.add, node.get_name()))
while len(calls) < 2:
    e.spin_once(timeout_sec=1.0)
print(sorted(calls), sorted(node.get_name() for node in e.get_nodes()))

# %% a future that is done ends the spin
f = Future()
n.create_timer(0.0, lambda: f.set_result("done"))
print(rclpy.spin_until_future_complete(n, f, timeout_sec=10.0), f.result())

# %% a future that was done before
f = Future()
f.set_result(1)
n.create_timer(0.0, lambda: print("called"))
rclpy.spin_until_future_complete(n, f, timeout_sec=10.0)
print(f.result())

# %% a future that fails
f = Future()
n.create_timer(0.0, lambda: f.set_exception(ValueError("mine")))
rclpy.spin_until_future_complete(n, f, timeout_sec=10.0)
attempt(f.result)

# %% a node and entities come and go while another thread spins
e = SingleThreadedExecutor()
thread = threading.Thread(target=e.spin)
thread.start()
called, again, got = (threading.Event() for _ in range(3))
t = n.create_timer(0.01, called.set)
print(e.add_node(n), called.wait(30), n.destroy_timer(t))
n.create_timer(0.0, again.set)
print(again.wait(30))
n.create_subscription(String, "x", lambda message: got.set(), 1)
p = n.create_publisher(String, "x", 1)
p.publish(String())
print(got.wait(30), n.destroy_publisher(p))
e.shutdown()
thread.join(30)
print(thread.is_alive())
