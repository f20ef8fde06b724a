"""Frames with tf2, on a real ROS 2, beside the tank of step 7: how high is a radar on its mast above the floor?"""

import rclpy
from geometry_msgs.msg import TransformStamped, Vector3
from nav_msgs.msg import Odometry
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from rclpy.time import Time
from tf2_ros import Buffer, StaticTransformBroadcaster, TransformBroadcaster, TransformException, TransformListener


class Frames(Node):
    def __init__(self):
        super().__init__("frames")
        self.buffer = Buffer()
        self.listener = TransformListener(self.buffer, self)  # of /tf and /tf_static
        self.static_broadcaster = StaticTransformBroadcaster(self)
        radar = TransformStamped(child_frame_id="Tank/radar")
        radar.header.frame_id = "Tank/base_link"
        radar.transform.translation = Vector3(x=-0.2, z=0.3)
        self.static_broadcaster.sendTransform(radar)  # once: it is fixed to the tank
        self.broadcaster = TransformBroadcaster(self)
        self.subscription = self.create_subscription(Odometry, "Tank/odom", self.on_odom, 10)
        self.timer = self.create_timer(1.0, self.on_timer)

    def on_odom(self, message):
        shadow = TransformStamped(header=message.header, child_frame_id="Tank/shadow")
        place = message.pose.pose.position
        shadow.transform.translation = Vector3(x=place.x, y=place.y)  # on the floor
        self.broadcaster.sendTransform(shadow)

    def on_timer(self):
        try:
            found = self.buffer.lookup_transform("Tank/shadow", "Tank/radar", Time())  # the newest that is known
        except TransformException as error:
            self.get_logger().info(f"not yet: {error}")
        else:
            self.get_logger().info(f"the radar is {found.transform.translation.z:.2f} m above the floor")


def main(args=None):
    try:
        rclpy.init(args=args)
        rclpy.spin(Frames())
    except (KeyboardInterrupt, ExternalShutdownException):
        pass


if __name__ == "__main__":
    main()
