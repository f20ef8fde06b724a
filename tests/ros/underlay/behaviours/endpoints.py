# %% a publisher that has been destroyed
n = start()
p = n.create_publisher(String, "x", 1)
n.destroy_publisher(p)
attempt(p.publish, String())
attempt(p.get_subscription_count)
attempt(lambda: p.topic_name)
print(p.topic, p.msg_type.__name__, p.qos_profile.depth)

# %% a subscription destroyed twice
n = start()
s = n.create_subscription(String, "x", print, 1)
print(s in n.subscriptions)
print(n.destroy_subscription(s), s in n.subscriptions, n.destroy_subscription(s))

# %% a subscription that has been destroyed
n = start()
s = n.create_subscription(String, "x", print, 1)
n.destroy_subscription(s)
attempt(s.get_publisher_count)
attempt(lambda: s.topic_name)
print(s.topic, s.msg_type.__name__, s.raw)

# %% destroying what is another node's
n, m = start(), rclpy.create_node("u")
p, s, t = n.create_publisher(String, "x", 1), n.create_subscription(String, "x", print, 1), n.create_timer(1.0, print)
print(m.destroy_publisher(p), m.destroy_subscription(s), m.destroy_timer(t))
print(p in n.publishers, s in n.subscriptions, t in n.timers)

# %% destroying what is nothing
n = start()
print(n.destroy_publisher(None), n.destroy_subscription(3), n.destroy_timer("t"))

# %% destroying one kind as another
n = start()
p, s = n.create_publisher(String, "x", 1), n.create_subscription(String, "x", print, 1)
print(n.destroy_subscription(p), n.destroy_publisher(s), p in n.publishers, s in n.subscriptions)

# %% a publisher as a context manager
n = start()
with n.create_publisher(String, "x", 1) as p:
    p.publish(String())
attempt(p.publish, String())

# %% a publisher after the shutdown
n = start()
p = n.create_publisher(String, "x", 1)
rclpy.shutdown()
attempt(p.publish, String())

# %% partners of a publisher are counted
n = start()
p = n.create_publisher(String, "x", 1)
s = n.create_subscription(String, "x", print, 1)
while p.get_subscription_count() < 1 or s.get_publisher_count() < 1:
    rclpy.spin_once(n, timeout_sec=0.01)
print(p.get_subscription_count(), s.get_publisher_count())

# %% names of endpoints
n = start(namespace="/Tank")
p, s = n.create_publisher(String, "x", 1), n.create_subscription(String, "~/y", print, 1)
print(p.topic, p.topic_name, s.topic, s.topic_name)

# %% remapped endpoints
n = start("-r", "x:=/z")
p = n.create_publisher(String, "x", 1)
print(p.topic, p.topic_name)

# %% an endpoint's profile is the one given
n = start()
profile = QoSProfile(depth=3, reliability=ReliabilityPolicy.BEST_EFFORT)
p, s = n.create_publisher(String, "x", profile), n.create_subscription(String, "y", print, profile)
print(p.qos_profile is profile, s.qos_profile is profile, p.qos_profile == profile)

# %% a number is a depth
n = start()
p = n.create_publisher(String, "x", 7)
print(p.qos_profile.depth, p.qos_profile.reliability.name, p.qos_profile.durability.name, p.qos_profile.history.name)

# %% profiles that are none
n = start()
attempt(n.create_publisher, String, "x", "10")
attempt(n.create_subscription, String, "x", print, None)
attempt(n.create_publisher, String, "x", 1.5)

# %% a depth below zero
n = start()
attempt(n.create_publisher, String, "x", -5)
attempt(n.create_subscription, String, "x", print, -1)

# %% a publisher needs a depth
n = start()
n.create_publisher(String, "x")

# %% a subscription needs a depth
n = start()
n.create_subscription(String, "x", print)

# %% a number is no type
n = start()
n.create_subscription(3, "x", print, 1)

# %% a callback is asked for
n = start()
n.create_subscription(String, "x", None, 1)

# %% a callback of no argument
n = start()
n.create_subscription(String, "x", lambda: None, 1)

# %% a callback of three arguments
n = start()
n.create_subscription(String, "x", lambda a, b, c: None, 1)

# %% a callback's second argument may have a default
n = start()
got = []
n.create_subscription(String, "x", lambda message, name="mine": got.append((message.data, name)), 1)
n.create_publisher(String, "x", 1).publish(String(data="hi"))
while not got:
    rclpy.spin_once(n, timeout_sec=0.1)
print(got)

# %% a callback takes any number of arguments
n = start()
got = []
n.create_subscription(String, "x", lambda *given: got.append(len(given)), 1)
n.create_publisher(String, "x", 1).publish(String(data="hi"))
while not got:
    rclpy.spin_once(n, timeout_sec=0.1)
