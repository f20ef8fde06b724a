"""The robot description on its topic: it was sent before anybody listened, and everybody gets it."""

from __future__ import annotations

import asyncio

import pytest
from programs import PATIENCE
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy
from std_msgs.msg import String

from tutorial.controllers.robot_description_publisher import RobotDescriptionPublisher
from tutorial.description.urdf import robot_description
from tutorial.host import Host
from tutorial.paths import find_project
from tutorial.project import Project
from tutorial.ros.node_thread import NodeThread

TOPIC = "/Tank/robot_description"


@pytest.fixture
def project(domain):
    return Project.load(find_project("step3")).with_controllers("Tank", RobotDescriptionPublisher)


async def until(condition):
    async with asyncio.timeout(PATIENCE):
        while not condition():
            await asyncio.sleep(0.01)


def test_whoever_subscribes_later_gets_it_once(project):
    qos = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)

    async def scenario():
        first, second = [], []
        async with Host(project) as host:
            expected = robot_description(host.bodies["Tank"])
            late = NodeThread("late")
            try:
                late.node.create_subscription(String, TOPIC, first.append, qos)
                await until(lambda: first)
                late.node.create_subscription(String, TOPIC, second.append, qos)
                await until(lambda: second)
            finally:
                late.close()
            assert [message.data for message in first + second] == [expected] * 2

    asyncio.run(scenario())


def test_it_is_offered_as_robot_descriptions_are(project):
    async def scenario():
        async with Host(project) as host:
            await until(lambda: host.node.get_publishers_info_by_topic(TOPIC))
            (info,) = host.node.get_publishers_info_by_topic(TOPIC)
            assert info.topic_type == "std_msgs/msg/String"
            assert info.qos_profile.reliability == ReliabilityPolicy.RELIABLE
            assert info.qos_profile.durability == DurabilityPolicy.TRANSIENT_LOCAL
            host.remove("Tank")
            await until(lambda: not host.node.get_publishers_info_by_topic(TOPIC))

    asyncio.run(scenario())
