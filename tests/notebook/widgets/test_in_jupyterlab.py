"""The widgets in a real JupyterLab, in a browser, with a kernel."""

from pathlib import Path

import pytest
import red_box
from browser import red_is_at
from desk import lab_desk
from loops import until
from sensor_msgs.msg import Joy

from tutorial.ros.node_thread import NodeThread

pytestmark = [pytest.mark.browser, pytest.mark.timeout(300)]


@pytest.fixture(scope="module")
def lab(tmp_path_factory):
    with lab_desk(tmp_path_factory.mktemp("lab"), "/user/ada/", width=1000, height=1000) as lab:
        yield lab


@pytest.fixture
def desk(lab):
    """A JupyterLab and a page, which must report no errors, and show no notebook at the end."""
    lab.witness.complaints.clear()
    yield lab
    assert lab.witness.complaints == []
    lab.run(lab.page.goto("about:blank"))


# The joystick.

STICK = """
from tutorial.notebook.widgets.joystick import Joystick
stick = Joystick()
stick
"""
WAIT_WITHOUT_A_BREAK = """
import time
said = []
stick.on_msg(lambda *_: said.append(stick.axes[1]))
while said[-5:] != [1.0] * 5:  # the page keeps sending what is held
    time.sleep(0.001)
print("driven")
"""
GAMEPAD = """() => {
    const button = {pressed: false, value: 0}, held = {pressed: true, value: 1};
    const buttons = Array.from({length: 17}, (_, i) => (i === 0 || i === 7 || i === 15 ? held : button));
    const pad = {id: "Pad <b>", connected: true, mapping: "standard", axes: [0.5, -1, 0.25, 0], buttons};
    navigator.getGamepads = () => [null, pad];
}"""
STRANGE_GAMEPAD = """() => {
    navigator.getGamepads = () => [{id: "Wheel", connected: true, mapping: "", axes: [1, 1, 1], buttons: []}];
}"""


class Hands:
    """A learner's hands on the page, and their effect on ``joy``."""

    def __init__(self, page, heard):
        self.page, self.heard = page, heard

    async def drag(self, pad, x, y):
        """Press in the middle of a pad, and drag by x and y, to the right and down, in halves of the pad."""
        left, top = await self.point(pad, 0, 0)
        await self.page.mouse.move(left, top)
        await self.page.mouse.down()
        await self.page.mouse.move(*await self.point(pad, x, y), steps=3)

    async def point(self, pad, x, y):
        box = await self.page.locator(".tank-stick-pad").nth(pad).bounding_box()
        return box["x"] + box["width"] / 2 * (1 + x), box["y"] + box["height"] / 2 * (1 + y)

    async def cause(self, *axes):
        """Wait until the first two sticks have these axes; return that message."""

        async def is_so():
            return self.heard and list(self.heard[-1].axes[:4]) == pytest.approx(axes, abs=0.02)

        await until(is_so, f"the axes are {axes}")
        return self.heard[-1]


async def use_the_mouse(hands):
    await hands.drag(0, 0, -1)
    await hands.cause(0, 1, 0, 0)
    await hands.page.mouse.move(*await hands.point(0, 0.28, 0))
    await hands.cause(-0.5, 0, 0, 0)
    await hands.page.mouse.move(*await hands.point(0, 3, 4))  # beyond the pad: it captures the pointer
    await hands.cause(-0.6, -0.8, 0, 0)
    await hands.page.mouse.up()
    await hands.cause(0, 0, 0, 0)


async def use_two_fingers(hands):
    session = await hands.page.context.new_cdp_session(hands.page)

    async def touch(kind, *points):
        points = [{"x": x, "y": y, "id": i} for i, (x, y) in enumerate(points)]
        await session.send("Input.dispatchTouchEvent", {"type": kind, "touchPoints": points})

    await touch("touchStart", await hands.point(0, 0, 0), await hands.point(1, 0, 0))
    await touch("touchMove", await hands.point(0, -1, 0), await hands.point(1, 0, 1))
    await hands.cause(1, 0, 0, -1)
    await touch("touchEnd")
    await hands.cause(0, 0, 0, 0)


