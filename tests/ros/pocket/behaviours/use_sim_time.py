n = start("-p", "use_sim_time:=true")

# %% simulated time by an argument
clock = n.get_clock()
print(n.get_parameter("use_sim_time").value, clock.ros_time_is_active, clock.now(), clock)
for s in n.subscriptions:
    print(s.topic_name, s.msg_type.__name__, s.qos_profile.depth, s.qos_profile.reliability.name)

# %% simulated time by the program
n = start(parameter_overrides=[Parameter("use_sim_time", value=True)])
print(n.get_clock().ros_time_is_active, n.get_clock().now().nanoseconds)

# %% simulated time is a truth value
attempt(start, "-p", "use_sim_time:=1")
n = rclpy.create_node("t", use_global_arguments=False)
print(n.set_parameters([Parameter("use_sim_time", value="yes")]), n.get_clock().ros_time_is_active)

# %% simulated time is switched on and off
n = start()
clock = n.get_clock()
for value in (True, True, False, True):
    print(n.set_parameters([Parameter("use_sim_time", value=value)])[0].successful)
    print(clock.ros_time_is_active, clock.now().nanoseconds < 10**18, [s.topic_name for s in n.subscriptions])

# %% a clock follows /clock, forwards and back
from rosgraph_msgs.msg import Clock as ClockMessage

clock = n.get_clock()
p = n.create_publisher(ClockMessage, "/clock", 1)
for nanoseconds in (1_500_000_000, 7, 2 * 10**18):
    message = ClockMessage(clock=Time(nanoseconds=nanoseconds).to_msg())
    while clock.now().nanoseconds != nanoseconds:
        p.publish(message)
        rclpy.spin_once(n, timeout_sec=0.1)
    print(clock.now(), clock.now().to_msg())

# %% a stopped clock stands
clock = n.get_clock()
clock.set_ros_time_override(Time(seconds=5))
first = clock.now()
for _ in range(3):
    rclpy.spin_once(n, timeout_sec=0.01)
print(first, clock.now() == first, (clock.now() - first).nanoseconds)

# %% a clock that is set
n = start()
clock = n.get_clock()
clock.set_ros_time_override(Time(seconds=5))
print(clock.now().nanoseconds > 10**18, clock.ros_time_is_active)
attempt(clock.set_ros_time_override, 5)
n.set_parameters([Parameter("use_sim_time", value=True)])
print(clock.now())
n.set_parameters([Parameter("use_sim_time", value=False)])
print(clock.now().nanoseconds > 10**18)

# %% other clocks keep the system's time
print(Clock().now().nanoseconds > 10**18, ROSClock().ros_time_is_active, ROSClock().now().nanoseconds > 10**18)

# %% a timer of simulated time stands with its clock
calls = []
t = n.create_timer(0.01, lambda: calls.append(n.get_clock().now().nanoseconds))
for _ in range(3):
    rclpy.spin_once(n, timeout_sec=0.05)
print(calls, t.is_ready(), t.time_until_next_call(), t.time_since_last_call())
n.get_clock().set_ros_time_override(Time(nanoseconds=4_000_000))
print(t.is_ready(), t.time_until_next_call(), t.time_since_last_call())

# %% a timer of simulated time calls when its clock passes, once for several periods
calls = []
t = n.create_timer(0.1, lambda: calls.append(n.get_clock().now().nanoseconds // 10**6))
for ms in (50, 99, 100, 150, 200, 210, 305, 390, 400, 1234, 1299, 1300):
    n.get_clock().set_ros_time_override(Time(nanoseconds=ms * 10**6))
    for _ in range(2):
        rclpy.spin_once(n, timeout_sec=0.02)
    print(ms, calls, t.time_until_next_call() // 10**6)

# %% a timer of simulated time when its clock jumps back
calls = []
n.get_clock().set_ros_time_override(Time(seconds=50))
t = n.create_timer(1.0, lambda: calls.append(n.get_clock().now().nanoseconds // 10**6))
for ms in (50_500, 51_000, 51_900, 51_200, 52_000, 0, 900, 1000, 2100, 1_999, 2_000, 3_000):
    n.get_clock().set_ros_time_override(Time(nanoseconds=ms * 10**6))
    for _ in range(2):
        rclpy.spin_once(n, timeout_sec=0.02)
    print(ms, calls, t.time_until_next_call() // 10**6, t.time_since_last_call() // 10**6)

# %% a timer of before when time becomes simulated
n = start()
calls = []
t = n.create_timer(1000.0, lambda: calls.append(n.get_clock().now().nanoseconds // 10**6))
n.set_parameters([Parameter("use_sim_time", value=True)])
rclpy.spin_once(n, timeout_sec=0.02)
print(calls, t.is_ready())
for ms in (5_000, 1_004_999, 1_005_000):
    n.get_clock().set_ros_time_override(Time(nanoseconds=ms * 10**6))
    for _ in range(2):
        rclpy.spin_once(n, timeout_sec=0.02)
    print(ms, calls, t.time_until_next_call() // 10**6, t.time_since_last_call() // 10**6)

# %% a timer of before when its clock has been told the time
n = start()
n.get_clock().set_ros_time_override(Time(seconds=5))
t = n.create_timer(1000.0, print)
n.set_parameters([Parameter("use_sim_time", value=True)])
print(round(t.time_until_next_call() / 1e11), round(t.time_since_last_call() / 1e11))

# %% a timer when time is no longer simulated
n.get_clock().set_ros_time_override(Time(seconds=5))
t = n.create_timer(1000.0, print)
n.get_clock().set_ros_time_override(Time(seconds=305))
n.set_parameters([Parameter("use_sim_time", value=False)])
print(round(t.time_until_next_call() / 1e11), round(t.time_since_last_call() / 1e11))

# %% timers that are reset and cancelled in simulated time
t = n.create_timer(1.0, print)
n.get_clock().set_ros_time_override(Time(seconds=0.5))
t.reset()
print(t.time_until_next_call(), t.time_since_last_call())
t.cancel()
n.get_clock().set_ros_time_override(Time(seconds=5))
rclpy.spin_once(n, timeout_sec=0.02)
print(t.is_canceled(), t.is_ready(), t.time_until_next_call())
t.reset()
print(t.time_until_next_call())

# %% a timer of a steady clock beside simulated time
calls = []
n.create_timer(0.01, lambda: calls.append("steady"), clock=Clock(clock_type=ClockType.STEADY_TIME))
rclpy.spin_once(n, timeout_sec=5.0)
print(calls)

# %% log lines keep the system's time
from rcl_interfaces.msg import Log

lines = []
n.create_subscription(Log, "/rosout", lines.append, 10)
while not lines:
    n.get_logger().info("here", throttle_duration_sec=0.1)
    rclpy.spin_once(n, timeout_sec=0.1)
print(lines[0].stamp.sec > 10**9)

# %% a time before all times on /clock
from rosgraph_msgs.msg import Clock as ClockMessage

p = n.create_publisher(ClockMessage, "/clock", 1)
message = ClockMessage()
message.clock.sec = -1
while True:
    p.publish(message)
    rclpy.spin_once(n, timeout_sec=0.1)
