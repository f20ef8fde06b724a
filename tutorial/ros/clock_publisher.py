"""Publish the time of a simulation for other programs."""

from rclpy.node import Node
from rclpy.time import Time
from rosgraph_msgs.msg import Clock

from tutorial.controller import ControllerIO, SimpleController

CLOCK_TOPIC = "/clock"
RATE = 100  # [Hz] the minimum rate in simulated time


class ClockPublisher(SimpleController):
    """Publishes simulated time on ``/clock`` for nodes whose parameter ``use_sim_time`` is true.

    While the simulation is paused, nothing is published; when the program is restarted, the time starts at 0 again.
    This controller runs before all other controllers, so that no stamp is ahead of the clock. Delivery is reliable for
    subscriptions that request it; by default, nodes request best-effort delivery and keep only the newest message.

    Args:
        node: the node that publishes.
    """

    def __init__(self, node: Node) -> None:  # main thread
        self.publisher = node.create_publisher(Clock, CLOCK_TOPIC, 1)

    def initialize(self, io: ControllerIO) -> None:  # simulation thread, before the first step
        """Compute the number of steps between messages."""
        self.io = io
        self.steps_per_message = max(1, int(1 / (RATE * io.time_step)))

    def control(self) -> None:  # simulation thread, every step
        """Publish if a message is due."""
        if self.io.step % self.steps_per_message == 0:
            self.publisher.publish(Clock(clock=Time(nanoseconds=self.io.time_ns).to_msg()))
