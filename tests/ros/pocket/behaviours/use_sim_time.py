n = start("-p", "use_sim_time:=true")

# %% log lines keep the system's time
from rcl_interfaces.msg import Log

lines = []
n.create_subscription(Log, "/rosout", lines.append, 10)
while not lines:
    n.get_logger().info("here", throttle_duration_sec=0.1)
    rclpy.spin_once(n, timeout_sec=0.1)
print(lines[0].stamp.sec > 10**9)
