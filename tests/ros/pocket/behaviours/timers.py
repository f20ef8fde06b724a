n = start()

# %% a timer is cancelled and reset
t = n.create_timer(1000.0, print)
print(t.is_canceled(), t.cancel(), t.is_canceled(), t.cancel(), t.reset(), t.is_canceled())

# %% a cancelled timer has no next call
t = n.create_timer(1000.0, print)
t.cancel()
print(t.time_until_next_call(), t.is_ready())
t.reset()
print(t.time_until_next_call() > 0)

# %% periods of timers
for period in (1, 0.5, True, numpy.float64(0.25), "2", 1e-10, 0):
    print(repr(period), n.create_timer(period, print).timer_period_ns)

# %% periods that are none
for period in (None, [], "soon", -0.5, math.nan, math.inf):
    attempt(n.create_timer, period, print)

# %% a period is changed
t = n.create_timer(1000.0, print)
t.timer_period_ns = 10**9
print(t.timer_period_ns, t.time_until_next_call() > 990 * 10**9)
t.reset()
print(0 < t.time_until_next_call() <= 10**9)

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

# %% a timer's callback is not looked at before
t = n.create_timer(1000.0, None)
print(t.callback)

# %% a timer's callback is replaced
calls = []
t = n.create_timer(0.0, print)
t.callback = lambda: calls.append("other")
rclpy.spin_once(n, timeout_sec=1.0)
print(calls)

# %% clocks of timers
t = n.create_timer(1000.0, print)
u = n.create_timer(1000.0, print, clock=Clock(clock_type=ClockType.STEADY_TIME))
print(t.clock is n.get_clock(), t.clock.clock_type.name, u.clock.clock_type.name)

# %% a timer after the shutdown still answers
t = n.create_timer(1000.0, print)
rclpy.shutdown()
print(t.is_canceled(), t.cancel(), t.is_canceled(), t.is_ready())

# %% timers take turns
calls = []
for name in "ab":
    n.create_timer(0.0, partial(calls.append, name))
for _ in range(4):
    rclpy.spin_once(n, timeout_sec=1.0)
print(sorted(calls))

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
