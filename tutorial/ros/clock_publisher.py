"""The time of a simulation, for other programs."""

from rclpy.node import Node
from rclpy.time import Time
from rosgraph_msgs.msg import Clock

from tutorial.controller import ControllerIO, SimpleController

CLOCK_TOPIC = "/clock"
RATE = 100  # [Hz] at least, in simulated time


class ClockPublisher(SimpleController):
    """Publish simulated time on ``/clock``: a node whose parameter ``use_sim_time`` is true goes by it.

    While the simulation stands nothing comes; in a new program the time begins at 0 again. It comes before the other
    controllers, so that no stamp is ahead of it. Delivery is reliable where somebody asks for that; nodes ask for best
    effort and the newest message.

    Args:
        node: that publishes.
    """

    def __init__(self, node: Node) -> None:  # main thread
        self.publisher = node.create_publisher(Clock, CLOCK_TOPIC, 1)

    def initialize(self, io: ControllerIO) -> None:  # simulation thread, before the first step
        """Reckon how often."""
        self.io = io
        self.steps_per_message = max(1, int(1 / (RATE * io.time_step)))

    def control(self) -> None:  # simulation thread, every step
        """Publish, when it is time to."""
        if self.io.step % self.steps_per_message == 0:
            self.publisher.publish(Clock(clock=Time(nanoseconds=self.io.time_ns).to_msg()))
