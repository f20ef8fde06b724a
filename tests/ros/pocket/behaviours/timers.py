n = start()

# %% a timer that cancels itself
calls = []


def call():
    calls.append(t.is_canceled())
    t.cancel()


t = n.create_timer(0.0, call)
for _ in range(3):
    rclpy.spin_once(n, timeout_sec=0.01)
print(calls, t.is_canceled())

# %% a timer that destroys itself
calls = []
t = n.create_timer(0.0, lambda: calls.append(n.destroy_timer(t)))
for _ in range(3):
    rclpy.spin_once(n, timeout_sec=0.01)
print(calls, t in n.timers)

# %% a timer made in a callback
calls = []


def first():
    t.cancel()
    n.create_timer(0.0, lambda: calls.append("second"))


t = n.create_timer(0.0, first)
while not calls:
    rclpy.spin_once(n, timeout_sec=0.1)
print(calls[0], len(list(n.timers)))

# %% a spin waits for a timer as long as it is told
calls = []
t = n.create_timer(1000.0, lambda: calls.append("seldom"))
for seconds in (0, 0.05):
    rclpy.spin_once(n, timeout_sec=seconds)
n.destroy_timer(t)
n.create_timer(0.2, lambda: calls.append("often"))
for seconds in (None, -1):
    rclpy.spin_once(n, timeout_sec=seconds)
print(calls)
