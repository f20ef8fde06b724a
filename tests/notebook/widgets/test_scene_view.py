"""The 3D view in a cell: what it sends to whom, and when it stops."""

import asyncio
import gzip
import threading
from itertools import count

import pytest
from scenes import commands, lines, raised_elsewhere

from tutorial.errors import TutorialError, WrongThreadError
from tutorial.notebook import until
from tutorial.notebook.desk import keep
from tutorial.notebook.widgets.scene_view import FRAMES_AHEAD, SceneView
from tutorial.view.bodies import View
from tutorial.view.scene import Record, Scene, unpack_records

from .pages import say, settle


class Page:
    """A view of the widget on some page."""

    def __init__(self, widget, sent, name="page"):
        self.widget, self.sent, self.name = widget, sent, name

    async def says(self, kind, **fields):
        await say(self.widget, kind, self.name, **fields)

    def take(self, kind):
        """The messages of a kind that came since this was last asked."""
        mine = [buffers[0] for content, buffers in self.sent
                if content["type"] == kind and content.get("view", self.name) == self.name]  # fmt: skip
        self.sent[:] = [message for message in self.sent if message[0]["type"] != kind]
        return mine


async def show(scene, text):
    """Have a scene say something, late enough after the last time to be sent at once."""
    scene.line(text)
    scene.flush()
    await asyncio.sleep(0)


def opened(sent, hurried=True):
    """A scene, its widget, and a page; unhurried, each frame is a message of its own."""
    scene = Scene()
    widget = keep("view", lambda: SceneView(scene), SceneView.close)
    if not hurried:
        widget._loop = type("Loop", (), {"time": count().__next__})()
    return scene, widget, Page(widget, sent)


async def test_a_view_gets_the_whole_scene_and_then_each_frame_until_it_says_goodbye(sent):
    scene, _, page = opened(sent, hurried=False)
    await show(scene, "nobody looks")
    assert sent == []
    await page.says("hello")
    assert sent[0][0]["view"] == "page"
    [scene_sent] = page.take("scene")
    assert unpack_records(scene_sent) == [(Record.CLEAR, b""), (Record.LINE, b"nobody looks")]
    for text in ("one", "two"):
        await show(scene, text)
        assert list(map(lines, page.take("frame"))) == [[text]]
    await page.says("bye")
    await show(scene, "nobody looks")
    assert sent == []


async def test_the_script_is_sent_to_whoever_asks_once_a_turn(sent):
    _, widget, _ = opened(sent)
    for _ in range(3):
        widget._handle_custom_msg({"type": "library", "view": "a"}, [])
    await settle()
    [(content, [script])] = sent
    assert content == {"type": "library"}
    assert b"MeshCat" in gzip.decompress(script)
    assert len(script) < 300_000


async def test_nothing_is_sent_to_a_page_that_does_not_answer_and_it_catches_up_with_the_whole_scene(sent):
    scene, widget, page = opened(sent, hurried=False)
    await page.says("hello")
    page.take("scene")
    for number in range(500):
        await show(scene, str(number))
    assert len(page.take("frame")) == FRAMES_AHEAD
    assert widget.views == 0
    await page.says("seen", frame=FRAMES_AHEAD)
    assert list(map(lines, page.take("scene"))) == [["499"]]
    await show(scene, "again")
    assert list(map(lines, page.take("frame"))) == [["again"]]


async def test_who_keeps_up_gets_everything_whoever_else_is_asleep(sent):
    scene, widget, awake = opened(sent, hurried=False)
    asleep = Page(widget, sent, "asleep")
    await awake.says("hello")
    await asleep.says("hello")
    for number in range(300):
        await show(scene, str(number))
        if number % 10 == 9:
            await awake.says("seen", frame=number + 1)
    assert len(awake.take("frame")) == 300
    assert widget.views == 1
    sent.clear()
    await asleep.says("seen", frame=10)
    assert lines(asleep.take("scene")[0]) == ["299"]


