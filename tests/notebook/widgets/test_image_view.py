"""The pictures of a topic in a cell: what is sent to whom, and what is no picture."""

from __future__ import annotations

import asyncio
import threading
from array import array

import numpy as np
import pytest
from browser import PATIENCE, Witness, chromium, open_browser, pixels, red_spot, until
from lab import jupyter_lab
from pictures import need_pictures, red_block
from sensor_msgs.msg import Image

from tutorial.controllers.camera_publisher import image
from tutorial.notebook.widgets import image_view
from tutorial.notebook.widgets.image_view import MOST_VIEWS, ImageView, _frame
from tutorial.ros.node_thread import NodeThread

TOPIC = "/Tank/camera/image"


def picture(number=0, width=4, height=3):
    message = image(np.full((height, width, 3), number, np.uint8))
    message.header.stamp.sec, message.header.stamp.nanosec = 1, 500_000_000
    return message


@pytest.fixture
def shown(domain, sent):
    """Run an async test with a widget and what it sends."""

    def run(test):
        async def main():
            widget = ImageView(TOPIC)
            try:
                async with asyncio.timeout(PATIENCE):
                    await test(widget, sent)
            finally:
                widget.close()

        asyncio.run(main())

    return run


async def says(widget, kind, view="page", **fields):
    """Say something as a page, on a thread without an event loop."""
    content = {"type": kind, "view": view, **fields}
    thread = threading.Thread(target=widget._handle_custom_msg, args=(content, []), name="subshell-1")
    thread.start()
    thread.join()
    await settle()


async def settle():
    for _ in range(3):
        await asyncio.sleep(0)


async def comes(widget, message):
    widget._on_image(message)
    await settle()


def frames(sent):
    return [(content["frame"], buffers[0][0]) for content, buffers in sent if content["type"] == "frame"]


def test_a_picture_that_is_published_comes_to_the_page(shown):
    async def test(widget, sent):
        await says(widget, "hello")
        assert sent == []
        assert widget.line == f"nothing has come on {TOPIC} yet"
        other = NodeThread("camera")
        publisher = other.node.create_publisher(Image, TOPIC, 1)
        while not publisher.get_subscription_count():
            await asyncio.sleep(0.01)
        publisher.publish(picture(7))
        while not sent:
            await asyncio.sleep(0.01)
        other.close()
        content, (pixels,) = sent[0]
        assert content == {
            "type": "frame",
            "frame": 1,
            "width": 4,
            "height": 3,
            "encoding": "rgb8",
            "line": "4 x 3, rgb8, 0.0 kB, at 1.500 s",
        }
        assert pixels == bytes([7]) * 36

    shown(test)


def test_who_is_slow_misses_pictures(shown):
    async def test(widget, sent):
        await says(widget, "hello", "quick")
        await says(widget, "hello", "slow")
        await comes(widget, picture(1))
        for number in range(2, 9):
            await comes(widget, picture(number))
            await says(widget, "drawn", "quick", frame=1)
        assert frames(sent) == [(1, 1)]
        await says(widget, "drawn", "slow", frame=1)
        assert frames(sent) == [(1, 1), (2, 8)]
        for view in ("quick", "slow"):
            await says(widget, "drawn", view, frame=2)
        assert len(sent) == 2  # there is nothing new

    shown(test)


def test_who_is_gone_holds_nobody_up_and_may_come_back(shown, monkeypatch):
    monkeypatch.setattr(image_view, "PATIENCE", 0.01)

    async def test(widget, sent):
        for view in ("here", "gone"):
            await says(widget, "hello", view)
        await comes(widget, picture(1))
        await says(widget, "drawn", "here", frame=1)
        await comes(widget, picture(2))
        while len(sent) < 2:
            await asyncio.sleep(0.005)
        while widget._views:
            await asyncio.sleep(0.005)  # nobody answers any more
        await comes(widget, picture(3))
        assert len(frames(sent)) == 2
        await says(widget, "drawn", "gone", frame=1)
        assert frames(sent)[2:] == [(3, 3)]

    shown(test)


