n = start("-p", "use_sim_time:=true")

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
