"""The part of tf2_ros that publishes transforms. Receiving and combining transforms needs a real ROS 2."""

from _absent import TABLE, absent_names
from geometry_msgs.msg import TransformStamped as TransformStamped  # re-export
from tf2_ros.static_transform_broadcaster import StaticTransformBroadcaster
from tf2_ros.transform_broadcaster import TransformBroadcaster

__all__ = ["StaticTransformBroadcaster", "TransformBroadcaster"]

__getattr__ = absent_names(__name__, TABLE["names"][__name__])
