"""The page that shows a scene: served on this machine only, and what a browser makes of it."""

import asyncio
import base64
import html
import os
import socket
import struct
import threading
from contextlib import asynccontextmanager
from urllib.parse import urlsplit

import mujoco
import numpy as np
import psutil
import pytest
from browser import LIKE_A_CARD, PATIENCE, Witness, chromium, open_browser, pixels, red_spot, until
from tornado.httpclient import AsyncHTTPClient, HTTPClientError, HTTPRequest
from tornado.websocket import websocket_connect

from tutorial.errors import TutorialError
from tutorial.view import web
from tutorial.view.bodies import View
from tutorial.view.scene import Record, Scene, unpack_records
from tutorial.view.web import SceneServer


def run(main):
    asyncio.run(asyncio.wait_for(main(), 2 * PATIENCE))


def in_a_loop(test):
    """Run an async test to its end."""

    def wrapped():
        run(test)

    wrapped.__name__ = test.__name__
    wrapped.__doc__ = test.__doc__
    return wrapped


def port_of(server):
    return urlsplit(server.url).port


def socket_url(server):
    return server.url.replace("http", "ws") + "socket"


@asynccontextmanager
async def looking(server, **headers):
    names = {name.replace("_", "-"): value for name, value in headers.items()}
    client = await websocket_connect(HTTPRequest(socket_url(server), headers=names))
    try:
        yield client
    finally:
        client.close()


async def next_records(client):
    message = await client.read_message()
    assert message is not None, "the connection was closed"
    return unpack_records(message)


def lines(records):
    return [payload.decode() for kind, payload in records if kind is Record.LINE]


@in_a_loop
async def test_a_page_gets_the_whole_scene_first_and_then_each_frame():
    scene = Scene()
    scene.line("before")
    async with SceneServer(scene, 0) as server, looking(server) as client:
        whole = await next_records(client)
        assert whole[0] == (Record.CLEAR, b"")
        assert lines(whole) == ["before"]
        for text in ("one", "two"):
            scene.line(text)
            scene.flush()
            assert await next_records(client) == [(Record.LINE, text.encode())]


@in_a_loop
async def test_many_frames_within_one_turn_of_the_loop_all_arrive():
    """A cell that computes for a second and flushes as it goes shows all of it."""
    scene = Scene()
    async with SceneServer(scene, 0) as server, looking(server) as client:
        await next_records(client)
        for number in range(50):
            scene.line(str(number))
            scene.flush()
        assert [lines(await next_records(client)) for _ in range(50)] == [[str(n)] for n in range(50)]


@in_a_loop
async def test_pages_that_have_gone_are_forgotten():
    scene = Scene()
    async with SceneServer(scene, 0) as server:
        async with looking(server) as client:
            await next_records(client)
            assert server.browsers == 1
        while server.browsers:
            await asyncio.sleep(0)
        scene.line("nobody looks")
        scene.flush()
        assert scene._sinks == []


class StuckPage:
    """A page that is connected and does not read, until it is asked to."""

    async def connect(self, server):
        self.reader, self.writer = await asyncio.open_connection("127.0.0.1", port_of(server), limit=1024)
        key = base64.b64encode(os.urandom(16)).decode()
        self.writer.write(
            f"GET /socket HTTP/1.1\r\nHost: 127.0.0.1:{port_of(server)}\r\n"
            "Upgrade: websocket\r\nConnection: Upgrade\r\n"
            f"Sec-WebSocket-Key: {key}\r\nSec-WebSocket-Version: 13\r\n\r\n".encode()
        )
        await self.reader.readuntil(b"\r\n\r\n")

    async def read(self):
        _, length = await self.reader.readexactly(2)
        if length == 126:
            [length] = struct.unpack("!H", await self.reader.readexactly(2))
        elif length == 127:
            [length] = struct.unpack("!Q", await self.reader.readexactly(8))
        return await self.reader.readexactly(length)


