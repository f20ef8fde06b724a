"""The pictures of a topic in a cell: what is sent to whom, and what is no picture."""

from __future__ import annotations

from array import array

import numpy as np
import pytest
from sensor_msgs.msg import Image

from tutorial.controllers.camera_publisher import image
from tutorial.notebook import open_node, until
from tutorial.notebook.desk import keep
from tutorial.notebook.widgets import image_view
from tutorial.notebook.widgets.image_view import MOST_VIEWS, ImageView, _frame

from .pages import say, settle

pytestmark = pytest.mark.usefixtures("domain")

TOPIC = "/Tank/camera/image"


def picture(number=0, width=4, height=3):
    message = image(np.full((height, width, 3), number, np.uint8))
    message.header.stamp.sec, message.header.stamp.nanosec = 1, 500_000_000
    return message


def opened():
    return keep("pictures", lambda: ImageView(TOPIC), ImageView.close)


async def comes(widget, *messages):
    for message in messages:
        widget._on_image(message)
        await settle()


def frames(sent):
    return [(content["frame"], buffers[0][0]) for content, buffers in sent if content["type"] == "frame"]


async def test_a_picture_that_is_published_comes_to_the_page(sent):
    widget = opened()
    await say(widget, "hello")
    assert sent == []
    assert widget.line == f"nothing has come on {TOPIC} yet"
    assert widget.get_state().items() >= {"title": TOPIC, "line": widget.line, "ended": False}.items()
    publisher = open_node("camera").create_publisher(Image, TOPIC, 1)
    await until(publisher.get_subscription_count)
    publisher.publish(picture(7))
    await until(lambda: sent)
    size = {"width": 4, "height": 3, "encoding": "rgb8", "line": "4 x 3, rgb8, 0.0 kB, at 1.500 s"}
    assert sent == [({"type": "frame", "frame": 1, **size}, [bytes([7]) * 36])]


async def test_who_is_slow_misses_pictures(sent):
    widget = opened()
    await say(widget, "hello", "quick")
    await say(widget, "hello", "slow")
    await comes(widget, picture(1))
    for number in range(2, 9):
        await comes(widget, picture(number))
        await say(widget, "drawn", "quick", frame=1)
    assert frames(sent) == [(1, 1)]
    await say(widget, "drawn", "slow", frame=1)
    assert frames(sent) == [(1, 1), (2, 8)]
    for view in ("quick", "slow"):
        await say(widget, "drawn", view, frame=2)
    assert len(sent) == 2  # there is nothing new


async def test_who_is_gone_holds_nobody_up_and_may_come_back(sent, monkeypatch):
    widget = opened()
    monkeypatch.setattr(image_view, "PATIENCE", 0.01)
    for view in ("here", "gone"):
        await say(widget, "hello", view)
    await comes(widget, picture(1))
    await say(widget, "drawn", "here", frame=1)
    await comes(widget, picture(2))
    await until(lambda: len(sent) == 2)
    await until(lambda: not widget._views)  # nobody answers any more
    await comes(widget, picture(3))
    assert len(frames(sent)) == 2
    await say(widget, "drawn", "gone", frame=1)
    assert frames(sent)[2:] == [(3, 3)]


async def test_a_page_that_comes_later_sees_the_last_picture_also_when_the_view_has_ended(sent):
    widget = opened()
    await comes(widget, picture(5))
    assert sent == []
    widget.end()
    widget.end()
    await say(widget, "hello")
    assert frames(sent) == [(1, 5)]
    await say(widget, "hello", "another")  # before the first has drawn
    assert len(sent) == 1
    await say(widget, "drawn", frame=1)
    assert frames(sent) == [(1, 5), (2, 5)]
    await say(widget, "bye")
    await say(widget, "bye", "another")
    assert widget._views == widget._awaited == set()


async def test_what_pages_say_is_bounded(sent):
    widget = opened()
    await comes(widget, picture())
    for number in range(100):
        await say(widget, "hello", f"page {number}")
        await say(widget, "hello", "x" * 1000 + str(number))
        await say(widget, "drawn", f"other {number}", frame=10**9)
    assert len(widget._views) <= MOST_VIEWS
    widget._handle_custom_msg("nonsense", [])
    widget._handle_custom_msg({"type": "drawn", "view": 7}, [])


async def test_what_is_no_picture_is_counted_and_said(sent):
    widget = opened()
    await say(widget, "hello")
    odd = picture()
    odd.encoding = "16UC1\x1b[2J"
    for _ in range(3):
        await comes(widget, odd)
    assert widget.line == "the encoding '16UC1\\\\x1b[2J' is not shown here, only rgb8, bgr8, mono8"
    assert widget.ignored == 3
    await comes(widget, picture(1))
    assert len(frames(sent)) == 1


def test_rows_may_be_longer_than_their_pixels():
    message = picture(width=2, height=2)
    message.step = 8
    message.data = array("B", [*range(1, 7), 0, 0, *range(7, 13), 0, 0])
    assert _frame(message).pixels == bytes(range(1, 13))


@pytest.mark.parametrize(
    ("change", "text"),
    [
        ({"step": 11}, "no picture: 36 bytes for 3 rows of 11, with 4 pixels of rgb8"),
        ({"height": 4}, "no picture: 36 bytes for 4 rows of 12, with 4 pixels of rgb8"),
        ({"width": 0}, "a picture of 0 x 3 pixels is not shown here"),
        ({"width": 2**31, "step": 2**32 - 1}, "a picture of 2147483648 x 3 pixels is not shown here"),
        ({"encoding": ""}, "the encoding '' is not shown here, only rgb8, bgr8, mono8"),
    ],
)
def test_an_image_that_contradicts_itself_is_none(change, text):
    message = picture()
    for name, value in change.items():
        setattr(message, name, value)
    assert _frame(message) == text
