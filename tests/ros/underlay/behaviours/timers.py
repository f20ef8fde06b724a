n = start()

# %% a timer destroyed twice
t = n.create_timer(1.0, print)
print(t in n.timers, n.destroy_timer(t), t in n.timers, n.destroy_timer(t))

# %% a timer that has been destroyed
t = n.create_timer(1.0, print)
n.destroy_timer(t)
for method in ("is_canceled", "cancel", "reset", "is_ready", "time_since_last_call", "time_until_next_call"):
    attempt(getattr(t, method))

# %% destroy() leaves a timer in the node
t = n.create_timer(1.0, print)
print(t.destroy(), t in n.timers, n.destroy_timer(t), t in n.timers)

# %% a timer is cancelled and reset
t = n.create_timer(1000.0, print)
print(t.is_canceled(), t.cancel(), t.is_canceled(), t.cancel(), t.reset(), t.is_canceled())

# %% a cancelled timer has no next call
t = n.create_timer(1000.0, print)
t.cancel()
print(t.time_until_next_call(), t.is_ready())
t.reset()
print(t.time_until_next_call() > 0)

# %% a timer that does not start by itself
t = n.create_timer(1000.0, print, autostart=False)
print(t.is_canceled(), t.time_until_next_call())
t.reset()
print(t.is_canceled(), t.time_until_next_call() > 999 * 10**9)

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

# %% the times of a timer that waits
t = n.create_timer(1000.0, print)
print(0 <= t.time_since_last_call() < 500 * 10**9, 500 * 10**9 < t.time_until_next_call() <= 1000 * 10**9)
print(type(t.time_since_last_call()).__name__, t.is_ready())

# %% a timer of no period is ready
t = n.create_timer(0.0, print)
print(t.is_ready(), t.time_until_next_call() <= 0)

# %% a timer calls again and again
calls = []
n.create_timer(0.0, lambda: calls.append(len(calls)))
for _ in range(3):
    rclpy.spin_once(n, timeout_sec=1.0)
print(calls)

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

# %% a timer's exception comes out of the spin, and it goes on
calls = []


def fail():
    calls.append(len(calls))
    raise KeyError("mine")


n.create_timer(0.0, fail)
for _ in range(2):
    attempt(rclpy.spin_once, n, timeout_sec=1.0)
print(calls)

# %% a timer's callback takes no argument
n.create_timer(0.0, lambda argument: None)
rclpy.spin_once(n, timeout_sec=1.0)

# %% a timer's callback is not looked at before
t = n.create_timer(1000.0, None)
print(t.callback)

# %% a timer's callback is replaced
calls = []
t = n.create_timer(0.0, print)
t.callback = lambda: calls.append("other")
rclpy.spin_once(n, timeout_sec=1.0)
print(calls)

# %% what a timer's callback returns
n.create_timer(0.0, lambda: 3)
print(rclpy.spin_once(n, timeout_sec=1.0))

# %% clocks of timers
t = n.create_timer(1000.0, print)
u = n.create_timer(1000.0, print, clock=Clock(clock_type=ClockType.STEADY_TIME))
print(t.clock is n.get_clock(), t.clock.clock_type.name, u.clock.clock_type.name)

# %% a timer has no name for its period
attempt(n.create_timer, period=1.0, callback=print)
print(n.create_timer(timer_period_sec=1.0, callback=print).timer_period_ns)

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
