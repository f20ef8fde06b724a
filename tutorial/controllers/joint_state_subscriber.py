"""Step 3: show the joint states that another program publishes."""

from sensor_msgs.msg import JointState

from tutorial.controller import ControllerConfig, SimpleController
from tutorial.joints import JointMatcher


class JointStateSubscriber(SimpleController):
    """Show the joint states that another program publishes."""

    def configure(self, config: ControllerConfig) -> None:  # main thread, when the controller joins a body
        """Subscribe to the body's topic."""
        self.body = config.body
        self.node = config.node
        self.call_later = config.call_later
        topic = f"{self.body.name}/joint_state"
        self.subscription = self.node.create_subscription(JointState, topic, self.on_joint_state, 1)
        self.matcher = JointMatcher(self.body.joint_ranges, self.subscription.get_publisher_count)

    def on_joint_state(self, message: JointState) -> None:  # executor's thread: post and return
        """Hand the message to the main thread."""
        self.call_later(self.update, message)

    def update(self, message: JointState) -> None:  # main thread: the only one that may touch the body
        """Set the body's joints from the message, and update the view."""
        positions, report = self.matcher.match(message)
        self.body.set_joint_positions(positions)
        self.body.calc_forward_kinematics()
        self.body.notify_change(report)

    def unconfigure(self) -> None:  # main thread; calls that are still queued will never run
        """Stop listening."""
        self.node.destroy_subscription(self.subscription)
