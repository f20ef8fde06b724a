"""The door of the page's server: what is refused, when, and what is said of it."""

import asyncio
import logging
import socket

import pytest
from loops import in_a_loop
from serving import UPGRADE, ask, look, request, serving
from tornado.httpclient import AsyncHTTPClient, HTTPRequest
from tornado.websocket import websocket_connect

from tutorial.view import door, web
from tutorial.view.assets import meshcats_viewer
from tutorial.view.door import Refusals


def said(caplog):
    return [record.getMessage() for record in caplog.records if record.levelno >= logging.INFO]


NO_BODY, NOT_OWN, NOT_HERE = (
    "GET /: nothing here takes a body",
    "only the view's own page may ask",
    "' is not this machine",
)
REFUSED = [
    ("POST / | Host: HERE | Content-Length: 89000000", 405, "there is nothing here to change"),
    ("GET / | Host: HERE | Content-Length: 89000000", 413, NO_BODY),
    ("GET / | Host: HERE | Transfer-Encoding: chunked", 413, NO_BODY),
    ("GET / | Host: HERE | Origin: http://a.org", 403, NOT_OWN),
    ("GET /socket | Host: HERE | Origin: http://localhost:8000", 403, NOT_OWN),
    ("GET /socket | Host: HERE | Origin: null", 403, NOT_OWN),
    ("GET / | Host: a.org | Origin: http://a.org", 403, "its host 'a.org" + NOT_HERE),
    ("GET / | Host: 127.0.0.1@a.org", 403, "its host '127.0.0.1@a.org" + NOT_HERE),
    ("GET / | Host: [::1", 403, "its host '[::1" + NOT_HERE),
    ("GET / | Host: HERE | Host: a.org", 403, "a.org" + NOT_HERE),
    ("GET /", 403, "its host '" + NOT_HERE),
    ("GET /static/.. | Host: HERE", 403, ".. is not in root static directory"),
    ("GET / | Host: HERE | Content-Type: multipart/form-data", 400, "Invalid"),
    ("G\x1b[2J / | Host: HERE", 400, "Malformed HTTP message"),
    ("GET /static/a\0b | Host: HERE", 400, "Malformed HTTP message"),
]


@pytest.mark.parametrize(("text", "status", "why"), REFUSED)
@in_a_loop
async def test_a_request_is_judged_by_its_head_and_one_line_says_why_it_is_refused(caplog, text, status, why):
    caplog.set_level(logging.INFO)
    async with serving() as (_, port):
        assert (await ask(port, text)).split()[1] == str(status)
    [line] = said(caplog)
    assert line.startswith("the page of the 3D view has refused a request: ")
    assert why in line
    assert line.isprintable()


@in_a_loop
async def test_a_path_that_there_is_not_is_just_not_found(caplog):
    caplog.set_level(logging.INFO)
    odd = "a%00b", "%ff", "a" * 300, "%2e", "../scene.py", "%2e%2e/scene.py", "scene.py"
    async with serving() as (_, port):
        for path in ("/meshcat/", "/scene.py", *(f"/static/{each}" for each in odd)):
            assert await ask(port, f"GET {path} | Host: HERE") == "HTTP/1.1 404 Not Found"
    assert said(caplog) == []


@in_a_loop
async def test_its_own_page_may_look_also_through_a_forwarded_port():
    async with serving() as (server, port):
        for host in (f"127.0.0.1:{port}", "localhost:8000"):
            url = server.url.replace("http", "ws") + "socket"
            page = await websocket_connect(HTTPRequest(url, headers={"Host": host, "Origin": f"http://{host}"}))
            assert await page.read_message()
            assert server._http._deadlines == {}  # it may look for as long as it likes
            page.close()


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


@in_a_loop
async def test_of_too_many_connections_the_oldest_that_ask_nothing_make_room(monkeypatch):
    monkeypatch.setattr(door, "CONNECTIONS", 4)
    async with serving() as (server, port):
        reader, writer = await asyncio.open_connection("127.0.0.1", port, limit=1000)
        writer.write(request("GET /meshcat/main.js | Host: HERE | Connection: close", port))
        await reader.readuntil(b"200 OK\r\n")
        idle = [await asyncio.open_connection("127.0.0.1", port) for _ in range(10)]
        assert (await AsyncHTTPClient().fetch(server.url)).code == 200
        assert len(server._http._deadlines) <= 4
        assert await idle[0][0].read() == b""
        assert len(await reader.read()) > (meshcats_viewer() / "main.js").stat().st_size  # answered to the end
        for _, other in (*idle, (reader, writer)):
            other.close()


WHOLE = request("GET /meshcat/main.js | Host: HERE", 0)
SLOW = {"silent": b"", "unfinished": WHOLE[:-2], "not reading": WHOLE}


@pytest.mark.parametrize("sent", SLOW.values(), ids=SLOW)
@in_a_loop
async def test_who_does_not_come_to_an_end_is_hung_up(monkeypatch, sent):
    monkeypatch.setattr(door, "PATIENCE", 0.2)
    async with serving() as (server, port):
        with socket.create_connection(("127.0.0.1", port)) as slow:
            slow.sendall(sent)
            while not server._http._connections:
                await asyncio.sleep(0)
            while server._http._connections:
                await asyncio.sleep(0.01)
        assert server._http._deadlines == {}


@in_a_loop
async def test_unfinished_requests_do_not_hold_up_closing(monkeypatch):
    monkeypatch.setattr(door, "PATIENCE", 1e6)  # nobody hangs up but who closes
    async with serving() as (server, port):
        slow = [socket.create_connection(("127.0.0.1", port)) for _ in SLOW]
        for connection, sent in zip(slow, SLOW.values()):
            connection.sendall(sent)
        while len(server._http._connections) < len(slow):
            await asyncio.sleep(0)
    for connection in slow:
        connection.close()


@in_a_loop
async def test_who_says_something_is_no_page_and_hung_up():
    async with serving() as (server, port):
        for say in (lambda page: page.write_message("hello"), lambda page: page.ping(b"hello")):
            page = await look(server)
            await page.read_message()
            say(page)
            while await page.read_message() is not None:
                pass
            page.close()
            while server.browsers:
                await asyncio.sleep(0)
        assert server._refusals.count == 2
        await ask(port, "GET /socket | Host: HERE" + UPGRADE, b"\x89\x80abcd" * 1000)  # it is heard once
        while server.browsers or server._refusals.count == 2:
            await asyncio.sleep(0)
        assert server._refusals.count == 3


@in_a_loop
async def test_there_is_room_for_a_number_of_pages(monkeypatch):
    monkeypatch.setattr(web, "PAGES", 2)
    async with serving() as (server, port):
        pages = [await look(server) for _ in range(2)]
        assert await ask(port, "GET /socket | Host: HERE" + UPGRADE) == "HTTP/1.1 503 Service Unavailable"
        assert server.browsers == 2
        for page in pages:
            page.close()
