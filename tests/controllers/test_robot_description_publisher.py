"""The robot description: every subscriber gets it, although it was sent earlier."""

from loops import in_a_loop, until
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy
from std_msgs.msg import String

from tutorial.controllers.robot_description_publisher import RobotDescriptionPublisher
from tutorial.description.urdf import robot_description
from tutorial.program.host import Host
from tutorial.program.project import Project
from tutorial.ros.node_thread import NodeThread
from tutorial.system.paths import find_project

TOPIC = "/Tank/robot_description"


@in_a_loop
async def test_a_late_subscriber_gets_it_once_until_the_robot_is_removed(domain):
    project = Project.load(find_project("step3")).with_controllers("Tank", RobotDescriptionPublisher)
    kept = QoSProfile(depth=1, reliability=ReliabilityPolicy.RELIABLE, durability=DurabilityPolicy.TRANSIENT_LOCAL)
    received = []
    async with Host(project) as host:
        with NodeThread("late") as late:
            late.node.create_subscription(String, TOPIC, received.append, kept)
            await until(lambda: received)
        assert [message.data for message in received] == [robot_description(host.bodies["Tank"])]
        host.remove("Tank")
        await until(lambda: not host.node.get_publishers_info_by_topic(TOPIC))