@in_a_loop
async def test_a_page_that_is_stuck_makes_nothing_grow_and_catches_up():
    scene, page = Scene(), StuckPage()
    async with SceneServer(scene, 0) as server:
        await page.connect(server)
        size, frames = 100_000, 500
        for number in range(frames):
            scene.send_packed(("set_transform", "/a", ""), bytes(size))
            scene.line(str(number))
            scene.flush()
            await asyncio.sleep(0)
        received = 0
        while True:  # the last that it gets is the whole scene as it is by then
            message = await page.read()
            received += len(message)
            records = unpack_records(message)
            if lines(records) == [str(frames - 1)]:
                break
        assert records[0] == (Record.CLEAR, b"")
        assert received < 0.5 * frames * size
        scene.line("again frame by frame")
        scene.flush()
        assert unpack_records(await page.read()) == [(Record.LINE, b"again frame by frame")]
        page.writer.close()
        await page.writer.wait_closed()


@in_a_loop
async def test_a_stuck_page_does_not_hold_up_closing():
    scene, page = Scene(), StuckPage()
    async with SceneServer(scene, 0) as server:
        await page.connect(server)
        for _ in range(200):
            scene.send_packed(("set_transform", "/a", ""), bytes(100_000))
            scene.flush()
            await asyncio.sleep(0)
    SceneServer(scene, port_of(server)).close()
    page.writer.transport.abort()


@in_a_loop
async def test_it_listens_on_this_machine_only():
    with SceneServer(Scene(), 0) as server:
        addresses = {
            connection.laddr.ip
            for connection in psutil.Process().net_connections("inet")
            if connection.laddr.port == port_of(server)
        }
        assert addresses == {"127.0.0.1"}


@in_a_loop
async def test_it_needs_no_thread_and_no_process():
    threads, children = threading.active_count(), psutil.Process().children()
    page = StuckPage()
    async with SceneServer(Scene(), 0) as server:
        await page.connect(server)
        await page.read()
        assert threading.active_count() == threads
        assert psutil.Process().children() == children
        page.writer.close()
        await page.writer.wait_closed()


@in_a_loop
async def test_without_a_port_each_takes_the_first_that_is_free():
    with SceneServer(Scene()) as first, SceneServer(Scene()) as second:
        assert 7000 <= port_of(first) < port_of(second)
        assert first.url == f"http://127.0.0.1:{port_of(first)}/"


@in_a_loop
async def test_a_port_in_use_is_named_with_the_mend():
    with socket.create_server(("127.0.0.1", 0)) as other:
        port = other.getsockname()[1]
        with pytest.raises(TutorialError, match=f"cannot have port {port}: another program uses it already. Give "):
            SceneServer(Scene(), port)


@in_a_loop
async def test_a_port_that_there_is_not_is_told_the_range():
    with pytest.raises(TutorialError, match="cannot have port 70000: ports are 0 to 65535"):
        SceneServer(Scene(), 70000)


def test_when_all_ports_are_in_use_it_says_so(monkeypatch):
    async def main():
        with socket.create_server(("127.0.0.1", 0)) as other:
            monkeypatch.setattr(web, "FIRST_PORT", other.getsockname()[1])
            monkeypatch.setattr(web, "PORTS_TRIED", 1)
            with pytest.raises(TutorialError, match=r"are all in use. Give port=0"):
                SceneServer(Scene())

    run(main)


def test_without_an_event_loop_it_says_what_to_do():
    with pytest.raises(TutorialError, match=r"none runs here. Make it within asyncio.run\(main\(\)\)"):
        SceneServer(Scene(), 0)


@in_a_loop
async def test_closing_frees_the_port_at_once_and_twice_is_once():
    scene = Scene()
    async with SceneServer(scene, 0) as server, looking(server) as client:
        await next_records(client)
        server.close()
        with SceneServer(scene, port_of(server)) as again:
            assert again.url == server.url
        server.close()
        assert await client.read_message() is None
        assert (client.close_code, client.close_reason) == (1001, "the program has ended")
        assert scene._sinks == []
    server.close()


