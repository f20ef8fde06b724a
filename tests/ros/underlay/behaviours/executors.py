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

# %% an executor of another context
with Context() as c:
    n = Node("u", context=c)
    e = SingleThreadedExecutor(context=c)
    e.add_node(n)
    n.create_timer(0.0, lambda: print("called"))
    e.spin_once(timeout_sec=1.0)
    print(e.context is c, rclpy.ok())
    e.shutdown()

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


# %% a thread that spins ends at the shutdown
def work():
    with suppress(Exception):  # of one kind or another, or none
        rclpy.spin(n)


spinning = threading.Event()
n.create_timer(0.0, spinning.set)
thread = threading.Thread(target=work)
thread.start()
print(spinning.wait(30))
rclpy.shutdown()
thread.join(30)
print(thread.is_alive(), rclpy.ok())

# %% a thread that spins ends at the executor's shutdown
e = SingleThreadedExecutor()
e.add_node(n)
spinning = threading.Event()
n.create_timer(0.01, spinning.set)
thread = threading.Thread(target=e.spin)
thread.start()
spinning.wait(30)
print(e.shutdown())
thread.join(30)
print(thread.is_alive(), rclpy.ok())

# %% a subscription is destroyed while another thread spins
e = SingleThreadedExecutor()
e.add_node(n)
first, second = threading.Event(), threading.Event()
s = n.create_subscription(String, "x", lambda message: first.set(), 10)
n.create_subscription(Int32, "y", lambda message: second.set(), 10)
p, q = n.create_publisher(String, "x", 10), n.create_publisher(Int32, "y", 10)
thread = threading.Thread(target=e.spin)
thread.start()
p.publish(String())
print(first.wait(30), n.destroy_subscription(s))
q.publish(Int32())
print(second.wait(30))
e.shutdown()
thread.join(30)
print(thread.is_alive())

# %% callbacks run on the thread that spins
threads = []
n.create_timer(0.0, lambda: threads.append(threading.current_thread()))
thread = threading.Thread(target=rclpy.spin_once, args=(n,), kwargs={"timeout_sec": 1.0})
thread.start()
thread.join(30)
print(threads == [thread])

# %% a message from another thread
got = []
n.create_subscription(String, "x", lambda message: got.append(message.data), 10)
p = n.create_publisher(String, "x", 10)
thread = threading.Thread(target=lambda: [p.publish(String(data=str(number))) for number in range(3)])
thread.start()
thread.join(30)
while len(got) < 3:
    rclpy.spin_once(n, timeout_sec=0.1)
print(got)

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

# %% one turn calls one callback
calls = []
for name in "abc":
    n.create_timer(0.0, partial(calls.append, name))
rclpy.spin_once(n, timeout_sec=1.0)
print(len(calls))

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

# %% a future from another thread
f = Future()
thread = threading.Thread(target=f.set_result, args=("from there",))
thread.start()
rclpy.spin_until_future_complete(n, f, timeout_sec=10.0)
thread.join(30)
print(f.result())

# %% a future in no time
f = Future()
rclpy.spin_until_future_complete(n, f, timeout_sec=0.0)
print(f.done())

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
