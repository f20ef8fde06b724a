# %% kinds of times
for kind in ClockType:
    try:
        print(Time(clock_type=kind))
    except Exception as error:
        print(type(error).__name__)

# %% sums and differences of times
a = Time(seconds=3, clock_type=ClockType.ROS_TIME)
print(a + Duration(seconds=1), Duration(seconds=1) + a, a - Duration(seconds=1), a - a, a + Duration(seconds=-1))
print(a - Time(seconds=5, clock_type=ClockType.ROS_TIME))

# %% sums that there are not
a, d = Time(seconds=1), Duration(seconds=1)
for code in ("a + a", "a + 1", "1 + a", "a - 1", "1 - a", "d - a", "d + d", "d - d"):
    attempt(eval, code)

# %% products of durations
d = Duration(seconds=1)
for call in (lambda: d * 2, lambda: 2 * d, lambda: d / 2, lambda: -d, lambda: abs(d)):
    attempt(call)

# %% durations are compared
a, b = Duration(seconds=1), Duration(seconds=2)
print(a < b, a <= b, a > b, a >= b, a == b, a != b, a == Duration(nanoseconds=10**9))
print(a == 1, a == Time(seconds=1))
attempt(lambda: a < 1)

# %% times of messages
from builtin_interfaces.msg import Duration as DurationMessage
from builtin_interfaces.msg import Time as TimeMessage

print(Time.from_msg(TimeMessage(sec=1, nanosec=5)), Duration.from_msg(DurationMessage(sec=-2, nanosec=500000000)))
print(Time.from_msg(TimeMessage(sec=1), clock_type=ClockType.SYSTEM_TIME))

# %% clocks tell the time
for kind in (ClockType.SYSTEM_TIME, ClockType.STEADY_TIME, ClockType.ROS_TIME):
    now = Clock(clock_type=kind).now()
    print(type(now).__name__, now.clock_type.name, now.nanoseconds > 0)

# %% kinds of clocks are numbers
for kind in ClockType:
    print(kind.name, kind.value)