async def use_the_keys(hands, notebook):
    keyboard = hands.page.keyboard
    await hands.page.locator(".tank-joystick").focus()
    for key in ("w", "a", "ArrowRight", "d", "d"):  # two d in command mode would delete the cell
        await keyboard.down(key)
    await hands.cause(0, 1, -1, 0)
    await keyboard.up("d")
    await hands.cause(1, 1, -1, 0)
    await notebook.cell(1).locator(".cm-content").click()
    await hands.cause(0, 0, 0, 0)
    for key in ("w", "a", "ArrowRight"):
        await keyboard.up(key)
    assert await notebook.count() == 2


async def drive_a_busy_kernel(hands, notebook):
    await notebook.start(1)
    await hands.drag(0, 0, -1)
    await notebook.is_done()
    assert await notebook.text(1) == "driven\n"
    await hands.page.mouse.up()
    await hands.cause(0, 0, 0, 0)


async def use_gamepads(hands):
    await hands.page.evaluate(STRANGE_GAMEPAD)
    await hands.page.get_by_text("is not used: Wheel. Drag a stick").wait_for()
    await hands.cause(0, 0, 0, 0)
    await hands.page.evaluate(GAMEPAD)
    held = await hands.cause(-0.5, 1, -0.25, 0)
    assert list(held.axes[4:]) == [0, -1]
    assert list(held.buttons) == [1] + 13 * [0] + [1]
    await hands.page.get_by_text("Gamepad: Pad <b>", exact=True).wait_for()


def test_a_notebook_drives_by_mouse_fingers_keys_and_gamepad(desk):
    heard = []

    async def main():
        page = desk.page
        notebook = await desk.lab.open(page, desk.lab.write("stick.ipynb", [STICK, WAIT_WITHOUT_A_BREAK]))
        await notebook.run(0)
        hands = Hands(page, heard)
        await page.locator(".tank-joystick").scroll_into_view_if_needed()
        await hands.cause(0, 0, 0, 0)
        await use_the_mouse(hands)
        await use_two_fingers(hands)
        await use_the_keys(hands, notebook)
        await drive_a_busy_kernel(hands, notebook)
        await use_gamepads(hands)
        await notebook.reload()  # while the gamepad's stick is held
        await hands.cause(0, 0, 0, 0)
        await hands.drag(0, 0, -1)
        await hands.cause(0, 1, 0, 0)
        await page.mouse.up()
        await notebook.run_new("stick.end()")
        await page.get_by_text("Closed. Run the cell again to get a joystick.").wait_for()
        await notebook.save()

    with NodeThread("listener") as thread:
        thread.node.create_subscription(Joy, "joy", heard.append, 10)
        desk.run(main())


# The 3D view.

BOX = f"""
import logging, sys, threading
sys.path.append({str(Path(red_box.__file__).parent)!r})
from red_box import RedBox
from tutorial.notebook.widgets.scene_view import SceneView

box = RedBox()
box.say("<b>first</b>")
"""
SHOW = """
shown = SceneView(box.scene, "Red box")
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
    while shown.frame > min(tuple(shown._seen.values()), default=shown.frame) + 30:
        time.sleep(0.001)  # the page is slow, and what it shows is not to depend on that
    box.move(i / 200, 0)
    time.sleep(0.015)
time.sleep(600)
"""
WHERE_IS_THE_BOX = """(pane) => {
    const {viewer} = pane;
    return viewer.scene_tree.find(["Bodies", "box", "box"]).object.position.toArray();
}"""
TAKE_THE_BOX_AWAY = "(pane) => pane.viewer.delete_path(['Bodies'])"
WHERE_IS_THE_CAMERA = "(pane) => pane.viewer.camera.position.toArray()"
HOW_FAR_IS_IT_SCROLLED = "document.querySelector('.jp-WindowedPanel-outer').scrollTop"


def pane(number):
    return f".tank-view-pane >> nth={number}"


