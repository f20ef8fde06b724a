"""The page that shows a scene: its server, for this machine only, and its display in a browser."""

import asyncio
import socket
import threading
from urllib.parse import urlsplit

import numpy as np
import pytest
from browser import LIKE_A_CARD, Witness, chromium, open_browser, pixels, red_is_at, red_spot
from loops import in_a_loop, until
from red_box import RedBox
from scenes import lines
from tornado.websocket import websocket_connect

from tutorial.errors import TutorialError
from tutorial.view import web
from tutorial.view.scene import Record, Scene, unpack_records
from tutorial.view.web import SceneServer

UPGRADE = " | Upgrade: websocket | Connection: Upgrade | Sec-WebSocket-Key: a | Sec-WebSocket-Version: 13"
"""The additional headers of a request for ``/socket``."""


def port_of(server):
    return urlsplit(server.url).port


async def look(server):
    """Connect to a scene like a page."""
    return await websocket_connect(server.url.replace("http", "ws") + "socket")


async def ask(port, text):
    """Send a request, with | between lines and HERE for the server's host; return the first line of the answer."""
    first, *lines = text.replace("HERE", f"127.0.0.1:{port}").split(" | ")
    reader, writer = await asyncio.open_connection("127.0.0.1", port)
    writer.write("\r\n".join([f"{first} HTTP/1.1", *lines, "", ""]).encode("latin1"))
    line = await reader.readline()
    writer.close()
    return line.decode().strip()


@in_a_loop
async def test_a_page_gets_the_whole_scene_and_then_each_frame():
    scene = Scene()
    scene.line("before")
    async with SceneServer(scene, 0) as server:
        page = await look(server)
        whole = await page.read_message()
        assert unpack_records(whole)[0] == (Record.CLEAR, b"")
        assert lines(whole) == ["before"]
        for number in range(50):  # in one iteration of the loop, as in a cell that draws while it computes
            scene.line(str(number))
            scene.flush()
        assert [lines(await page.read_message()) for _ in range(50)] == [[str(n)] for n in range(50)]
        assert len(server._browsers) == 1
        page.close()
        while server._browsers:
            await asyncio.sleep(0)
        scene.line("nobody looks")
        scene.flush()
        assert scene._sinks == []


