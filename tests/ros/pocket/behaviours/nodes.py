n = start()

# %% a destroyed node makes timers alone
n.destroy_node()
attempt(n.create_publisher, String, "x", 1)
attempt(n.create_subscription, String, "x", print, 1)
t = n.create_timer(0.0, lambda: print("called"))
rclpy.spin_once(n, timeout_sec=1.0)
print(t in n.timers, n.destroy_node(), t in n.timers)
attempt(t.is_canceled)

# %% a node without rosout
n = start(enable_rosout=False)
topics = []
while not topics:
    with suppress(RuntimeError):  # the node does not know of itself yet
        topics = [topic for topic, _ in n.get_publisher_names_and_types_by_node("t", "/")]
print(topics)
