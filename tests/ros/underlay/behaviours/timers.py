# %% a timer destroyed twice
n = start()
t = n.create_timer(1.0, print)
print(t in n.timers, n.destroy_timer(t), t in n.timers, n.destroy_timer(t))

# %% a timer that has been destroyed
n = start()
t = n.create_timer(1.0, print)
n.destroy_timer(t)
for method in ("is_canceled", "cancel", "reset", "is_ready", "time_since_last_call", "time_until_next_call"):
    attempt(getattr(t, method))

# %% destroy() leaves a timer in the node
n = start()
t = n.create_timer(1.0, print)
print(t.destroy(), t in n.timers, n.destroy_timer(t), t in n.timers)

# %% a timer is cancelled and reset
n = start()
t = n.create_timer(1000.0, print)
print(t.is_canceled(), t.cancel(), t.is_canceled(), t.cancel(), t.reset(), t.is_canceled())

# %% a cancelled timer has no next call
n = start()
t = n.create_timer(1000.0, print)
t.cancel()
print(t.time_until_next_call(), t.is_ready())
t.reset()
print(t.time_until_next_call() > 0)

# %% a timer that does not start by itself
n = start()
t = n.create_timer(1000.0, print, autostart=False)
print(t.is_canceled(), t.time_until_next_call())
t.reset()
print(t.is_canceled(), t.time_until_next_call() > 999 * 10**9)

# %% periods of timers
n = start()
for period in (1, 0.5, True, numpy.float64(0.25), "2", 1e-10, 0):
    print(repr(period), n.create_timer(period, print).timer_period_ns)

# %% periods that are none
n = start()
for period in (None, [], "soon", -0.5, math.nan, math.inf):
    attempt(n.create_timer, period, print)

# %% a duration is no period
n = start()
n.create_timer(Duration(seconds=1), print)

# %% a period is changed
n = start()
t = n.create_timer(1000.0, print)
t.timer_period_ns = 5
print(t.timer_period_ns)

# %% the times of a timer that waits
n = start()
t = n.create_timer(1000.0, print)
print(0 <= t.time_since_last_call() < 500 * 10**9, 500 * 10**9 < t.time_until_next_call() <= 1000 * 10**9)
print(type(t.time_since_last_call()).__name__, t.is_ready())

# %% a timer of no period is ready
n = start()
t = n.create_timer(0.0, print)
print(t.is_ready(), t.time_until_next_call() <= 0)

# %% a timer calls again and again
n = start()
calls = []
n.create_timer(0.0, lambda: calls.append(len(calls)))
for _ in range(3):
    rclpy.spin_once(n, timeout_sec=1.0)
print(calls)

# %% a timer that cancels itself
n = start()
calls = []


def call():
    calls.append(t.is_canceled())
    t.cancel()


t = n.create_timer(0.0, call)
for _ in range(3):
    rclpy.spin_once(n, timeout_sec=0.01)
print(calls, t.is_canceled())

# %% a timer that destroys itself
n = start()
calls = []
t = n.create_timer(0.0, lambda: calls.append(n.destroy_timer(t)))
for _ in range(3):
    rclpy.spin_once(n, timeout_sec=0.01)
print(calls, t in n.timers)

# %% a timer's exception comes out of the spin, and it goes on
n = start()
calls = []


def fail():
    calls.append(len(calls))
    raise KeyError("mine")


n.create_timer(0.0, fail)
for _ in range(2):
    attempt(rclpy.spin_once, n, timeout_sec=1.0)
print(calls)

# %% a timer's callback takes no argument
n = start()
n.create_timer(0.0, lambda argument: None)
rclpy.spin_once(n, timeout_sec=1.0)

# %% a timer's callback is not looked at before
n = start()
t = n.create_timer(1000.0, None)
print(t.callback)

# %% a timer's callback is replaced
n = start()
calls = []
t = n.create_timer(0.0, print)
t.callback = lambda: calls.append("other")
rclpy.spin_once(n, timeout_sec=1.0)
print(calls)

# %% a partial as a timer's callback
n = start()
calls = []
n.create_timer(0.0, partial(calls.append, "called"))
rclpy.spin_once(n, timeout_sec=1.0)
print(calls)

# %% what a timer's callback returns
n = start()
n.create_timer(0.0, lambda: 3)
print(rclpy.spin_once(n, timeout_sec=1.0))

# %% clocks of timers
n = start()
t = n.create_timer(1000.0, print)
u = n.create_timer(1000.0, print, clock=Clock(clock_type=ClockType.STEADY_TIME))
print(t.clock is n.get_clock(), t.clock.clock_type.name, u.clock.clock_type.name)

# %% a timer needs a callback
n = start()
n.create_timer(1.0)

# %% a timer has no name for its period
n = start()
attempt(n.create_timer, period=1.0, callback=print)
print(n.create_timer(timer_period_sec=1.0, callback=print).timer_period_ns)

# %% a timer after the shutdown still answers
n = start()
t = n.create_timer(1000.0, print)
rclpy.shutdown()
print(t.is_canceled(), t.cancel(), t.is_canceled(), t.is_ready())

# %% timers take turns
n = start()
calls = []
for name in "ab":
    n.create_timer(0.0, partial(calls.append, name))
for _ in range(4):
    rclpy.spin_once(n, timeout_sec=1.0)
print(sorted(calls))

# %% a timer made in a callback
n = start()
calls = []


def first():
    t.cancel()
    n.create_timer(0.0, lambda: calls.append("second"))


t = n.create_timer(0.0, first)
while not calls:
    rclpy.spin_once(n, timeout_sec=0.1)
print(calls[0], len(list(n.timers)))
