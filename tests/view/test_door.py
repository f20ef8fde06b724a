"""The door of the page's server: what is refused, when, and what is said of it."""

import asyncio
import logging
import socket
import time
from contextlib import asynccontextmanager
from urllib.parse import urlsplit

import pytest
from browser import PATIENCE
from tornado.httpclient import AsyncHTTPClient
from tornado.websocket import websocket_connect

from tutorial.view import door, web
from tutorial.view.assets import meshcats_viewer
from tutorial.view.door import Refusals
from tutorial.view.scene import Scene
from tutorial.view.web import SceneServer


@asynccontextmanager
async def serving():
    async with asyncio.timeout(PATIENCE), SceneServer(Scene(), 0) as server:
        yield server, urlsplit(server.url).port


async def ask(port, text):
    """Send something, and return the first line of the answer."""
    reader, writer = await asyncio.open_connection("127.0.0.1", port)
    writer.write(text.replace("HERE", f"127.0.0.1:{port}").encode("latin1"))
    line = await reader.readline()
    writer.close()
    return line.decode().strip()


def said(caplog):
    return [record.getMessage() for record in caplog.records if record.levelno >= logging.INFO]


REFUSED = [
    (
        "POST / HTTP/1.1\r\nHost: HERE\r\nContent-Length: 89000000\r\n\r\n",
        405,
        "there is nothing here to change",
    ),
    ("GET / HTTP/1.1\r\nHost: HERE\r\nContent-Length: 89000000\r\n\r\n", 413, "GET /: nothing here takes a body"),
    ("GET / HTTP/1.1\r\nHost: HERE\r\nTransfer-Encoding: chunked\r\n\r\n", 413, "GET /: nothing here takes a body"),
    (
        "GET / HTTP/1.1\r\nHost: HERE\r\nOrigin: http://a.org\r\n\r\n",
        403,
        "only the view's own page may ask",
    ),
    ("GET / HTTP/1.1\r\nHost: a.org\r\nOrigin: http://a.org\r\n\r\n", 403, "its host 'a.org' is not this machine"),
    ("GET / HTTP/1.1\r\nHost: 127.0.0.1@a.org\r\n\r\n", 403, "its host '127.0.0.1@a.org' is not this machine"),
    ("GET / HTTP/1.1\r\nHost: [::1\r\n\r\n", 403, "its host '[::1' is not this machine"),
    ("GET /socket HTTP/1.1\r\nHost: [::1\r\n\r\n", 403, "its host '[::1' is not this machine"),
    ("GET / HTTP/1.1\r\nHost: HERE\r\nHost: a.org\r\n\r\n", 403, "a.org' is not this machine"),
    ("GET / HTTP/1.1\r\n\r\n", 403, "its host '' is not this machine"),
    ("GET /static/.. HTTP/1.1\r\nHost: HERE\r\n\r\n", 403, ".. is not in root static directory"),
    (
        "GET / HTTP/1.1\r\nHost: HERE\r\nContent-Type: multipart/form-data\r\n\r\n",
        400,
        "Invalid",
    ),
    ("G\x1b[2J / HTTP/1.1\r\nHost: HERE\r\n\r\n", 400, "Malformed HTTP message"),
    ("GET /static/a\0b HTTP/1.1\r\nHost: HERE\r\n\r\n", 400, "Malformed HTTP message"),
]


@pytest.mark.parametrize(("request_text", "status", "why"), REFUSED)
def test_a_request_is_judged_by_its_head_and_one_line_says_why_it_is_refused(caplog, request_text, status, why):
    async def main():
        async with serving() as (_server, port):
            line = await ask(port, request_text)
            assert int(line.split()[1]) == status

    caplog.set_level(logging.INFO)
    asyncio.run(main())
    [line] = said(caplog)
    assert line.startswith("the page of the 3D view has refused a request: ")
    assert why in line
    assert line.isprintable()


@pytest.mark.parametrize("path", ["/static/a%00b", "/static/%ff", f"/static/{'a' * 300}", "/meshcat/", "/static/%2e"])
def test_a_path_that_there_is_not_is_just_not_found(caplog, path):
    async def main():
        async with serving() as (_server, port):
            assert await ask(port, f"GET {path} HTTP/1.1\r\nHost: HERE\r\n\r\n") == "HTTP/1.1 404 Not Found"

    caplog.set_level(logging.INFO)
    asyncio.run(main())
    assert said(caplog) == []


def test_many_refusals_are_one_line_and_a_count(caplog, monkeypatch):
    refusals = Refusals()
    for number in range(1000):
        refusals.add(f"\x1b[2J{number}" + "x" * 1000)
    assert len(said(caplog)) == 1
    monkeypatch.setattr(refusals, "_quiet_until", 0.0)
    refusals.add("again")
    refusals.add("and again")
    refusals.close()
    refusals.close()
    first, second, last = said(caplog)
    assert first.startswith(r"the page of the 3D view has refused a request: \x1b[2J0xxx")
    assert len(first) < 300
    assert second == "the page of the 3D view has refused 1001 requests by now, the last: again"
    assert last == "the page of the 3D view has refused 1002 requests in all"


