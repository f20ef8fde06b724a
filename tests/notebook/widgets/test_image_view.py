"""The images of a topic in a cell."""

import threading
from array import array

import numpy as np
import pytest
from rclpy.qos import ReliabilityPolicy, qos_profile_sensor_data
from sensor_msgs.msg import Image

from tutorial.controllers.camera_publisher import image
from tutorial.notebook import image_view, open_node, until
from tutorial.notebook.widgets.image_view import ImageView, _frame

from .pages import say, settle

pytestmark = pytest.mark.usefixtures("domain")

TOPIC = "/Tank/camera/image"


def picture(number=0, width=4, height=3):
    message = image(np.full((height, width, 3), number, np.uint8))
    message.header.stamp.sec, message.header.stamp.nanosec = 1, 500_000_000
    return message


async def comes(widget, *messages):
    for message in messages:
        widget._on_image(message)
        await settle()


def shown(sent):
    """Return the first byte of each sent image; None for a line without an image."""
    return [buffers[0][0] if buffers[0] else None for _, buffers in sent]


def requested(node):
    """Return the reliability that each subscription requests."""
    return [info.qos_profile.reliability for info in node.get_subscriptions_info_by_topic(TOPIC)]


async def test_a_published_image_reaches_the_page(sent):
    widget = image_view(TOPIC)
    await say(widget, "hello")
    assert sent.pop()[0]["line"] == f"no message on {TOPIC} yet"
    await say(widget, "seen", frame=0)
    camera = open_node("camera")
    publisher = camera.create_publisher(Image, TOPIC, 1)
    await until(lambda: requested(camera) == [ReliabilityPolicy.RELIABLE] and publisher.get_subscription_count())
    publisher.publish(picture(7))
    await until(lambda: sent)
    size = {"width": 4, "height": 3, "encoding": "rgb8", "line": "4 x 3, rgb8, 0.0 kB, at 1.500 s"}
    assert sent == [({"type": "frame", "frame": 1, **size}, [bytes([7]) * 36])]
    camera.create_publisher(Image, TOPIC, qos_profile_sensor_data)
    await until(lambda: requested(camera) == [ReliabilityPolicy.BEST_EFFORT])


async def test_a_slow_view_skips_images_and_unknown_encodings_are_reported(sent):
    widget, odd = image_view(TOPIC), picture()
    odd.encoding = "16UC1\x1b[2J"
    await comes(widget, picture(1))
    await say(widget, "hello")
    await comes(widget, picture(2), odd)
    assert shown(sent) == [1]
    await say(widget, "seen", frame=0)
    assert shown(sent) == [1, None]
    assert sent[1][0]["line"] == "the encoding '16UC1\\\\x1b[2J' is not supported, only rgb8, bgr8, mono8"


async def test_an_invalid_topic_leaves_no_thread(sent):
    threads = threading.active_count()
    with pytest.raises(Exception, match="Invalid topic name"):
        ImageView("no topic")
    assert threading.active_count() <= threads


def test_rows_may_be_longer_than_their_pixels():
    message = picture(width=2, height=2)
    message.step = 8
    message.data = array("B", [*range(1, 7), 0, 0, *range(7, 13), 0, 0])
    assert _frame(message)[0] == bytes(range(1, 13))


@pytest.mark.parametrize(
    ("change", "text"),
    [
        ({"step": 11}, "4 x 3 pixels of rgb8, in rows of 11 bytes, 36 bytes in all: not shown"),
        ({"height": 4}, "4 x 4 pixels of rgb8, in rows of 12 bytes, 36 bytes in all: not shown"),
        ({"width": 0}, "0 x 3 pixels of rgb8, in rows of 12 bytes, 36 bytes in all: not shown"),
        (
            {"width": 2**31, "step": 2**32 - 1},
            "2147483648 x 3 pixels of rgb8, in rows of 4294967295 bytes, 36 bytes in all: not shown",
        ),
        ({"encoding": ""}, "the encoding '' is not supported, only rgb8, bgr8, mono8"),
    ],
)
def test_a_contradictory_image_is_refused(change, text):
    message = picture()
    for name, value in change.items():
        setattr(message, name, value)
    assert _frame(message) == (b"", {"line": text})
