"""What a joystick publishes: `sensor_msgs/Joy`, as the ROS 2 joy package's ``game_controller_node`` does."""

from collections.abc import Sequence

from rclpy.node import Node
from sensor_msgs.msg import Joy

RATE = 50  # [Hz]
NEUTRAL = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0)


def joy_message(node: Node, axes: Sequence[float], buttons: Sequence[int]) -> Joy:
    """Make a message, with the time of now.

    Args:
        node: whose clock tells the time.
        axes: of the joystick, -1 to 1.
        buttons: of the joystick, 0 or 1.
    """
    message = Joy(axes=list(axes), buttons=list(buttons))
    message.header.stamp = node.get_clock().now().to_msg()
    message.header.frame_id = "joy"
    return message
