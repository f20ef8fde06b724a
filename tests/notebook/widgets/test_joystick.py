"""The joystick in a cell: what it publishes, and when it lets go."""

import asyncio
import threading

import pytest
from browser import PATIENCE as BROWSERS_PATIENCE
from browser import chromium, open_browser, until
from lab import jupyter_lab
from sensor_msgs.msg import Joy

from tutorial.notebook.widgets.joystick import PATIENCE, Joystick
from tutorial.ros.node_thread import NodeThread

NEUTRAL = (0.0,) * 6
HELD = [0.5, 1.0, -0.25, 0.0, 0.0, 0.125]
BUTTONS = [1] + [0] * 14


class Clock:
    """A clock that stands until it is moved."""

    now = 100.0

    def __call__(self):
        return self.now


class Listener:
    """Somebody who listens to ``joy``."""

    def __init__(self):
        self._thread = NodeThread("listener")
        self._news = threading.Condition()
        self.messages = []
        self._thread.node.create_subscription(Joy, "joy", self._on_joy, 10)

    def _on_joy(self, message):
        with self._news:
            self.messages.append(message)
            self._news.notify_all()

    def until(self, condition):
        """Wait for a message of which this is so, and return it."""
        with self._news:
            assert self._news.wait_for(lambda: any(map(condition, self.messages)), 60)
            return next(filter(condition, self.messages))

    def close(self):
        self._thread.close()


@pytest.fixture
def clock(monkeypatch):
    clock = Clock()
    monkeypatch.setattr(Joystick, "_clock", staticmethod(clock))
    return clock


@pytest.fixture
def joystick(domain, clock, sent):
    widget = Joystick()
    yield widget
    widget.close()


@pytest.fixture
def listener(domain):
    listener = Listener()
    yield listener
    listener.close()


def say(widget, axes=HELD, buttons=BUTTONS, kind="sticks"):
    """What a page says arrives on a thread of ipykernel's."""
    content = {"type": kind, "axes": axes, "buttons": buttons}
    thread = threading.Thread(target=widget._handle_custom_msg, args=(content, []), name="subshell-1")
    thread.start()
    thread.join()


def test_it_publishes_the_sticks_while_nobody_gives_it_a_turn(joystick, listener):
    say(joystick)
    message = listener.until(lambda joy: list(joy.axes) == HELD)
    assert list(message.buttons) == BUTTONS
    assert message.header.frame_id == "joy"
    assert message.header.stamp.sec > 0


def test_untouched_it_publishes_the_middle_fifty_times_a_second(joystick, listener):
    listener.until(lambda joy: tuple(joy.axes) == NEUTRAL and len(joy.buttons) == 15)
    assert [timer.timer_period_ns for timer in joystick._ros.node.timers] == [20_000_000]


def test_when_the_page_falls_silent_the_sticks_are_let_go(joystick, clock):
    say(joystick)
    clock.now += 0.9 * PATIENCE
    assert joystick.axes == tuple(HELD)
    say(joystick)  # the page repeats what is held
    clock.now += 0.9 * PATIENCE
    assert joystick.axes == tuple(HELD)
    clock.now += 0.2 * PATIENCE
    assert joystick.axes == NEUTRAL


@pytest.mark.parametrize(
    ("axes", "buttons"),
    [
        ([0.5] * 5, BUTTONS),
        ([0.5] * 7, BUTTONS),
        ([0.5] * 5 + [float("nan")], BUTTONS),
        ([0.5] * 5 + [float("inf")], BUTTONS),
        ([0.5] * 5 + [10**400], BUTTONS),
        ([0.5] * 5 + ["1"], BUTTONS),
        ([0.5] * 5 + [True], BUTTONS),
        ([0.5] * 5 + [None], BUTTONS),
        ("123456", BUTTONS),
        (None, BUTTONS),
        (HELD, [0] * 14),
        (HELD, [0.5] * 15),
        (HELD, "0" * 15),
        (HELD, None),
    ],
)
def test_messages_that_make_no_sense_change_nothing(joystick, axes, buttons):
    say(joystick, [0.25] * 6)
    say(joystick, axes, buttons)
    assert joystick.axes == (0.25,) * 6


def test_messages_of_another_kind_change_nothing(joystick):
    say(joystick, kind="hello")
    joystick._handle_custom_msg("sticks", [])
    assert joystick.axes == NEUTRAL


def test_values_beyond_the_stick_are_brought_to_its_end(joystick):
    say(joystick, [2, -3.5, 1, -1, 0, 1.0001], [2] * 15)
    assert joystick.axes == (1.0, -1.0, 1.0, -1.0, 0.0, 1.0)
    assert joystick._now().buttons == (1,) * 15


@pytest.mark.parametrize("leave", [Joystick.close, Joystick.end])
def test_closed_or_ended_it_lets_go_and_leaves_no_thread(domain, clock, sent, listener, leave):
    threads = threading.active_count()
    joystick = Joystick()
    say(joystick)
    listener.until(lambda joy: list(joy.axes) == HELD)
    leave(joystick)
    leave(joystick)
    say(joystick)
    assert joystick.ended
    assert joystick.axes == NEUTRAL
    listener.until(lambda joy: tuple(joy.axes) == NEUTRAL and joy is listener.messages[-1])
    assert threading.active_count() == threads
    assert (joystick.comm is None) == (leave is Joystick.close)
    joystick.close()


def test_its_text_is_the_same_in_every_run(joystick):
    assert repr(joystick) == "Joystick()"