print(got)

# %% a partial as callback
n = start()
got = []
n.create_subscription(String, "x", partial(lambda name, message: got.append((name, message.data)), "mine"), 1)
n.create_publisher(String, "x", 1).publish(String(data="hi"))
while not got:
    rclpy.spin_once(n, timeout_sec=0.1)
print(got)


# %% a method as callback
class Listener:
    def hear(self, message):
        self.heard = message.data


n, listener = start(), Listener()
n.create_subscription(String, "x", listener.hear, 1)
n.create_publisher(String, "x", 1).publish(String(data="hi"))
while not hasattr(listener, "heard"):
    rclpy.spin_once(n, timeout_sec=0.1)
print(listener.heard)


# %% an object as callback
class Listener:
    def __call__(self, message):
        self.heard = message.data


n, listener = start(), Listener()
s = n.create_subscription(String, "x", listener, 1)
n.create_publisher(String, "x", 1).publish(String(data="hi"))
while not hasattr(listener, "heard"):
    rclpy.spin_once(n, timeout_sec=0.1)
print(listener.heard, s.callback is listener)

# %% a callback is replaced
n = start()
got = []
s = n.create_subscription(String, "x", print, 1)
s.callback = lambda message: got.append(message.data)
n.create_publisher(String, "x", 1).publish(String(data="hi"))
while not got:
    rclpy.spin_once(n, timeout_sec=0.1)
print(got)

# %% a callback is not replaced by anything
n = start()
s = n.create_subscription(String, "x", print, 1)
attempt(setattr, s, "callback", lambda: None)

# %% a callback's exception ends the spin, and the next message comes
n = start()
got = []


def fail(message):
    got.append(message.data)
    raise ValueError(message.data)


n.create_subscription(String, "x", fail, 10)
p = n.create_publisher(String, "x", 10)
for text in "ab":
    p.publish(String(data=text))
    try:
        while True:
            rclpy.spin_once(n, timeout_sec=0.1)
    except ValueError as error:
        print(repr(error))
print(got)

# %% a subscription ends in its own callback
n = start()
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

# %% raw messages
n = start()
got = []
n.create_subscription(String, "x", got.append, 1, raw=True)
n.create_publisher(String, "x", 1).publish(String(data="hi"))
while not got:
    rclpy.spin_once(n, timeout_sec=0.1)
print(type(got[0]).__name__, deserialize_message(got[0], String))

# %% bytes are published
n = start()
got = []
n.create_subscription(String, "x", got.append, 1)
n.create_publisher(String, "x", 1).publish(serialize_message(String(data="hi")))
while not got:
    rclpy.spin_once(n, timeout_sec=0.1)
print(got)

# %% what is not published
n = start()
p = n.create_publisher(String, "x", 1)
attempt(p.publish, Int32(data=1))
attempt(p.publish, None)
attempt(p.publish, String)
attempt(p.publish, bytearray(b"x"))

# %% every message is a new one
n = start()
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
n = start()
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
n = start()
p = n.create_publisher(Int32, "x", QoSProfile(depth=2, durability=DurabilityPolicy.TRANSIENT_LOCAL))
p.publish(Int32(data=1))
got = []
n.create_subscription(Int32, "x", lambda message: got.append(message.data), 2)
for _ in range(5):
    rclpy.spin_once(n, timeout_sec=0.02)
print(got)

# %% a subclass of Publisher
from rclpy.publisher import Publisher


class Counting(Publisher):
    published = 0

    def publish(self, message):
        self.published += 1
        super().publish(message)


n = start()
p = n.create_publisher(String, "x", 1, publisher_class=Counting)
p.publish(String())
print(p.published, type(p).__name__, p in n.publishers)

# %% all is acknowledged where nobody listens
n = start()
p = n.create_publisher(String, "x", 1)
print(p.wait_for_all_acked(Duration(seconds=1)))

# %% options that there are not
n = start()
attempt(n.create_publisher, String, "x", 1, colour="red")
attempt(n.create_subscription, String, "x", print, 1, colour="red")

# %% endpoints on a topic are counted
n = start(namespace="/Tank")
p, q = n.create_publisher(String, "x", 1), n.create_publisher(String, "x", 1)
s = n.create_subscription(String, "/Tank/x", print, 1)
while n.count_publishers("x") < 2 or n.count_subscribers("x") < 1:
    pass
print(n.count_publishers("x"), n.count_subscribers("x"), n.count_publishers("/x"))
n.destroy_publisher(p)
while n.count_publishers("x") > 1:
    pass
print(n.count_publishers("x"))

# %% counting needs a name
n = start()
attempt(n.count_publishers, "bad name")
attempt(n.count_subscribers, "")
attempt(n.get_publishers_info_by_topic, "a//b")
