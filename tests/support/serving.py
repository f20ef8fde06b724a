"""What the tests need that ask the server of the 3D view for something."""

import asyncio
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from urllib.parse import urlsplit

from tornado.websocket import WebSocketClientConnection, websocket_connect

from tutorial.view.scene import Scene
from tutorial.view.web import SceneServer

UPGRADE = " | Upgrade: websocket | Connection: Upgrade | Sec-WebSocket-Key: a | Sec-WebSocket-Version: 13"
"""What a request for ``/socket`` has besides."""


def port_of(server: SceneServer) -> int:
    return urlsplit(server.url).port


@asynccontextmanager
async def serving() -> AsyncIterator[tuple[SceneServer, int]]:
    """Serve an empty scene; the server, and its port."""
    async with SceneServer(Scene(), 0) as server:
        yield server, port_of(server)


async def look(server: SceneServer) -> WebSocketClientConnection:
    """Look at a scene as a page does."""
    return await websocket_connect(server.url.replace("http", "ws") + "socket")


def request(text: str, port: int) -> bytes:
    """Write a request: its lines are parted by bars, and HERE stands for the server's own host."""
    first, *lines = text.replace("HERE", f"127.0.0.1:{port}").split(" | ")
    return "\r\n".join([f"{first} HTTP/1.1", *lines, "", ""]).encode("latin1")


async def ask(port: int, text: str) -> str:
    """Send a request, and return the first line of the answer."""
    reader, writer = await asyncio.open_connection("127.0.0.1", port)
    writer.write(request(text, port))
    line = await reader.readline()
    writer.close()
    return line.decode().strip()