@in_a_loop
async def test_a_stuck_page_costs_no_memory_catches_up_and_does_not_block_close():
    scene, size, frames, threads = Scene(), 100_000, 500, threading.active_count()

    async def draw():
        for number in range(frames):
            scene.send_message({"type": "set_transform", "path": "/a", "matrix": np.zeros(size // 4)})
            scene.line(str(number))
            scene.flush()
            await asyncio.sleep(0)

    async with SceneServer(scene, 0) as server:
        assert threading.active_count() <= threads  # the server has no threads
        page = await look(server)  # it reads nothing until the test asks it to
        await draw()
        received, message = 0, b""
        while lines(message) != [str(frames - 1)]:  # the last message is the whole scene
            message = await page.read_message()
            received += len(message)
        assert unpack_records(message)[0] == (Record.CLEAR, b"")
        assert received < 0.5 * frames * size
        scene.line("again frame by frame")
        scene.flush()
        assert unpack_records(await page.read_message()) == [(Record.LINE, b"again frame by frame")]
        await draw()
    while await page.read_message() is not None:
        pass  # messages on the way
    page.close()


@in_a_loop
async def test_without_a_port_it_takes_the_first_free_one_on_this_machine():
    async with SceneServer(Scene()) as first, SceneServer(Scene()) as second:
        assert 7000 <= port_of(first) != port_of(second) >= 7000
        assert first.url == f"http://127.0.0.1:{port_of(first)}/"
        with pytest.raises(OSError, match=r"refused|assign"):
            socket.create_connection(("127.0.0.2", port_of(first)))


def test_an_unavailable_port_is_reported_with_the_fix(monkeypatch):
    with socket.create_server(("127.0.0.1", 0)) as other:
        taken = other.getsockname()[1]
        monkeypatch.setattr(web, "PORTS", range(taken, taken + 1))
        for port in (taken, None):
            with pytest.raises(TutorialError, match=f"cannot use port {taken}: address already in use. Specify "):
                SceneServer(Scene(), port)


@in_a_loop
async def test_closing_frees_the_port_and_tells_the_pages():
    scene = Scene()
    async with SceneServer(scene, 0) as server:
        page = await look(server)
        await page.read_message()
    async with SceneServer(scene, port_of(server)) as again:
        assert again.url == server.url
    assert await page.read_message() is None
    assert (page.close_code, page.close_reason) == (1001, "the program has ended")
    page.close()
    assert scene._sinks == []


REFUSED = [
    ("GET / | Host: a.org", 404),
    ("GET /socket | Host: a.org | Origin: http://a.org" + UPGRADE, 404),
    ("GET / | Host: 127x0x0x1", 404),
    ("GET / | Host: [::1", 404),
    ("GET / | Host: HERE | Host: a.org", 400),
    ("GET /socket | Host: HERE | Origin: http://a.org" + UPGRADE, 403),
    ("GET /socket | Host: HERE | Origin: http://localhost:8000" + UPGRADE, 403),
    ("GET /socket | Host: HERE | Origin: null" + UPGRADE, 403),
    ("POST / | Host: HERE | Content-Length: 89000000", 400),
    ("GET /static/.. | Host: HERE", 403),
    ("GET /static/%2e%2e/scene.py | Host: HERE", 404),
]


@pytest.mark.parametrize(("text", "status"), REFUSED)
@in_a_loop
async def test_foreign_pages_and_large_bodies_are_refused(text, status):
    async with SceneServer(Scene(), 0) as server:
        assert (await ask(port_of(server), text)).split()[1] == str(status)


@in_a_loop
async def test_its_own_page_is_accepted_also_through_a_forwarded_port():
    async with SceneServer(Scene(), 0) as server:
        port = port_of(server)
        for host in (f"127.0.0.1:{port}", "localhost:8000"):
            assert await ask(port, f"GET / | Host: {host}") == "HTTP/1.1 200 OK"
            answer = await ask(port, f"GET /socket | Host: {host} | Origin: http://{host}{UPGRADE}")
            assert answer == "HTTP/1.1 101 Switching Protocols"


async def is_seen(box, page):
    """Wait until the picture shows a red box where it is."""
    await red_is_at(page, "#pane", *box.place)


WHAT_THERE_IS_TO_SEE = """() => {
    const seen = [], controls = [];
    viewer.scene.traverse((each) => {
        const {type, name, visible, position, quaternion, scale, intensity, color, material} = each;
        const colours = [color, material?.color].map((each) => each?.getHex());
        const numbers = [position, quaternion, scale].flatMap((each) => each.toArray());
        if (!each.isCamera) seen.push([type, name, visible, intensity, ...colours, ...numbers].join());
    });
    for (const row of viewer.gui.domElement.querySelectorAll("li")) controls.push(row.className);
    const {top_color, bottom_color, visible} = viewer.scene_tree.find(["Background"]).object;
    return [seen.sort(), controls.sort(), [top_color, bottom_color, visible]];
}"""


SCRIPT = "</title></script><img src=x onerror=window.pwned=1>"
LAMP_IS_LIT = "viewer.scene_tree.find(['Lights', 'Lamp', '<object>']).object.isLight === true"


def furnish_oddly(scene):
    """Change everything that a viewer starts with, and add to it."""
    lamp = {"metadata": {"version": 4.5, "type": "Object"}, "object": {"type": "PointLight", "color": 255, "uuid": "l"}}
    for path, key, value in (
        ("/Grid", "scale", [3, 3, 3]),
        ("/Axes", "visible", True),
        ("/Background", "visible", False),
        ("/Lights/SpotLight", "position", [1, 2, 3]),
    ):
        scene.send_message({"type": "set_property", "path": path, "property": key, "value": value})
    for path in ("/Lights/Lamp", "/Grid/lamp"):
        scene.send_message({"type": "set_object", "path": path, "object": lamp})
    scene.flush()


@pytest.mark.browser
@pytest.mark.timeout(300)
@in_a_loop
async def test_a_browser_shows_the_scene_again_after_a_lost_connection_or_a_restart():
    async with open_browser(chromium()) as page:
        witness, box, line = Witness(page), RedBox(), page.locator("#line")
        async with SceneServer(box.scene, 0, SCRIPT) as server:
            response = await page.goto(server.url)
            assert "default-src 'self'" in response.headers["content-security-policy"]
            assert await page.title() == SCRIPT
            await is_seen(box, page)
            for place in [(0.8, 0), (0, 0.7), (-0.8, -0.5)]:  # right, up, left and down
                box.move(*place)
                await is_seen(box, page)
            box.say("<b>5 %</b>", [("", "x"), ("<i>box</i>", "1.00\n\t")])
            await line.get_by_role("table").wait_for()
            cells = line.get_by_role("table").locator("th, td")
            assert await cells.all_text_contents() == ["", "x", "<i>box</i>", "1.00"]
            box.say(SCRIPT)
            await line.get_by_role("table").wait_for(state="detached")
            await is_seen(box, page)  # also in the part of the window above the line
            await page.reload()
            await is_seen(box, page)
            assert await line.text_content() == SCRIPT
            for x in (0.3, 0.6, 0.9):
                for browser in tuple(server._browsers):
                    browser._stream.close()
                box.move(x, 0)  # without a page
                await is_seen(box, page)
            box.view.add(SCRIPT.replace("/", "_"), box.model)
            furnish_oddly(box.scene)
            await until(lambda: page.evaluate(LAMP_IS_LIT), "the lamp is in the scene")
            assert witness.complaints == []
            assert (await page.locator("img").count(), await page.evaluate("window.pwned")) == (0, None)
        await page.get_by_role("heading", name="The program has ended.").wait_for()
        again = RedBox(-0.5, 0.5)
        async with SceneServer(again.scene, port_of(server)):
            await page.locator("#curtain").wait_for(state="hidden")
            await is_seen(again, page)
            assert not await line.is_visible()
            assert [text for text in witness.complaints if "ERR_CONNECTION_REFUSED" not in text] == []
            old = await page.evaluate(WHAT_THERE_IS_TO_SEE)
            await page.reload()
            await is_seen(again, page)
            assert old == await page.evaluate(WHAT_THERE_IS_TO_SEE)  # as if it were shown for the first time
        own = {server.url.replace("http", scheme) for scheme in ("http", "ws")}
        assert [url for url in witness.requests if not url.startswith((*own, "data:", "blob:"))] == []


WHERE = "viewer.camera.position.toArray()"


@pytest.mark.browser
@pytest.mark.timeout(300)
@in_a_loop
async def test_a_turned_view_keeps_its_target_in_the_middle_and_survives_a_restart():
    async with open_browser(chromium()) as page:
        box = RedBox()
        async with SceneServer(box.scene, 0) as server:
            await page.goto(server.url)
            await is_seen(box, page)
            box.move(1.2, 0.7)
            box.look_at(1.2, 0.7)
            await is_seen(box, page)
            box.move(0.9, 0.4)
            await is_seen(box, page)
            box.move(1.2, 0.7)
            await is_seen(box, page)
            before = await page.evaluate(WHERE)
            await page.mouse.move(400, 300)
            await page.mouse.down()
            await page.mouse.move(550, 400, steps=5)
            await page.mouse.up()

            async def is_turned():
                return np.linalg.norm(np.subtract(await page.evaluate(WHERE), before)) > 1

            await until(is_turned, "the mouse has turned the view")
            await is_seen(box, page)
            turned = await page.evaluate(WHERE)
        await page.locator("#curtain").wait_for(state="visible")
        async with SceneServer(box.scene, port_of(server)):
            await page.locator("#curtain").wait_for(state="hidden")
            assert await page.evaluate(WHERE) == pytest.approx(turned, abs=0.01)
            box.move(0, 0)
            box.look_at(0, 0)
            await is_seen(box, page)


QUALITY = "[viewer.renderer.shadowMap.enabled, viewer.renderer.getContext().getContextAttributes().antialias]"
COUNT = """() => {
    const render = viewer.render.bind(viewer);
    window.drawn = [];
    viewer.render = () => { window.drawn.push(performance.now()); render(); };
}"""
LATER = """(frames) => new Promise((done) => {
    const wait = () => { if (frames-- > 0) requestAnimationFrame(wait); else done(); };
    wait();
})"""


@pytest.mark.browser
@pytest.mark.timeout(300)
@pytest.mark.parametrize("like_a_card", [True, False])
@in_a_loop
async def test_without_a_graphics_card_it_draws_less_and_only_changes(like_a_card):
    async with open_browser(chromium(), scale=0.5) as page:
        if like_a_card:
            await page.add_init_script(LIKE_A_CARD)
        witness, box = Witness(page), RedBox()
        async with SceneServer(box.scene, 0) as server:
            await page.goto(server.url)
            await until(lambda: page.evaluate("window.viewer?.needs_render === false"), "the scene is drawn")
            assert await page.evaluate(QUALITY) == [like_a_card, like_a_card]
            await page.evaluate(COUNT)
            for step in range(10):
                box.move(0.1 + step / 10, 0)
                await until(lambda n=step: page.evaluate("(n) => window.drawn.length > n", n), "one picture more")
            await until(lambda: page.evaluate("!viewer.needs_render"), "the last change is drawn")
            drawn = await page.evaluate("window.drawn")
            await page.evaluate(LATER, 20)
            assert await page.evaluate("window.drawn") == drawn
            if not like_a_card:
                assert np.diff(drawn).min() > 95  # [ms]: ten pictures a second
            assert witness.complaints == []


DISTANCE_OF_CAMERA = "viewer.camera.position.distanceTo(viewer.controls.target)"
AXES_ARE_VISIBLE = "viewer.scene_tree.find(['Bodies', 'box', 'box', 'frames', 'box.base_link']).object.visible"


@pytest.mark.browser
@pytest.mark.timeout(300)
@in_a_loop
async def test_camera_keeps_its_limits_follows_and_resets():
    async with open_browser(chromium()) as page:
        witness, box, evaluate = Witness(page), RedBox(0.8, 0.5), page.evaluate

        async def is_drawn(condition="true"):
            await until(lambda: evaluate(f"!viewer.needs_render && {condition}"), f"drawn, {condition}")

        async with SceneServer(box.scene, 0) as server:
            await page.goto(server.url)
            await is_seen(box, page)
            home, away = await evaluate(WHERE), await evaluate(DISTANCE_OF_CAMERA)
            await page.mouse.move(400, 300)
            for _ in range(3):  # each drag would take it far below the floor
                await page.mouse.down()
                await page.mouse.move(400, 20, steps=4)
                await page.mouse.up()
                await page.mouse.move(400, 300)
            await is_drawn()
            assert (await evaluate(WHERE))[1] >= 0
            assert await evaluate(DISTANCE_OF_CAMERA) == pytest.approx(away)
            for _ in range(60):
                await page.mouse.wheel(0, -100)
            await is_drawn(f"{DISTANCE_OF_CAMERA} < {0.1 * away}")
            assert red_spot(await pixels(page, "#pane")) is not None
            for _ in range(200):
                await page.mouse.wheel(0, 100)
            await is_drawn()
            assert await evaluate(DISTANCE_OF_CAMERA) == pytest.approx(4 * away)
            await page.mouse.dblclick(400, 300)
            await is_drawn()
            assert await evaluate(WHERE) == pytest.approx(home)
            await page.keyboard.press("f")
            for x, z in ((3.0, 0.2), (-4.0, 0.9)):
                box.move(x, z)
                await red_is_at(page, "#pane", 0, 0)
            await page.get_by_role("button", name="follow", pressed=True).click()
            await page.get_by_role("button", name="follow", pressed=False).wait_for()
            await page.keyboard.press("x")
            assert await evaluate(AXES_ARE_VISIBLE)
            await page.get_by_role("button", name="axes", pressed=True).click()
            assert not await evaluate(AXES_ARE_VISIBLE)
            await page.keyboard.press("r")
            await is_drawn()
            assert await evaluate(WHERE) == pytest.approx(home)
            assert witness.complaints == []