def test_closing_after_the_loop_has_ended_does_no_harm():
    servers = []

    async def main():
        servers.append(SceneServer(Scene(), 0))

    run(main)
    [server] = servers
    server.close()
    server.close()
    with socket.create_server(("127.0.0.1", port_of(server))):
        pass


@in_a_loop
async def test_only_its_own_page_may_look():
    async with SceneServer(Scene(), 0) as server:
        port = port_of(server)
        for name in ("127.0.0.1", "localhost"):  # localhost: also what a forwarded port looks like
            host = f"{name}:{port}"
            async with looking(server, Host=host, Origin=f"http://{host}") as client:
                await next_records(client)
        strangers = [
            {"Origin": "http://example.org"},
            {"Origin": f"http://localhost:{port}"},
            {"Origin": "http://127.0.0.1:1"},
            {"Origin": "null"},
            {"Host": "example.org", "Origin": "http://example.org"},
            {"Host": "example.org", "Origin": "http://example.org", "Sec_Fetch_Site": "same-origin"},
            {"Host": "example.org"},
        ]
        for headers in strangers:
            with pytest.raises(HTTPClientError, match="403"):
                async with looking(server, **headers):
                    pass


@in_a_loop
async def test_the_page_has_its_title_as_text():
    title = '<b>"Tank" & $title</b>'
    async with SceneServer(Scene(), 0, title) as server:
        page = await AsyncHTTPClient().fetch(server.url)
        assert f"<title>{html.escape(title)}</title>" in page.body.decode()
        assert "<b>" not in page.body.decode()
        assert "default-src 'self'" in page.headers["Content-Security-Policy"]


@in_a_loop
async def test_it_serves_no_other_files():
    async with SceneServer(Scene(), 0) as server:
        for path in (
            "static/../scene.py",
            "static/%2e%2e/scene.py",
            "meshcat/../../visualizer.py",
            "scene.py",
        ):
            with pytest.raises(HTTPClientError, match=r"40[34]"):
                await AsyncHTTPClient().fetch(server.url + path)


# What a learner sees. The camera looks along y, 4 m from the box and level with it.

RED_BOX = """
<mujoco>
  <worldbody>
    <body name="box">
      <freejoint name="box/FREE"/><geom type="box" size="0.3 0.3 0.3" rgba="0.9 0.05 0.05 1"/><site name="imu"/>
    </body>
  </worldbody>
  <sensor><gyro site="imu"/></sensor>
</mujoco>
"""
DISTANCE = 4.0
HALF_ANGLE = 0.46630765815  # tan(50 degrees / 2)


