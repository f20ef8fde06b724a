"""The 3D view in a cell: what it sends to whom, and when it stops."""

import asyncio
import gzip
import threading

import pytest
from browser import Witness, chromium, open_browser, pixels, red_spot, until
from lab import jupyter_lab

from tutorial.errors import TutorialError, WrongThreadError
from tutorial.notebook.widgets.scene_view import FRAMES_AHEAD, SceneView
from tutorial.view.bodies import View
from tutorial.view.scene import Record, Scene, unpack_command, unpack_records

PATIENCE = 60.0


def in_a_loop(test):
    """Run an async test to its end."""

    def wrapped(sent):
        asyncio.run(asyncio.wait_for(test(sent), PATIENCE))

    wrapped.__name__ = test.__name__
    wrapped.__doc__ = test.__doc__
    return wrapped


class Page:
    """A view of the widget on some page."""

    def __init__(self, widget, sent, name="page"):
        self.widget, self.sent, self.name = widget, sent, name

    async def says(self, kind, **fields):
        """Send a message, as ipykernel delivers it: on a thread without an event loop."""
        content = {"type": kind, "view": self.name, **fields}
        thread = threading.Thread(target=self.widget._handle_custom_msg, args=(content, []), name="subshell-1")
        thread.start()
        thread.join()
        await asyncio.sleep(0)  # the posted call
        await asyncio.sleep(0)

    def take(self, kind):
        """What came of a kind, since this was last asked: (content, records)."""
        found = [(content, unpack_records(buffers[0])) for content, buffers in self.sent if content["type"] == kind]
        mine = [pair for pair in found if pair[0].get("view", self.name) == self.name]
        self.sent[:] = [message for message in self.sent if message[0]["type"] != kind]
        return mine


def lines(records):
    return [payload.decode() for kind, payload in records if kind is Record.LINE]


async def show(scene, text):
    """Have a scene say something, late enough after the last time to be sent at once."""
    scene.line(text)
    scene.flush()
    await asyncio.sleep(0)


def unhurried(widget):
    """Let each frame be a message of its own."""
    widget._loop = type("Loop", (), {"now": 0.0, "time": lambda self: setattr(self, "now", self.now + 1) or self.now})()


async def looked_at(sent):
    """A scene, its widget, whose frames are messages of their own, and a page that has said hello."""
    scene = Scene()
    widget = SceneView(scene)
    unhurried(widget)
    page = Page(widget, sent)
    await page.says("hello")
    return scene, widget, page


@in_a_loop
async def test_a_view_gets_the_whole_scene_and_then_each_frame(sent):
    scene = Scene()
    scene.line("before")
    widget = SceneView(scene)
    unhurried(widget)
    page = Page(widget, sent)
    await show(scene, "nobody looks")
    assert sent == []
    await page.says("hello")
    [(content, whole)] = page.take("scene")
    assert content["view"] == "page"
    assert whole == [(Record.CLEAR, b""), (Record.LINE, b"nobody looks")]
    for text in ("one", "two"):
        await show(scene, text)
        assert [lines(records) for _, records in page.take("frame")] == [[text]]
    widget.close()


@in_a_loop
async def test_the_script_is_sent_to_whoever_asks_once_a_turn(sent):
    widget = SceneView(Scene())
    for _ in range(3):
        widget._handle_custom_msg({"type": "library", "view": "a"}, [])
    await asyncio.sleep(0)
    await asyncio.sleep(0)
    [(content, [script])] = sent
    assert content == {"type": "library"}
    assert b"MeshCat" in gzip.decompress(script)
    assert len(script) < 300_000
    widget.close()


@in_a_loop
async def test_nothing_is_sent_to_a_page_that_does_not_answer_and_it_catches_up_with_the_whole_scene(sent):
    scene, widget, page = await looked_at(sent)
    page.take("scene")
    for number in range(500):
        await show(scene, str(number))
    assert len(page.take("frame")) == FRAMES_AHEAD
    assert widget.views == 0
    await page.says("seen", frame=FRAMES_AHEAD)
    [(_, whole)] = page.take("scene")
    assert lines(whole) == ["499"]
    await show(scene, "again")
    assert [lines(records) for _, records in page.take("frame")] == [["again"]]
    widget.close()