def test_a_page_that_comes_later_sees_the_last_picture_also_when_the_view_has_ended(shown):
    async def test(widget, sent):
        await comes(widget, picture(5))
        assert sent == []
        widget.end()
        widget.end()
        await says(widget, "hello")
        assert frames(sent) == [(1, 5)]
        await says(widget, "hello", "another")  # before the first has drawn
        assert len(sent) == 1
        await says(widget, "drawn", frame=1)
        assert frames(sent) == [(1, 5), (2, 5)]
        await says(widget, "bye")
        await says(widget, "bye", "another")
        assert widget._views == widget._awaited == set()

    shown(test)


def test_what_pages_say_is_bounded(shown):
    async def test(widget, sent):
        await comes(widget, picture())
        for number in range(100):
            await says(widget, "hello", f"page {number}")
            await says(widget, "hello", "x" * 1000 + str(number))
            await says(widget, "drawn", f"other {number}", frame=10**9)
        assert len(widget._views) <= MOST_VIEWS
        widget._handle_custom_msg("nonsense", [])
        widget._handle_custom_msg({"type": "drawn", "view": 7}, [])

    shown(test)


def test_what_is_no_picture_is_counted_and_said(shown):
    async def test(widget, sent):
        await says(widget, "hello")
        odd = picture()
        odd.encoding = "16UC1\x1b[2J"
        for _ in range(3):
            await comes(widget, odd)
        assert widget.line == "the encoding '16UC1\\\\x1b[2J' is not shown here, only rgb8, bgr8, mono8"
        assert widget.ignored == 3
        await comes(widget, picture(1))
        assert len(frames(sent)) == 1

    shown(test)


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
        ({"data": array("B")}, "no picture: 0 bytes for 3 rows of 12, with 4 pixels of rgb8"),
        ({"encoding": ""}, "the encoding '' is not shown here, only rgb8, bgr8, mono8"),
    ],
)
def test_an_image_that_contradicts_itself_is_none(change, text):
    message = picture()
    for name, value in change.items():
        setattr(message, name, value)
    assert _frame(message) == text


OPEN = """
from dataclasses import replace
from pathlib import Path

from tutorial.notebook import close_all, image_view, open_program
from tutorial.controllers.camera_publisher import CameraPublisher
from tutorial.paths import find_project
from tutorial.project import Project
from tutorial.world import Placement

project = Project.load(find_project("step6")).with_controllers("Tank", CameraPublisher)
block = Placement("Block", Path("block.xml"), position=(-2.5, -0.5, 0.35))
item = replace(project.bodies[0], placement=block, controllers=())
program = open_program(replace(project, bodies=(*project.bodies, item)))
program.start()
"""
COST = """
import time
shown._awaited.clear()
began = time.thread_time()
for _ in range(100):
    shown._send_frame()
print(1000 * (time.thread_time() - began) / 100)
"""


@pytest.mark.browser
@pytest.mark.timeout(300)
def test_a_notebook_shows_a_red_block_before_the_camera(domain, tmp_path):
    need_pictures()
    path = chromium()

    async def main():
        async with jupyter_lab(tmp_path) as lab, open_browser(path, 900, 900) as page:
            witness = Witness(page)
            red_block(lab.notebooks)
            notebook = await lab.open(page, lab.write("block.ipynb", [OPEN, "shown = image_view()\nshown", "shown"]))
            await notebook.run_all()
            for number in (0, 1):

                async def is_red(number=number):
                    spot = red_spot(await pixels(page, f".tank-image >> nth={number} >> canvas"))
                    return spot is not None and abs(spot[0] - 160) < 5 and abs(spot[1] - 100) < 25

                await until(is_red, "the block is red in the middle of the picture")
            sent = int(await notebook.ask("print(shown._number)"))

            async def goes_on():
                return int(await notebook.ask("print(shown._number)")) > sent + 3

            await until(goes_on, "one picture comes after the other")
            assert float(await notebook.ask(COST)) < 2.0  # [ms] of the kernel's main thread for one picture
            await notebook.run_new("close_all()")
            await page.get_by_text("closed: this is its last picture").first.wait_for()
            assert await notebook.errors() == []
            assert witness.complaints == []

    asyncio.run(asyncio.wait_for(main(), 4 * PATIENCE))