class RedBox:
    """A program that shows a red box."""

    def __init__(self):
        self.model = mujoco.MjModel.from_xml_string(RED_BOX)
        self.data = mujoco.MjData(self.model)
        self.scene = Scene()
        self.view = View(self.scene)
        self.view.add("box", self.model)
        self.look_at(0, 0)

    def look_at(self, x, z):
        """Have the camera look along y at a point in the plane of the box."""
        self.middle = x, z
        self.view.look_at((x, -DISTANCE, z), (x, 0, z))
        self.view.flush()

    def move(self, x, z):
        self.data.qpos[[0, 2]] = x, z
        mujoco.mj_kinematics(self.model, self.data)
        self.view.update("box", self.data)
        self.view.flush()

    async def turn(self, page, velocity):
        """Have the gyroscope say something [rad/s], and wait until the blue arrow above the box is as long as that."""
        self.data.sensordata[2] = velocity
        self.view.update("box", self.data)
        for _ in range(40):  # it is smoothed
            self.view.flush()

        async def is_there():
            picture = await pixels(page, "#pane")
            height, width, _ = picture.shape
            rows, columns = np.nonzero(picture[..., 2] - picture[..., 0] > 80)
            if not velocity or not len(rows):
                return not velocity and not len(rows)
            scale = height / 2 / HALF_ANGLE / DISTANCE
            x, z = self.data.qpos[[0, 2]] - self.middle
            ends = height / 2 - scale * (z + 0.45 + 0.1 * velocity), height / 2 - scale * (z + 0.45)
            found = rows.min(), rows.max()
            off = *(a - b for a, b in zip(found, ends, strict=True)), columns.mean() - width / 2 - scale * x
            return max(map(abs, off)) < 0.05 * height

        await until(is_there, f"the blue arrow says {velocity} rad/s")

    async def is_seen(self, page):
        """Wait until the red spot is where the box is, to 5 % of the picture's height."""

        async def is_there():
            picture = await pixels(page, "#pane")
            spot = red_spot(picture)
            height, width, _ = picture.shape
            scale = height / 2 / HALF_ANGLE / DISTANCE  # pixels per metre, at the box's middle
            x, z = self.data.qpos[[0, 2]] - self.middle
            expected = width / 2 + scale * x, height / 2 - scale * z
            return spot is not None and max(abs(a - b) for a, b in zip(spot, expected, strict=True)) < 0.05 * height

        await until(is_there, f"the box is seen at {self.data.qpos[:3]}")


@pytest.mark.browser
@pytest.mark.timeout(300)
def test_a_browser_shows_the_scene_as_it_is_and_after_a_restart():
    path = chromium()

    async def main():
        async with open_browser(path) as page:
            witness, box = Witness(page), RedBox()
            async with SceneServer(box.scene, 0, "Red & box") as server:
                await page.goto(server.url)
                assert await page.title() == "Red & box"
                await box.is_seen(page)
                for place in [(0.8, 0), (0, 0.7), (-0.8, -0.5)]:  # to the right, up, to the left and down
                    box.move(*place)
                    await box.is_seen(page)
                for velocity in (8.0, 4.0, 0.0):
                    await box.turn(page, velocity)
                box.scene.line("<b>5 %</b>")
                box.scene.flush()
                await page.get_by_text("<b>5 %</b>", exact=True).wait_for()
                await box.is_seen(page)  # also in what the line has left of the window
                box.scene.line("<b>5 %</b>", [("", "x"), ("<i>box</i>", "1.00\n\t")])
                box.scene.flush()
                await page.get_by_role("table").wait_for()
                cells = page.locator("#line").get_by_role("table").locator("th, td")
                assert await cells.all_text_contents() == ["", "x", "<i>box</i>", "1.00"]
                box.scene.line("<b>5 %</b>")
                box.scene.flush()
                await page.get_by_role("table").wait_for(state="detached")

                async def is_grey():
                    return red_spot(await pixels(page, "#pane")) is None

                box.view.show_stale("box", ["FREE"])
                box.view.flush()
                await until(is_grey, "the stale box is grey")
                await page.reload()
                await page.get_by_text("<b>5 %</b>", exact=True).wait_for()
                await until(is_grey, "the box is grey")
                box.view.show_stale("box", [])
                box.view.flush()
                await box.is_seen(page)
                await page.reload()
                await box.is_seen(page)
                assert await page.locator("#line").text_content() == "<b>5 %</b>"
                assert witness.complaints == []
            await page.get_by_role("heading", name="The program has ended.").wait_for()
            again = RedBox()
            again.move(0.5, 0.5)
            async with SceneServer(again.scene, port_of(server)):
                await page.locator("#curtain").wait_for(state="hidden")
                await again.is_seen(page)
                assert not await page.locator("#line").is_visible()
            own = {server.url.replace("http", scheme) for scheme in ("http", "ws")}
            foreign = [url for url in witness.requests if not url.startswith((*own, "data:", "blob:"))]
            assert foreign == []

    run(main)


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
def test_without_a_card_it_draws_less_and_never_when_nothing_has_changed(like_a_card):
    path = chromium()

    async def main():
        async with open_browser(path, scale=0.5) as page:
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

    run(main)