@in_a_loop
async def test_who_keeps_up_gets_everything_whoever_else_is_asleep(sent):
    scene = Scene()
    widget = SceneView(scene)
    unhurried(widget)
    awake, asleep = Page(widget, sent, "awake"), Page(widget, sent, "asleep")
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
    assert lines(asleep.take("scene")[0][1]) == ["299"]
    widget.close()


@in_a_loop
async def test_after_goodbye_nothing_is_sent(sent):
    scene = Scene()
    widget = SceneView(scene)
    page = Page(widget, sent)
    await page.says("hello")
    await page.says("bye")
    sent.clear()
    await show(scene, "nobody looks")
    assert sent == []
    widget.close()


@in_a_loop
async def test_a_thousand_frames_a_second_are_merged_and_end_in_the_newest(sent):
    scene = Scene()
    widget = SceneView(scene)
    page = Page(widget, sent)
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
    while not frames or lines(frames[-1][1]) != ["999"]:
        await asyncio.sleep(0.001)
        frames += page.take("frame")
    assert len(frames) <= 40 * seconds + 3
    assert max(len(records) for _, records in frames) <= 3
    assert sum(len(records) for _, records in frames) <= 2 * len(frames) + 1
    widget.close()


@in_a_loop
async def test_what_is_merged_shows_the_same_as_one_by_one(sent):
    """Deleting and drawing anew stay in their order; of a pose only the last one counts."""
    scene, widget = Scene(), None
    widget = SceneView(scene)
    page = Page(widget, sent)
    await page.says("hello")
    widget._next_at = asyncio.get_running_loop().time() + 60
    sent.clear()

    def draw(path, number):
        scene.send_message({"type": "set_object", "path": path, "object": {"n": number}})
        scene.flush()
        scene.send_message({"type": "set_transform", "path": path, "matrix": [float(number)] * 16})
        scene.flush()

    draw("/matrix", 1)
    scene.send_message({"type": "delete", "path": "/matrix"})
    scene.flush()
    draw("/matrix", 2)
    for _ in range(3 * FRAMES_AHEAD):
        draw_again = {"type": "set_transform", "path": "/other", "matrix": [3.0] * 16}
        scene.send_message(draw_again)
        scene.flush()
    widget._send_frame()
    [(_, records)] = page.take("frame")
    said = [unpack_command(payload) for _, payload in records]
    assert [(message["type"], message["path"]) for message in said] == [
        ("set_object", "/matrix"),
        ("delete", "/matrix"),
        ("set_object", "/matrix"),
        ("set_transform", "/matrix"),
        ("set_transform", "/other"),
    ]
    assert said[2]["object"] == {"n": 2}
    assert said[3]["matrix"] == [2.0] * 16
    widget.close()


@in_a_loop
async def test_a_busy_cell_is_seen_by_those_who_look_already(sent):
    scene = Scene()
    widget = SceneView(scene)
    page = Page(widget, sent)
    await page.says("hello")
    loop = asyncio.get_running_loop()
    while not page.take("frame"):  # the loop has no turn meanwhile
        scene.line(str(loop.time()))
        scene.flush()
    widget.close()


@in_a_loop
async def test_messages_that_make_no_sense_are_ignored(sent):
    widget = SceneView(Scene())
    for content in (
        None,
        "hello",
        {"type": "hello"},
        {"type": "hello", "view": 3},
        {"type": "hello", "view": "x" * 1000},
        {"type": "seen", "view": "x", "frame": "many"},
        {"type": "what", "view": "x"},
    ):
        widget._handle_custom_msg(content, [])
        await asyncio.sleep(0)
        await asyncio.sleep(0)
    assert sent == []
    assert widget.views == 0
    widget.close()


