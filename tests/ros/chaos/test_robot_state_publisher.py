"""The model of robot_state_publisher beside the program itself: message by message they publish the same."""

from __future__ import annotations

import math
import os
import subprocess
import time
from itertools import count, islice
from pathlib import Path

import pytest
from comparison import RANGES, RATE
from programs import PATIENCE, until
from sensor_msgs.msg import JointState
from tf2_msgs.msg import TFMessage
from viewers import RobotStatePublisher

from tutorial.ros.chaos import FAULTS, Chaos
from tutorial.ros.chaos.faults import stamp_ns
from tutorial.ros.chaos.stream import swing
from tutorial.ros.node_thread import NodeThread

LINK = '<link name="{0}"/><joint name="{0}" type="continuous"><parent link="base"/><child link="{0}"/>{1}</joint>'
URDF = f"""<robot name="tank"><link name="base"/>
{"".join(LINK.format(joint, '<axis xyz="0 0 1"/>') for joint in RANGES)}
</robot>"""
LAST = ("restart", "ahead")  # they silence it, so they come last
MESSAGES = 25  # of each fault


class Recorded(RobotStatePublisher):
    """The model, which writes down what it publishes: stamp, joint, and half the angle's sine and cosine."""

    def __init__(self):
        super().__init__(RANGES)
        self.published = []

    def _transform(self, joint, position, ns):
        half = position / 2 if math.isfinite(position) else math.nan
        self.published.append((ns, joint, math.sin(half), math.cos(half)))
        return super()._transform(joint, position, ns)


@pytest.fixture
def robot_state_publisher(domain, tmp_path):
    prefixes = map(Path, filter(None, os.environ.get("AMENT_PREFIX_PATH", "").split(":")))
    found = [
        path for prefix in prefixes if (path := prefix / "lib/robot_state_publisher/robot_state_publisher").exists()
    ]
    if not found:
        pytest.skip("there is no robot_state_publisher: a real ROS 2 has it")
    (tmp_path / "tank.urdf").write_text(URDF)
    with subprocess.Popen([found[0], tmp_path / "tank.urdf"], stderr=subprocess.DEVNULL) as process:
        yield process
        process.terminate()


def is_same(real, model):
    """Whether two rotations are the same; a quaternion and its negative are."""
    if real[:2] != model[:2] or math.isnan(real[2]) != math.isnan(model[2]):
        return False
    return math.isnan(real[2]) or math.isclose(abs(real[2] * model[2] + real[3] * model[3]), 1, abs_tol=1e-9)


@pytest.mark.process
@pytest.mark.usefixtures("robot_state_publisher")
def test_the_model_publishes_what_the_program_publishes():
    published = []

    def on_transforms(message):
        for transform in message.transforms:
            rotation = transform.transform.rotation
            published.append((stamp_ns(transform), transform.child_frame_id, rotation.z, rotation.w))

    model = Recorded()
    with NodeThread("hand") as thread:
        thread.node.create_subscription(TFMessage, "/tf", on_transforms, 100)
        publisher = thread.node.create_publisher(JointState, "/joint_states", 100)
        until(lambda: publisher.get_subscription_count() and thread.node.count_publishers("/tf"), "the program")
        until(lambda: publisher.publish(swing(1, tuple(RANGES), RATE)) or published or time.sleep(0.1), "both ways")
        model.take(swing(1, tuple(RANGES), RATE))
        chaos, numbers = Chaos(), count(2)
        for fault in sorted(FAULTS, key=LAST.__contains__):
            chaos.faults = {fault: 0.3}
            for number in islice(numbers, MESSAGES):
                for action in chaos.apply(swing(number, tuple(RANGES), RATE)):
                    if action.message is not None:
                        model.take(action.message)
                        publisher.publish(action.message)
                        until(
                            lambda: len(published) >= len(model.published), f"{fault}: {action.message}", PATIENCE / 4
                        )
            assert all(map(is_same, sorted(published), sorted(model.published))), fault
    assert len(published) == len(model.published) > MESSAGES
