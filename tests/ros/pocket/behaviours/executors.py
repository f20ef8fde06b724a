n = start()

# %% callbacks run on the thread that spins
threads = []
n.create_timer(0.0, lambda: threads.append(threading.current_thread()))
thread = threading.Thread(target=rclpy.spin_once, args=(n,), kwargs={"timeout_sec": 1.0})
thread.start()
thread.join(30)
print(threads == [thread])

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