def test_its_node_and_topic_can_be_remapped(domain, clock, sent):
    widget = Joystick(["--ros-args", "-r", "__node:=stick", "-r", "joy:=other"])
    assert widget._ros.node.get_name() == "stick"
    assert widget._publisher.topic_name == "/other"
    widget.close()


def test_a_node_that_cannot_be_leaves_nothing(domain, sent):
    threads = threading.active_count()
    with pytest.raises(Exception, match="parse remap rule"):
        Joystick(["--ros-args", "-r", "__node:=no name"])
    assert threading.active_count() == threads


# What a learner does with it, in a JupyterLab.

STICK = """
from tutorial.notebook.widgets.joystick import Joystick
stick = Joystick()
stick
"""
WAIT_WITHOUT_A_BREAK = """
import time
while stick.axes[1] < 0.9:
    time.sleep(0.001)
print("driven")
"""
GAMEPAD = """() => {
    const button = {pressed: false, value: 0}, held = {pressed: true, value: 1};
    const gamepad = {id: "Pad <b>", connected: true, mapping: "standard", axes: [0.5, -1, 0.25, 0],
        buttons: Array.from({length: 17}, (_, i) => (i === 0 || i === 7 || i === 15 ? held : button))};
    navigator.getGamepads = () => [null, gamepad];
}"""
STRANGE_GAMEPAD = """() => {
    const gamepad = {id: "Wheel", connected: true, mapping: "", axes: [1, 1, 1], buttons: []};
    navigator.getGamepads = () => [gamepad];
}"""
FREEZE_THE_PAGE = """() => setTimeout(() => {
    const request = new XMLHttpRequest();
    request.open("GET", "/until-it-thaws", false);  // the whole page waits for the answer
    request.send();
    window.isThawed = true;
})"""


class Hands:
    """What a learner's hands do on the page, and what comes of it on ``joy``."""

    def __init__(self, page, listener):
        self.page, self.listener = page, listener

    async def drag(self, pad, x, y):
        """Press in the middle of a pad, and go so far to the right and down, in halves of the pad."""
        left, top = await self.point(pad, 0, 0)
        await self.page.mouse.move(left, top)
        await self.page.mouse.down()
        await self.page.mouse.move(*await self.point(pad, x, y), steps=3)

    async def point(self, pad, x, y):
        box = await self.page.locator(".tank-stick-pad").nth(pad).bounding_box()
        return box["x"] + box["width"] / 2 * (1 + x), box["y"] + box["height"] / 2 * (1 + y)

    async def cause(self, *axes):
        """Wait until these are the axes of the first two sticks; return the message that says so."""
        found = []

        async def is_so():
            found[:] = self.listener.messages[-1:]
            return bool(found) and list(found[0].axes[:4]) == pytest.approx(axes, abs=0.02)

        await until(is_so, f"the axes are {axes}")
        return found[0]


async def use_the_mouse(hands):
    await hands.drag(0, 0, -1)
    await hands.cause(0, 1, 0, 0)
    await hands.page.mouse.move(*await hands.point(0, 0.28, 0))
    await hands.cause(-0.5, 0, 0, 0)
    await hands.page.mouse.move(*await hands.point(0, 3, 4))  # beyond the pad: the pointer is captured
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


async def freeze_the_page(hands):
    """What is held is let go while the page is silent, and taken up again."""
    thaw = asyncio.Event()

    async def answer(route):
        await thaw.wait()
        await route.fulfill(body="")

    await hands.page.route("**/until-it-thaws", answer)
    await hands.drag(0, 0, -1)
    await hands.cause(0, 1, 0, 0)
    await hands.page.evaluate(FREEZE_THE_PAGE)
    await hands.cause(0, 0, 0, 0)
    thaw.set()
    await hands.cause(0, 1, 0, 0)
    assert await hands.page.evaluate("window.isThawed")


@pytest.mark.browser
@pytest.mark.timeout(300)
def test_a_notebook_drives_by_mouse_fingers_keys_and_gamepad(domain, listener, tmp_path):
    path = chromium()

    async def main():
        async with jupyter_lab(tmp_path) as lab, open_browser(path, 1000, 900) as page:
            notebook = await lab.open(page, lab.write("stick.ipynb", [STICK, WAIT_WITHOUT_A_BREAK]))
            await notebook.run(0)
            hands = Hands(page, listener)
            await page.locator(".tank-joystick").scroll_into_view_if_needed()
            await hands.cause(0, 0, 0, 0)
            await use_the_mouse(hands)
            await use_two_fingers(hands)
            await use_the_keys(hands, notebook)
            await drive_a_busy_kernel(hands, notebook)
            await freeze_the_page(hands)
            await page.mouse.up()
            await page.evaluate(STRANGE_GAMEPAD)
            await page.get_by_text("is not used: Wheel. Drag a stick").wait_for()
            await hands.cause(0, 0, 0, 0)
            await page.evaluate(GAMEPAD)
            held = await hands.cause(-0.5, 1, -0.25, 0)
            assert list(held.axes[4:]) == [0, 1]
            assert list(held.buttons) == [1] + 13 * [0] + [1]
            await page.get_by_text("Gamepad: Pad <b>", exact=True).wait_for()
            await page.close()  # with the gamepad held
            await hands.cause(0, 0, 0, 0)

    asyncio.run(asyncio.wait_for(main(), 4 * BROWSERS_PATIENCE))
