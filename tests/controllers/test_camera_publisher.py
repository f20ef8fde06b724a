"""Step 6's controller: the images that the tank publishes."""

import threading
from dataclasses import replace

import numpy as np
import pytest
from controlled import stamps_ms
from loops import in_a_loop, until
from pictures import is_red, need_pictures, red_block
from sensor_msgs.msg import Image

from tutorial.controllers.camera_publisher import CameraPublisher
from tutorial.program.host import Host
from tutorial.program.project import Project
from tutorial.system.paths import find_project
from tutorial.world import Placement


@pytest.fixture
def project(domain, tmp_path):
    """The tank of step 6, with only its camera, in front of a red block."""
    need_pictures()
    loaded = Project.load(find_project("step6")).with_controllers("Tank", CameraPublisher)
    block = Placement("Block", red_block(tmp_path), position=(-2.5, -0.5, 0.35))
    item = replace(loaded.bodies[0], placement=block, controllers=())
    return replace(loaded, bodies=(*loaded.bodies, item))


def ear(host):
    """The received images, and the subscription."""
    heard = []
    return heard, host.node.create_subscription(Image, "/Tank/camera/image", heard.append, 30)


@in_a_loop
async def test_images_arrive_in_lockstep_ten_times_a_second(project):
    async with Host(project) as host:
        heard, subscription = ear(host)
        await until(subscription.get_publisher_count)
        for seconds, count in ((1.001, 11), (0.2, 13)):
            host.simulation.advance(seconds)
            host.simulation.stop()
            await until(lambda n=count: len(heard) >= n)
        assert host.error is None
    assert stamps_ms(heard) == [*range(0, 1201, 100)]
    message = heard[10]
    assert (message.header.frame_id, message.encoding) == ("Tank/CAMERA_optical", "rgb8")
    assert (message.width, message.height, message.step, len(message.data)) == (320, 240, 960, 230_400)
    pixels = np.frombuffer(bytes(message.data), np.uint8).reshape(240, 320, 3)
    assert is_red(pixels[120, 160])
    assert not is_red(pixels[10, 10])


@in_a_loop
async def test_deleting_the_tank_while_it_takes_images_leaves_nothing(project):
    async with Host(project) as host:
        heard, _ = ear(host)
        host.simulation.start()
        await until(lambda: len(heard) >= 2)
        host.remove("Tank")
        assert host.simulation.running
        assert host.error is None
        host.simulation.stop()
    assert all(stamp % 100 == 0 for stamp in stamps_ms(heard))
    assert not any(thread.name == "camera" for thread in threading.enumerate())


@in_a_loop
async def test_an_error_in_the_cameras_callback_is_the_programs_error(project):
    class Broken(CameraPublisher):
        def publish(self, pixels, time_ns):
            raise ZeroDivisionError

    async with Host(project.with_controllers("Tank", Broken)) as host:
        host.simulation.start()
        await until(lambda: host.error is not None)
        assert isinstance(host.error, ZeroDivisionError)
        assert host.simulation.running
        host.simulation.stop()
        host.forget_errors()
        assert host.error is None
