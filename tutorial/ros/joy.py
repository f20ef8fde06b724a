"""Make joystick messages (`sensor_msgs/Joy`) like those of ``game_controller_node`` in the ROS 2 package joy."""

from collections.abc import Sequence

from rclpy.node import Node
from sensor_msgs.msg import Joy

RATE = 50  # [Hz]
NEUTRAL = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0)


def joy_message(node: Node, axes: Sequence[float], buttons: Sequence[int]) -> Joy:
    """Make a joystick message stamped with the current time.

    Args:
        node: the node whose clock provides the time.
        axes: positions of the joystick's axes, -1 to 1.
        buttons: states of the joystick's buttons, 0 or 1.
    """
    message = Joy(axes=list(axes), buttons=list(buttons))
    message.header.stamp = node.get_clock().now().to_msg()
    message.header.frame_id = "joy"
    return message
