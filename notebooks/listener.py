"""A node without the course: it listens to the tank's joints, and says once a second where they are."""

import rclpy
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from sensor_msgs.msg import JointState


class JointListener(Node):
    def __init__(self):
        super().__init__("listener")
        self.positions = {}
        self.subscription = self.create_subscription(JointState, "Tank/joint_state", self.on_joint_state, 10)
        self.timer = self.create_timer(1.0, self.on_timer)

    def on_joint_state(self, message):
        self.positions.update(zip(message.name, message.position))

    def on_timer(self):
        where = [f"{name} {position:z.2f}" for name, position in self.positions.items()]
        self.get_logger().info(", ".join(where) or "nothing heard yet")


def main(args=None):
    try:
        rclpy.init(args=args)
        rclpy.spin(JointListener())  # waits, and calls what there is to call, until Ctrl-C
    except (KeyboardInterrupt, ExternalShutdownException):
        pass


if __name__ == "__main__":
    main()
