"""The 3D view in a cell."""

import gzip

import pytest
from ipywidgets import HTML
from scenes import lines, raised_elsewhere

from tutorial.errors import WrongThreadError
from tutorial.notebook.widgets.scene_view import SceneView
from tutorial.notebook.widgets.side_by_side import SideBySide
from tutorial.view.scene import Record, Scene, unpack_records

from .pages import say, settle


@pytest.fixture
def scene():
    return Scene()


def show(scene, text):
    scene.line(text)
    scene.flush()


def taken(sent, kind):
    """Return and clear the sent messages of a kind."""
    mine = [buffers[0] for content, buffers in sent if content["type"] == kind]
    sent.clear()
    return mine


async def test_a_page_gets_the_whole_scene_and_then_changes_even_during_a_busy_cell(scene, sent):
    widget = SceneView(scene)
    show(scene, "before")
    assert not scene.watched
    for _ in range(2):
        await say(widget, "hello")
        [whole] = taken(sent, "whole")
        assert unpack_records(whole) == [(Record.CLEAR, b""), (Record.LINE, b"before")]
        assert scene.watched
    for text in ("one", "two"):  # the loop does not run meanwhile
        show(scene, text)
    assert [lines(frame) for frame in taken(sent, "frame")] == [["one"], ["two"]]
    await say(widget, "bye")
    show(scene, "nobody looks")
    assert not scene.watched


async def test_pages_that_ask_together_share_one_script(scene, sent):
    widget = SceneView(scene)
    for _ in range(3):
        widget._handle_custom_msg({"type": "library"}, [])
    await settle()
    [(content, [script])] = sent
    assert content == {"type": "library"}
    assert b"MeshCat" in gzip.decompress(script)
    assert len(script) < 300_000


async def test_an_ended_view_still_shows_its_last_picture(scene, sent):
    widget = SceneView(scene, "Tank & <b>")
    show(scene, "last")
    widget.end()
    widget.end()
    assert widget.ended
    await say(widget, "hello")
    show(scene, "nobody looks")
    assert len(taken(sent, "whole")) == 1


async def test_closing_detaches_it_on_the_scenes_thread(scene, sent):
    widget = SceneView(scene)
    await say(widget, "hello")
    assert isinstance(raised_elsewhere(widget.close), WrongThreadError)
    widget.close()
    widget.close()
    sent.clear()
    show(scene, "nobody looks")
    await say(widget, "hello")
    assert (sent, scene._sinks) == ([], [])


async def test_beside_a_view_others_shrink_and_views_alone_wrap(scene):
    view, other, second = SceneView(scene), HTML(), SceneView(scene)
    row = SideBySide(view, other)
    assert row.layout.flex_flow == "row nowrap"
    assert (view.layout.min_width, other.layout.min_width) == ("55%", "0")
    assert SideBySide(view, second).layout.flex_flow == "row wrap"
