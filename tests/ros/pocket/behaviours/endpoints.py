n = start()

# %% partners of a publisher are counted
p = n.create_publisher(String, "x", 1)
s = n.create_subscription(String, "x", print, 1)
while p.get_subscription_count() < 1 or s.get_publisher_count() < 1:
    rclpy.spin_once(n, timeout_sec=0.01)
print(p.get_subscription_count(), s.get_publisher_count())
print(p.wait_for_all_acked(Duration(seconds=10)))

# %% a callback is replaced
got = []
s = n.create_subscription(String, "x", print, 1)
s.callback = lambda message: got.append(message.data)
n.create_publisher(String, "x", 1).publish(String(data="hi"))
while not got:
    rclpy.spin_once(n, timeout_sec=0.1)
print(got)

# %% a subscription ends in its own callback
got = []


def hear(message):
    got.append(message.data)
    print(n.destroy_subscription(s), s in n.subscriptions)


s = n.create_subscription(String, "x", hear, 10)
p = n.create_publisher(String, "x", 10)
p.publish(String(data="a"))
p.publish(String(data="b"))
while not got:
    rclpy.spin_once(n, timeout_sec=0.1)
for _ in range(3):
    rclpy.spin_once(n, timeout_sec=0.02)
print(got)

# %% every message is a new one
got = []
n.create_subscription(JointState, "x", got.append, 10)
p = n.create_publisher(JointState, "x", 10)
message = JointState(name=["a"], position=[1.0])
for position in (1.0, 2.0):
    message.position[0] = position
    p.publish(message)
while len(got) < 2:
    rclpy.spin_once(n, timeout_sec=0.1)
print([list(other.position) for other in got], got[0] is message, type(got[0].position).__name__)

# %% a late subscription receives what is kept
kept = QoSProfile(depth=2, durability=DurabilityPolicy.TRANSIENT_LOCAL)
p = n.create_publisher(Int32, "x", kept)
for number in range(4):
    p.publish(Int32(data=number))
got = []
n.create_subscription(Int32, "x", lambda message: got.append(message.data), kept)
while len(got) < 2:
    rclpy.spin_once(n, timeout_sec=0.1)
print(got)

# %% a late subscription that does not ask for it
p = n.create_publisher(Int32, "x", QoSProfile(depth=2, durability=DurabilityPolicy.TRANSIENT_LOCAL))
p.publish(Int32(data=1))
got = []
n.create_subscription(Int32, "x", lambda message: got.append(message.data), 2)
for _ in range(5):
    rclpy.spin_once(n, timeout_sec=0.02)
print(got)
