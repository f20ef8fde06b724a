n = start()
from geometry_msgs.msg import TransformStamped
from tf2_msgs.msg import TFMessage
from tf2_ros import StaticTransformBroadcaster, TransformBroadcaster


def transform(parent, child, x):
    """Return a transform from one frame to another."""
    stamped = TransformStamped(child_frame_id=child)
    stamped.header.frame_id, stamped.transform.translation.x = parent, x
    return stamped


def hear(topic, durability=DurabilityPolicy.VOLATILE):
    """Return a list of the messages on a topic, as lists of (parent, child, x)."""
    heard = []

    def write(message):
        heard.append([(t.header.frame_id, t.child_frame_id, t.transform.translation.x) for t in message.transforms])

    n.create_subscription(TFMessage, topic, write, QoSProfile(depth=100, durability=durability))
    return heard


# %% the publishers of transforms
for broadcaster in (
    TransformBroadcaster(n),
    StaticTransformBroadcaster(n),
    TransformBroadcaster(n, 5),
    StaticTransformBroadcaster(n, qos=QoSProfile(depth=7)),
    TransformBroadcaster(node=n, qos=qos_profile_sensor_data),
):
    print(broadcaster.pub_tf.topic_name, broadcaster.pub_tf.msg_type.__name__, broadcaster.pub_tf.qos_profile)

# %% changing transforms
broadcaster, heard = TransformBroadcaster(n), hear("/tf")
wait(n, lambda: broadcaster.pub_tf.get_subscription_count())
broadcaster.sendTransform(transform("world", "tank", 1.0))
broadcaster.sendTransform([transform("world", "tank", 2.0), transform("tank", "turret", 3.0)])
broadcaster.sendTransform({"a": transform("world", "a", 4.0), "b": transform("world", "b", 4.0)}.values())
broadcaster.sendTransform([])
wait(n, lambda: len(heard) == 4)
print(heard)

# %% static transforms for a late subscriber
broadcaster = StaticTransformBroadcaster(n)
broadcaster.sendTransform(transform("world", "map", 1.0))
broadcaster.sendTransform([transform("map", "odom", 2.0), transform("world", "map", 3.0)])
heard = hear("/tf_static", DurabilityPolicy.TRANSIENT_LOCAL)
wait(n, lambda: heard)
print(heard, len(broadcaster.net_message.transforms))

# %% arguments that are not transforms
for broadcaster in (TransformBroadcaster(n), StaticTransformBroadcaster(n)):
    print([bool(raised(broadcaster.sendTransform, what)) for what in (None, 3, TFMessage(), [3])])
print(raised(TransformBroadcaster, None), raised(TransformBroadcaster, n, "5"))