@in_a_loop
async def test_a_frame_from_the_future_is_not_believed(sent):
    scene, widget, page = await looked_at(sent)
    await page.says("seen", frame=10**9)
    for number in range(200):
        await show(scene, str(number))
    assert len(page.take("frame")) == FRAMES_AHEAD
    widget.close()


@in_a_loop
async def test_closing_twice_is_once_and_the_scene_goes_on_without(sent):
    scene, threads = Scene(), threading.active_count()
    view = View(scene)
    widget = SceneView(scene, "Tank & <b>")
    page = Page(widget, sent)
    await page.says("hello")
    assert repr(widget) == "SceneView('Tank & <b>')"
    assert threading.active_count() == threads
    widget.close()
    widget.close()
    sent.clear()
    view.line("nobody looks")
    view.flush()
    await page.says("hello")
    assert sent == []
    assert scene._sinks == []


@in_a_loop
async def test_an_ended_one_shows_its_last_picture_also_to_those_who_come_later(sent):
    scene = Scene()
    widget = SceneView(scene)
    page = Page(widget, sent)
    await page.says("hello")
    await show(scene, "first")
    scene.line("last")
    scene.flush()
    widget.end()
    widget.end()
    assert widget.ended
    assert [line for _, records in page.take("frame") for line in lines(records)][-1] == "last"
    scene.line("nobody looks")
    scene.flush()
    assert page.take("frame") == []
    page.take("scene")
    await page.says("hello")
    assert len(page.take("scene")) == 1
    widget.close()


@in_a_loop
async def test_it_belongs_to_the_scenes_thread(sent):
    scene, errors = Scene(), []

    def close():
        try:
            widget.close()
        except WrongThreadError as error:
            errors.append(str(error))

    widget = SceneView(scene)
    thread = threading.Thread(target=close, name="other")
    thread.start()
    thread.join()
    [error] = errors
    assert "'other'" in error
    widget.close()


@in_a_loop
async def test_a_height_that_cannot_be_is_said(sent):
    with pytest.raises(TutorialError, match=r"cannot be 0 pixels high. Give a height such as 420"):
        SceneView(Scene(), height=0)


def test_without_an_event_loop_it_says_where_to_make_it():
    with pytest.raises(TutorialError, match=r"none runs here. Make it in a notebook"):
        SceneView(Scene())


# What a learner sees of it, in a JupyterLab. The camera looks along y, 4 m from the box and level with it.

BOX = """
import logging, threading
import mujoco
from tutorial.view.scene import Scene
from tutorial.view.bodies import View
from tutorial.notebook.widgets.scene_view import SceneView

model = mujoco.MjModel.from_xml_string('''<mujoco><worldbody>
  <body name="box"><freejoint/><geom type="box" size="0.3 0.3 0.3" rgba="0.9 0.05 0.05 1"/></body>
</worldbody></mujoco>''')
data = mujoco.MjData(model)
scene = Scene()
view = View(scene)
view.add("box", model)
view.look_at((0, -4, 0), (0, 0, 0))
view.line("<b>first</b>")

def move(x, z, line=""):
    data.qpos[[0, 2]] = x, z
    mujoco.mj_kinematics(model, data)
    view.update("box", data)
    view.line(line)
    view.flush()
"""
SHOW = """
shown = SceneView(scene, "Red box")
threads, complaints = set(), []
shown.on_msg(lambda *_: threads.add(threading.current_thread().name))
complaint = logging.Handler(logging.WARNING)
complaint.emit = lambda record: complaints.append(record.getMessage())
logging.getLogger("tutorial").addHandler(complaint)
shown
"""
BUSY = """
import time
for i in range(201):
    while shown._audience.frame > min(tuple(shown._audience._seen.values()), default=shown._audience.frame) + 30:
        time.sleep(0.001)  # the page is slow, and what it shows is not to depend on that
    move(i / 200, 0)
    time.sleep(0.015)
time.sleep(600)
"""
ROW = """
from tutorial.notebook import side_by_side

row = side_by_side(shown, SceneView(Scene(), "Empty"))
row
"""
HALF_ANGLE = 0.46630765815  # tan(50 degrees / 2)
WHERE_IS_THE_BOX = """(pane) => {
    const {viewer} = pane;
    return viewer.scene_tree.find(["Bodies", "box", "box"]).object.position.toArray();
}"""
TAKE_THE_BOX_AWAY = "(pane) => pane.viewer.delete_path(['Bodies'])"
WHERE_IS_THE_CAMERA = "(pane) => pane.viewer.camera.position.toArray()"
HOW_FAR_IS_IT_SCROLLED = "document.querySelector('.jp-WindowedPanel-outer').scrollTop"


