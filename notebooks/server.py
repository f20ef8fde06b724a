"""A node without the course: it listens to the tank's joints, and answers whoever asks where they are."""

import rclpy
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from sensor_msgs.msg import JointState
from std_srvs.srv import Trigger


class JointServer(Node):
    def __init__(self):
        super().__init__("server")
        self.positions = {}
        self.subscription = self.create_subscription(JointState, "Tank/joint_state", self.on_joint_state, 10)
        self.service = self.create_service(Trigger, "where", self.on_where)

    def on_joint_state(self, message):
        self.positions.update(zip(message.name, message.position))

    def on_where(self, _, response):
        where = [f"{name} {position:z.2f}" for name, position in self.positions.items()]
        response.success = bool(where)
        response.message = ", ".join(where) or "nothing heard yet"
        return response


def main(args=None):
    try:
        rclpy.init(args=args)
        rclpy.spin(JointServer())  # waits, and calls what there is to call, until Ctrl-C
    except (KeyboardInterrupt, ExternalShutdownException):
        pass


if __name__ == "__main__":
    main()
