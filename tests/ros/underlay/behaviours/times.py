# %% times
print(Time(), Time(seconds=1), Time(nanoseconds=5), Time(seconds=1.5, nanoseconds=7), Time(seconds=True))

# %% times that are none
attempt(Time, seconds=-1)
attempt(Time, nanoseconds=-1)
attempt(Time, seconds="1")
attempt(Time, 1)
attempt(Time, seconds=2**40)
attempt(Time, nanoseconds=2**63)

# %% the last time
print(Time(nanoseconds=2**63 - 1).nanoseconds, Time(nanoseconds=2**63 - 1).seconds_nanoseconds())

# %% kinds of times
for kind in ClockType:
    try:
        print(Time(clock_type=kind))
    except Exception as error:
        print(type(error).__name__)

# %% a kind of time that is none
attempt(Time, clock_type="ROS_TIME")
attempt(Time, clock_type=1)
attempt(Time, clock_type=None)

# %% times are compared
a, b = Time(seconds=1), Time(seconds=2)
print(a < b, a <= b, a > b, a >= b, a == b, a != b, a == Time(nanoseconds=10**9))

# %% times of different clocks are not compared
a, b = Time(seconds=1), Time(seconds=1, clock_type=ClockType.ROS_TIME)
attempt(lambda: a == b)
attempt(lambda: a != b)
attempt(lambda: a < b)
attempt(lambda: a - b)

# %% times are compared with times only
a = Time(seconds=1)
print(a == 1, a != 1, a == Duration(seconds=1), a is None)
attempt(lambda: a < 1)
attempt(lambda: a >= Duration(seconds=1))

# %% sums and differences of times
a = Time(seconds=3, clock_type=ClockType.ROS_TIME)
print(a + Duration(seconds=1), Duration(seconds=1) + a, a - Duration(seconds=1), a - a, a + Duration(seconds=-1))
print(a - Time(seconds=5, clock_type=ClockType.ROS_TIME))

# %% sums that there are not
a, d = Time(seconds=1), Duration(seconds=1)
for call in (
    lambda: a + a,
    lambda: a + 1,
    lambda: 1 + a,
    lambda: a - 1,
    lambda: 1 - a,
    lambda: d - a,
    lambda: d + d,
    lambda: d - d,
):
    attempt(call)

# %% sums that leave the range
attempt(lambda: Time(seconds=1) - Duration(seconds=2))
attempt(lambda: Time(nanoseconds=2**63 - 1) + Duration(nanoseconds=1))

# %% products of durations
d = Duration(seconds=1)
for call in (lambda: d * 2, lambda: 2 * d, lambda: d / 2, lambda: -d, lambda: abs(d)):
    attempt(call)

# %% durations
print(Duration(), Duration(seconds=1.5), Duration(nanoseconds=-5), Duration(seconds=1, nanoseconds=-1))
print(repr(Duration(seconds=-1)), str(Infinite), repr(Infinite))

# %% durations that are none
attempt(Duration, 1)
attempt(Duration, seconds="1")
attempt(Duration, seconds=2**40)
attempt(Duration, nanoseconds=-(2**64))

# %% durations are compared
a, b = Duration(seconds=1), Duration(seconds=2)
print(a < b, a <= b, a > b, a >= b, a == b, a != b, a == Duration(nanoseconds=10**9))
print(a == 1, a == Time(seconds=1))
attempt(lambda: a < 1)

# %% no hash
attempt(hash, Time())
attempt(hash, Duration())

# %% messages of times
print(Time(seconds=1, nanoseconds=5).to_msg(), Duration(seconds=-1.5).to_msg(), Duration(seconds=1.5).to_msg())

# %% times of messages
from builtin_interfaces.msg import Duration as DurationMessage
from builtin_interfaces.msg import Time as TimeMessage

print(Time.from_msg(TimeMessage(sec=1, nanosec=5)), Duration.from_msg(DurationMessage(sec=-2, nanosec=500000000)))
print(Time.from_msg(TimeMessage(sec=1), clock_type=ClockType.SYSTEM_TIME))

# %% times of what is no message
attempt(Time.from_msg, 3)
attempt(Duration.from_msg, None)
attempt(Time.from_msg, Header())

# %% a time before all times
from builtin_interfaces.msg import Time as TimeMessage

Time.from_msg(TimeMessage(sec=-1))

# %% seconds and nanoseconds
print(Time(seconds=2.25).seconds_nanoseconds(), Time(nanoseconds=1).seconds_nanoseconds())

# %% times cannot be changed
attempt(setattr, Time(), "nanoseconds", 3)
attempt(setattr, Time(), "clock_type", ClockType.ROS_TIME)
attempt(setattr, Duration(), "nanoseconds", 3)

# %% clocks
print(Clock(), Clock(clock_type=ClockType.STEADY_TIME), ROSClock(), Clock(clock_type=ClockType.ROS_TIME))

# %% kinds of clocks
print(type(Clock()).__name__, type(Clock(clock_type=ClockType.ROS_TIME)).__name__, Clock().clock_type.name)
attempt(Clock, clock_type="ROS_TIME")

# %% clocks tell the time
for kind in (ClockType.SYSTEM_TIME, ClockType.STEADY_TIME, ClockType.ROS_TIME):
    now = Clock(clock_type=kind).now()
    print(type(now).__name__, now.clock_type.name, now.nanoseconds > 0)

# %% a clock does not go back
clock = Clock(clock_type=ClockType.STEADY_TIME)
first = clock.now()
print(clock.now() >= first, type(clock.now() - first).__name__)

# %% a node's clock
n = start()
now = n.get_clock().now()
print(type(n.get_clock()).__name__, now.clock_type.name, n.get_clock().ros_time_is_active)
attempt(lambda: now - Clock().now())

# %% a stamp
n = start()
message = JointState()
message.header.stamp = n.get_clock().now().to_msg()
print(type(message.header.stamp).__name__, message.header.stamp.sec > 10**9)

# %% kinds of clocks are numbers
for kind in ClockType:
    print(kind.name, kind.value)