def pane(number):
    return f".tank-view-pane >> nth={number}"


async def is_seen(page, number, x, z):
    """Wait until the red spot of a view is where the box is, to 5 % of the picture's height."""

    async def is_there():
        picture = await pixels(page, pane(number))
        spot = red_spot(picture)
        height, width, _ = picture.shape
        scale = height / 2 / HALF_ANGLE / 4
        expected = width / 2 + scale * x, height / 2 - scale * z
        return spot is not None and max(abs(a - b) for a, b in zip(spot, expected, strict=True)) < 0.05 * height

    await until(is_there, f"view {number} shows the box at {x}, {z}")


async def look_twice_and_move(page, notebook):
    await notebook.run(0)
    await notebook.run(1)
    await is_seen(page, 0, 0, 0)
    assert await page.locator(".tank-view-line").text_content() == "<b>first</b>"
    await notebook.run_new("move(0.8, 0)")
    await notebook.run(2)  # opened late, and as the second view
    for x, z in [(0.8, 0), (-0.8, 0.5)]:
        await notebook.run_new(f"move({x}, {z}, 'moved')")
        for number in (0, 1):
            await is_seen(page, number, x, z)
            position = await page.locator(pane(number)).evaluate(WHERE_IS_THE_BOX)
            assert position == pytest.approx([x, 0, z], abs=1e-6)


async def turn_by_keys(page, notebook):
    """Keys are the view's as long as it has the focus; so is the wheel."""
    view = page.locator(pane(0))
    await view.scroll_into_view_if_needed()
    await view.hover()
    before, scrolled = await view.evaluate(WHERE_IS_THE_CAMERA), await page.evaluate(HOW_FAR_IS_IT_SCROLLED)
    await page.mouse.wheel(0, 40)

    async def is_scrolled():
        return await page.evaluate(HOW_FAR_IS_IT_SCROLLED) != scrolled

    await until(is_scrolled, "the wheel has scrolled the notebook")
    assert await view.evaluate(WHERE_IS_THE_CAMERA) == before
    await view.focus()
    for key, axis in (("ArrowRight", 0), ("ArrowUp", 1)):
        await page.keyboard.press(key)
        after = await view.evaluate(WHERE_IS_THE_CAMERA)
        assert abs(after[axis] - before[axis]) > 0.1
        before = after
    await page.keyboard.press("+")
    assert sum(x * x for x in await view.evaluate(WHERE_IS_THE_CAMERA)) < 0.9 * sum(x * x for x in before)
    for key in "ddxx":  # in command mode these delete the cell
        await page.keyboard.press(key)
    assert await notebook.count() == 5
    await page.keyboard.press("Escape")
    await notebook.run_new("view.look_at((0, -4, 0), (0, 0, 0)); view.flush()")


async def lose_the_connection(page, notebook, witness):
    """The scene is shown once more whenever the connection is back, also when the kernel is busy meanwhile."""
    for x in (0.2, 0.4):
        await notebook.run_new(f"move({x}, 0)")
        await page.locator(pane(0)).evaluate(TAKE_THE_BOX_AWAY)
        await notebook.reconnect()
        await is_seen(page, 0, x, 0)
    await notebook.start(3)
    await until(lambda: is_near_the_end(page), "the kernel is busy")
    await page.locator(pane(0)).evaluate(TAKE_THE_BOX_AWAY)
    for _ in range(2):
        await notebook.reconnect()
    await notebook.interrupt()
    await notebook.is_done()
    await notebook.run_new("move(0.7, 0)")
    await is_seen(page, 0, 0.7, 0)
    assert [text for text in witness.complaints if not text.startswith("Connection lost, reconnecting")] == []
    witness.complaints.clear()


