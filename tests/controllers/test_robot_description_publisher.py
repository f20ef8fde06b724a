"""The robot description on its topic: it was sent before anybody listened, and everybody gets it."""

from __future__ import annotations

from loops import in_a_loop, until
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy
from std_msgs.msg import String

from tutorial.controllers.robot_description_publisher import RobotDescriptionPublisher
from tutorial.description.urdf import robot_description
from tutorial.host import Host
from tutorial.paths import find_project
from tutorial.project import Project
from tutorial.ros.node_thread import NodeThread

TOPIC = "/Tank/robot_description"


@in_a_loop
async def test_whoever_subscribes_later_gets_it_once_as_robot_descriptions_are_offered(domain):
    project = Project.load(find_project("step3")).with_controllers("Tank", RobotDescriptionPublisher)
    qos = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
    first, second = [], []
    async with Host(project) as host:
        expected = robot_description(host.bodies["Tank"])
        with NodeThread("late") as late:
            for received in (first, second):
                late.node.create_subscription(String, TOPIC, received.append, qos)
                await until(received.__len__)
        assert [message.data for message in first + second] == [expected] * 2
        await until(lambda: host.node.get_publishers_info_by_topic(TOPIC))
        (info,) = host.node.get_publishers_info_by_topic(TOPIC)
        assert info.topic_type == "std_msgs/msg/String"
        assert info.qos_profile.reliability == ReliabilityPolicy.RELIABLE
        assert info.qos_profile.durability == DurabilityPolicy.TRANSIENT_LOCAL
        host.remove("Tank")
        await until(lambda: not host.node.get_publishers_info_by_topic(TOPIC))