async def test_a_thousand_frames_a_second_are_merged_and_end_in_the_newest(sent):
    scene, _, page = opened(sent)
    await page.says("hello")
    transform = {"type": "set_transform", "path": "/box"}
    scene.send_message({"type": "set_object", "path": "/box", "object": {}})
    began = asyncio.get_running_loop().time()
    for number in range(1000):
        scene.send_message({**transform, "matrix": [float(number)] * 16})
        scene.line(str(number))
        scene.flush()
        await asyncio.sleep(0)
    seconds = asyncio.get_running_loop().time() - began
    frames = []
    await until(lambda: frames.extend(page.take("frame")) or (frames and lines(frames[-1]) == ["999"]))
    assert len(frames) <= 40 * seconds + 3
    counts = [len(unpack_records(frame)) for frame in frames]
    assert max(counts) <= 3
    assert sum(counts) <= 2 * len(frames) + 1


async def test_what_is_merged_shows_the_same_as_one_by_one(sent):
    """Deleting and drawing anew stay in their order; of a pose only the last one counts."""
    scene, widget, page = opened(sent)
    await page.says("hello")
    widget._next_at = asyncio.get_running_loop().time() + 60
    sent.clear()

    def tell(kind, path="/matrix", **fields):
        scene.send_message({"type": kind, "path": path, **fields})
        scene.flush()

    for number in (1, 2):
        tell("set_object", object={"n": number})
        tell("set_transform", matrix=[float(number)] * 16)
        if number == 1:
            tell("delete")
    for _ in range(3 * FRAMES_AHEAD):
        tell("set_transform", "/other", matrix=[3.0] * 16)
    widget._send_frame()
    said = commands(*page.take("frame"))
    assert [(message["type"], message["path"]) for message in said] == [
        ("set_object", "/matrix"),
        ("delete", "/matrix"),
        ("set_object", "/matrix"),
        ("set_transform", "/matrix"),
        ("set_transform", "/other"),
    ]
    assert said[2]["object"] == {"n": 2}
    assert said[3]["matrix"] == [2.0] * 16


async def test_a_busy_cell_is_seen_by_those_who_look_already(sent):
    scene, _, page = opened(sent)
    await page.says("hello")
    loop = asyncio.get_running_loop()
    while not page.take("frame"):  # the loop has no turn meanwhile
        scene.line(str(loop.time()))
        scene.flush()


async def test_messages_that_make_no_sense_are_ignored(sent):
    _, widget, _ = opened(sent)
    unfit = ({}, {"view": 3}, {"view": "x" * 1000}, {"view": "x", "frame": "many"}, {"view": "x", "type": "what"})
    for content in (None, "hello", *({"type": "hello", **fields} for fields in unfit)):
        widget._handle_custom_msg(content, [])
        await settle()
    assert sent == []
    assert widget.views == 0


async def test_a_frame_from_the_future_is_not_believed(sent):
    scene, _, page = opened(sent, hurried=False)
    await page.says("hello")
    await page.says("seen", frame=10**9)
    for number in range(200):
        await show(scene, str(number))
    assert len(page.take("frame")) == FRAMES_AHEAD


async def test_closing_twice_is_once_and_the_scene_goes_on_without(sent):
    scene, threads = Scene(), threading.active_count()
    view = View(scene)
    widget = SceneView(scene, "Tank & <b>")
    page = Page(widget, sent)
    await page.says("hello")
    assert repr(widget) == "SceneView('Tank & <b>')"
    assert threading.active_count() <= threads
    widget.close()
    widget.close()
    sent.clear()
    view.line("nobody looks")
    view.flush()
    await page.says("hello")
    assert sent == []
    assert scene._sinks == []


async def test_an_ended_one_shows_its_last_picture_also_to_those_who_come_later(sent):
    scene, widget, page = opened(sent)
    await page.says("hello")
    await show(scene, "first")
    scene.line("last")
    scene.flush()
    widget.end()
    widget.end()
    assert widget.ended
    assert lines(page.take("frame")[-1])[-1] == "last"
    scene.line("nobody looks")
    scene.flush()
    assert page.take("frame") == []
    page.take("scene")
    await page.says("hello")
    assert len(page.take("scene")) == 1


async def test_it_belongs_to_the_scenes_thread(sent):
    _, widget, _ = opened(sent)
    assert isinstance(raised_elsewhere(widget.close), WrongThreadError)


async def test_a_height_that_cannot_be_is_said(sent):
    with pytest.raises(TutorialError, match=r"cannot be 0 pixels high. Give a height such as 420"):
        SceneView(Scene(), height=0)


def test_without_an_event_loop_it_says_where_to_make_it():
    with pytest.raises(TutorialError, match=r"none runs here. Make it in a notebook"):
        SceneView(Scene())