async def is_near_the_end(page):
    return (await page.locator(pane(0)).evaluate(WHERE_IS_THE_BOX))[0] > 0.9


async def watch_a_busy_cell(page, notebook):
    """A cell that gives the loop no turn is seen all along, longer than a page may fall behind."""
    await notebook.start(3)
    await until(lambda: is_near_the_end(page), "the page shows the end of what a busy cell draws")
    assert await notebook.is_busy()
    await notebook.interrupt()
    await notebook.is_done()


async def close_one(page, notebook):
    """A view that is taken off the page gives back its graphics, and says so to the kernel."""
    await page.evaluate("(pane) => { window.oldContext = pane.viewer.renderer.getContext(); }",
                        await page.locator(pane(1)).element_handle())  # fmt: skip
    await notebook.clear(2)
    await page.locator(pane(1)).wait_for(state="detached")

    async def is_known():
        return await notebook.run_new("print(shown.views)") == "1\n" and await page.evaluate(
            "oldContext.isContextLost()"
        )

    await until(is_known, "one of two views is left")


async def share_the_room(page, notebook):
    """Two views in a row are as wide as each other, whatever is said below one of them."""
    await page.set_viewport_size({"width": 1400, "height": 1000})
    await notebook.run_new(f"view.line({'much is said ' * 20!r}); view.flush()")
    await notebook.run(4)

    async def is_even():
        left, right = [await page.locator(pane(number)).bounding_box() for number in (-2, -1)]
        return max(abs(left[each] - right[each]) for each in ("y", "width")) < 1  # CSS pixel

    await until(is_even, "two views in a row are of one size")
    await notebook.run_new("row.children[1].close()")


async def close_it(page, notebook):
    await notebook.run_new("shown.close(); shown.close()")
    await page.locator(".tank-view-pane").first.wait_for(state="detached")


async def show_it_without_webgl(page, notebook):
    await page.evaluate("HTMLCanvasElement.prototype.getContext = () => null")
    await notebook.run(1)
    await page.get_by_text("This browser shows no 3D graphics.").wait_for()


@pytest.mark.browser
@pytest.mark.timeout(300)
def test_a_notebook_shows_the_scene_opened_late_twice_reloaded_and_says_when_it_ends(domain, tmp_path):
    path = chromium()

    async def main():
        async with jupyter_lab(tmp_path, "/user/ada/") as lab, open_browser(path, 900, 1000) as page:
            witness = Witness(page)
            notebook = await lab.open(page, lab.write("box.ipynb", [BOX, SHOW, "shown", BUSY, ROW]))
            await look_twice_and_move(page, notebook)
            await turn_by_keys(page, notebook)
            await lose_the_connection(page, notebook, witness)
            assert "subshell-" in await notebook.run_new("print(threads)")  # not the main thread
            await notebook.reload()
            await notebook.run_new("move(0.5, 0.5)")
            for number in (0, 1):
                await is_seen(page, number, 0.5, 0.5)
            await close_one(page, notebook)
            await watch_a_busy_cell(page, notebook)
            assert await notebook.run_new("print(complaints)") == "[]\n"
            await share_the_room(page, notebook)
            await close_it(page, notebook)
            assert witness.complaints == []
            await show_it_without_webgl(page, notebook)
            await notebook.restart()
            await page.get_by_text("The kernel has ended or was restarted.").wait_for()
            assert await notebook.errors() == ["cell 3: KeyboardInterrupt: "]
            own = (lab.root, lab.root.replace("http", "ws"), "data:", "blob:")
            assert [url for url in witness.requests if not url.startswith(own)] == []

    asyncio.run(asyncio.wait_for(main(), 4 * PATIENCE))