def test_of_too_many_connections_the_oldest_that_ask_nothing_make_room(monkeypatch):
    monkeypatch.setattr(door, "CONNECTIONS", 4)

    async def main():
        async with serving() as (server, port):
            reader, writer = await asyncio.open_connection("127.0.0.1", port, limit=1000)
            head = f"GET /meshcat/main.js HTTP/1.1\r\nHost: 127.0.0.1:{port}\r\nConnection: close\r\n\r\n"
            writer.write(head.encode())
            await reader.readuntil(b"200 OK\r\n")
            idle = [await asyncio.open_connection("127.0.0.1", port) for _ in range(10)]
            page = await AsyncHTTPClient().fetch(server.url)
            assert page.code == 200
            assert len(server._http._deadlines) <= 4
            assert await idle[0][0].read() == b""
            assert len(await reader.read()) > (meshcats_viewer() / "main.js").stat().st_size  # answered to the end
            writer.close()
            for _, other in idle:
                other.close()

    asyncio.run(main())


HEAD = "GET /meshcat/main.js HTTP/1.1\r\nHost: HERE\r\n"


@pytest.mark.parametrize("text", ["", HEAD, f"{HEAD}\r\n"], ids=["silent", "unfinished", "not reading"])
def test_who_does_not_come_to_an_end_is_hung_up(monkeypatch, text):
    monkeypatch.setattr(door, "PATIENCE", 0.2)

    async def main():
        async with serving() as (server, port):
            with socket.create_connection(("127.0.0.1", port)) as slow:
                slow.sendall(text.replace("HERE", f"127.0.0.1:{port}").encode())
                while not server._http._connections:
                    await asyncio.sleep(0)
                while server._http._connections:
                    await asyncio.sleep(0.01)
            assert server._http._deadlines == {}

    asyncio.run(main())


def test_a_page_may_look_as_long_as_it_likes(monkeypatch):
    monkeypatch.setattr(door, "PATIENCE", 0.2)

    async def main():
        async with serving() as (server, _port):
            page = await websocket_connect(server.url.replace("http", "ws") + "socket")
            await page.read_message()
            assert server._http._deadlines == {}
            await asyncio.sleep(0.3)
            assert server.browsers == 1
            page.close()

    asyncio.run(main())


UPGRADE = "Upgrade: websocket\r\nConnection: Upgrade\r\nSec-WebSocket-Key: a\r\nSec-WebSocket-Version: 13\r\n"


def test_who_says_something_is_no_page_and_hung_up():
    async def main():
        async with serving() as (server, _port):
            for say in (lambda page: page.write_message("hello"), lambda page: page.ping(b"hello")):
                page = await websocket_connect(server.url.replace("http", "ws") + "socket")
                await page.read_message()
                say(page)
                while await page.read_message() is not None:
                    pass
                page.close()
                while server.browsers:
                    await asyncio.sleep(0)
            assert server._refusals.count == 2

    asyncio.run(main())


def test_who_says_much_at_once_is_heard_once():
    pings = "\x89\x80abcd" * 1000

    async def main():
        async with serving() as (server, port):
            await ask(port, f"GET /socket HTTP/1.1\r\nHost: HERE\r\n{UPGRADE}\r\n{pings}")
            while server.browsers or not server._refusals.count:
                await asyncio.sleep(0)
            assert server._refusals.count == 1

    asyncio.run(main())


def test_there_is_room_for_a_number_of_pages(monkeypatch):
    monkeypatch.setattr(web, "PAGES", 2)

    async def main():
        async with serving() as (server, port):
            pages = [await websocket_connect(server.url.replace("http", "ws") + "socket") for _ in range(2)]
            line = await ask(port, f"GET /socket HTTP/1.1\r\nHost: HERE\r\n{UPGRADE}\r\n")
            assert line == "HTTP/1.1 503 Service Unavailable"
            assert server.browsers == 2
            for page in pages:
                page.close()

    asyncio.run(main())


def test_unfinished_requests_do_not_hold_up_closing():
    async def main():
        async with serving() as (_server, port):
            slow = []
            for text in ("", HEAD, f"{HEAD}\r\n", "POST / HTTP/1.1\r\n"):
                slow.append(socket.create_connection(("127.0.0.1", port)))
                slow[-1].sendall(text.replace("HERE", f"127.0.0.1:{port}").encode())
            while len(_server._http._connections) < len(slow):
                await asyncio.sleep(0)
            began = time.monotonic()
        assert time.monotonic() - began < 1
        for connection in slow:
            connection.close()

    asyncio.run(main())