async def look_twice_and_move(page, notebook):
    await notebook.run(0)
    await notebook.run(1)
    await red_is_at(page, pane(0), 0, 0)
    assert await page.locator(".tank-view-line").text_content() == "<b>first</b>"
    await notebook.run_new("box.move(0.8, 0)")
    await notebook.run(2)  # as the second view, opened late
    for x, z in [(0.8, 0), (-0.8, 0.5)]:
        await notebook.run_new(f"box.move({x}, {z})")
        for number in (0, 1):
            await red_is_at(page, pane(number), x, z)
            position = await page.locator(pane(number)).evaluate(WHERE_IS_THE_BOX)
            assert position == pytest.approx([x, 0, z], abs=1e-6)


async def turn_by_keys(page, notebook):
    """Check that the view gets the keys and the wheel while it has the focus."""
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
    for key in "ddxx":  # in command mode these would delete the cell
        await page.keyboard.press(key)
    assert await notebook.count() == 4
    await page.keyboard.press("Escape")
    await notebook.run_new("box.look_at(0, 0)")


async def lose_the_connection(page, notebook, complaints):
    """Check that the page shows the scene again after each reconnection, even if the kernel is busy at the time.

    It also follows a cell that never lets the loop run, even for longer than a page may fall behind.
    """
    for x in (0.2, 0.4):
        await notebook.run_new(f"box.move({x}, 0)")
        await page.locator(pane(0)).evaluate(TAKE_THE_BOX_AWAY)
        await notebook.reconnect()
        await red_is_at(page, pane(0), x, 0)
    await notebook.start(3)
    await until(lambda: is_near_the_end(page), "the page shows the end of what a busy cell draws")
    assert await notebook.is_busy()
    await page.locator(pane(0)).evaluate(TAKE_THE_BOX_AWAY)
    for _ in range(2):
        await notebook.reconnect()
    await notebook.interrupt()
    await notebook.is_done()
    await notebook.run_new("box.move(0.7, 0)")
    await red_is_at(page, pane(0), 0.7, 0)
    assert [text for text in complaints if not text.startswith("Connection lost, reconnecting")] == []
    complaints.clear()


async def is_near_the_end(page):
    return (await page.locator(pane(0)).evaluate(WHERE_IS_THE_BOX))[0] > 0.9


async def close_one(page, notebook):
    """Check that a view removed from the page frees its graphics context, and tells the kernel."""
    await page.evaluate("(pane) => { window.oldContext = pane.viewer.renderer.getContext(); }",
                        await page.locator(pane(1)).element_handle())  # fmt: skip
    await notebook.clear(2)
    await page.locator(pane(1)).wait_for(state="detached")

    async def is_known():
        return await notebook.run_new("print(len(shown._seen))") == "1\n" and await page.evaluate(
            "oldContext.isContextLost()"
        )

    await until(is_known, "one of two views is left")


async def close_it(page, notebook):
    await notebook.run_new("shown.close(); shown.close()")
    await page.locator(".tank-view-pane").first.wait_for(state="detached")


async def show_it_without_webgl(page, notebook):
    await page.evaluate("HTMLCanvasElement.prototype.getContext = () => null")
    await notebook.run(1)
    await page.get_by_text("This browser cannot show 3D graphics.").wait_for()


def test_a_notebook_shows_the_scene_late_twice_and_reloaded_until_it_ends(desk):
    async def main():
        page, complaints = desk.page, desk.witness.complaints
        notebook = await desk.lab.open(page, desk.lab.write("box.ipynb", [BOX, SHOW, "shown", BUSY]))
        await look_twice_and_move(page, notebook)
        await turn_by_keys(page, notebook)
        await lose_the_connection(page, notebook, complaints)
        assert "subshell-" in await notebook.run_new("print(threads)")  # not the main thread
        await notebook.reload()
        await notebook.run_new("box.move(0.5, 0.5)")
        for number in (0, 1):
            await red_is_at(page, pane(number), 0.5, 0.5)
        await close_one(page, notebook)
        assert await notebook.run_new("print(complaints)") == "[]\n"
        await close_it(page, notebook)
        assert complaints == []
        await show_it_without_webgl(page, notebook)
        await notebook.restart()
        await page.get_by_text("The kernel has ended or was restarted.").wait_for()
        assert await notebook.errors() == ["cell 3: KeyboardInterrupt: "]
        await notebook.save()
        complaints.clear()  # JupyterLab warns that it lost the kernel

    desk.run(main())