@pytest.mark.browser
@pytest.mark.timeout(300)
def test_a_view_turned_by_hand_stays_so_after_a_restart():
    path = chromium()
    where = "viewer.camera.position.toArray()"

    async def main():
        async with open_browser(path) as page:
            box = RedBox()
            async with SceneServer(box.scene, 0) as server:
                await page.goto(server.url)
                await box.is_seen(page)
                first = await page.evaluate(where)
                await page.mouse.move(400, 300)
                await page.mouse.down()
                await page.mouse.move(500, 350, steps=5)
                await page.mouse.up()

                async def is_turned():
                    return await page.evaluate(where) != first

                await until(is_turned, "the mouse has turned the view")
            turned = await page.evaluate(where)
            await page.locator("#curtain").wait_for(state="visible")
            async with SceneServer(box.scene, port_of(server)):
                await page.locator("#curtain").wait_for(state="hidden")
                assert await page.evaluate(where) == pytest.approx(turned, abs=0.01)
                box.look_at(0, 0)
                await box.is_seen(page)

    run(main)


@pytest.mark.browser
@pytest.mark.timeout(300)
def test_what_one_looks_at_is_in_the_middle_also_when_the_view_is_turned():
    path = chromium()
    where = "viewer.camera.position.toArray()"

    async def main():
        async with open_browser(path) as page:
            box = RedBox()
            async with SceneServer(box.scene, 0) as server:
                await page.goto(server.url)
                await box.is_seen(page)
                box.move(1.2, 0.7)
                box.look_at(1.2, 0.7)
                await box.is_seen(page)
                box.move(0.9, 0.4)
                await box.is_seen(page)
                box.move(1.2, 0.7)
                await box.is_seen(page)
                before = await page.evaluate(where)
                await page.mouse.move(400, 300)
                await page.mouse.down()
                await page.mouse.move(550, 400, steps=5)
                await page.mouse.up()

                async def is_turned():
                    return np.linalg.norm(np.subtract(await page.evaluate(where), before)) > 1

                await until(is_turned, "the mouse has turned the view")
                await box.is_seen(page)

    run(main)


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


LAMP_IS_LIT = "viewer.scene_tree.find(['Lights', 'Lamp', '<object>']).object.isLight === true"


def furnish_oddly(scene):
    """Change everything that a viewer has to begin with, and add to it."""
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
    scene.send_message({"type": "delete", "path": "/Lights/FillLight"})
    scene.flush()


@pytest.mark.browser
@pytest.mark.timeout(300)
def test_a_scene_that_is_shown_once_more_is_as_if_it_were_the_first_time():
    """The connection is lost and comes back, to the same program and then to another, without a complaint."""
    path = chromium()

    async def main():
        async with open_browser(path) as page:
            witness, box = Witness(page), RedBox()
            async with SceneServer(box.scene, 0) as server:
                await page.goto(server.url)
                await box.is_seen(page)
                for x in (0.3, 0.6, 0.9):
                    for browser in tuple(server._browsers):
                        browser._stream.close()
                    box.move(x, 0)  # nobody looks
                    await box.is_seen(page)
                furnish_oddly(box.scene)
                await until(lambda: page.evaluate(LAMP_IS_LIT), "the lamp is in the scene")
                assert witness.complaints == []
            again = RedBox()
            again.move(-0.5, 0.5)
            async with SceneServer(again.scene, port_of(server)) as server:
                await again.is_seen(page)
                complaints = [text for text in witness.complaints if "ERR_CONNECTION_REFUSED" not in text]
                assert complaints == []
                old = await page.evaluate(WHAT_THERE_IS_TO_SEE)
                await page.reload()
                await again.is_seen(page)
                assert old == await page.evaluate(WHAT_THERE_IS_TO_SEE)

    run(main)
