"""Serves the 3D view to browsers on this machine, for programs outside Jupyter.

The server has no separate thread or process. It runs on the main thread's event loop, so it ends with the program,
regardless of how the program ends.
"""

from __future__ import annotations

import asyncio
import os
import socket
from collections.abc import Sequence
from contextlib import AbstractAsyncContextManager
from typing import Any

from tornado.httpserver import HTTPServer
from tornado.routing import HostMatches
from tornado.web import Application, RequestHandler, StaticFileHandler
from tornado.websocket import WebSocketClosedError, WebSocketHandler

from tutorial.errors import TutorialError
from tutorial.view.assets import STATIC, VIEW, meshcats_viewer, read_static
from tutorial.view.scene import Scene

ADDRESS = "127.0.0.1"
PORTS = range(7000, 7100)
"""The server uses the first free port in this range."""

POLICY = (
    "default-src 'self'; img-src 'self' data: blob:; style-src 'self' 'unsafe-inline'; "
    "worker-src 'self' blob:; object-src 'none'; base-uri 'none'; form-action 'none'"
)
"""Makes the browser load files only from the page's own origin."""

BACKLOG = 1 << 18
"""The size of the socket's send buffer [bytes]. A browser that lags further behind than this skips frames."""

OWN_HOSTS = r"127\.0\.0\.1|localhost"
"""The host names that this server answers to. A foreign page whose own name resolves to this machine (DNS rebinding)
gets "not found". A foreign page that uses the right name has a different origin, so it cannot open a WebSocket."""

LARGEST_BODY = 1024
"""The size limit of a request body [bytes]; no request needs a body."""


class SceneServer(AbstractAsyncContextManager["SceneServer"]):
    """Serves a page that shows a scene, on this machine only, during an ``async with`` block.

    Use it on the scene's thread, while its event loop is running. Leaving the block closes all connections and frees
    the port.

    Args:
        scene: the scene to show.
        port: the port; 0 for any free port, None for the first free port from 7000 upwards.
        title: the title of the page.

    Attributes:
        url: the page's address, for instance ``http://127.0.0.1:7000/``.

    Raises:
        TutorialError: the port is in use, or the system does not allow its use.
    """

    def __init__(self, scene: Scene, port: int | None = None, title: str = "Tank") -> None:
        self._browsers: set[_Browser] = set()
        pages = [
            (r"/", _Page),
            (r"/page.js", _Script),
            (r"/socket", _Browser, {"scene": scene, "browsers": self._browsers}),
            (r"/static/([\w.-]+)", _Files, {"path": str(STATIC)}),
            (r"/meshcat/([\w.-]+)", _Files, {"path": str(meshcats_viewer())}),
        ]
        hosts, quiet = [(HostMatches(OWN_HOSTS), pages)], lambda _handler: None
        application = Application(hosts, title=title, template_path=str(STATIC), log_function=quiet)
        listener = _listen(PORTS if port is None else [port])
        self.url = f"http://{ADDRESS}:{listener.getsockname()[1]}/"
        self._http = HTTPServer(application, max_body_size=LARGEST_BODY)
        listener.setblocking(False)
        self._http.add_socket(listener)

    async def __aexit__(self, *_: object) -> None:
        self._http.stop()
        for browser in tuple(self._browsers):
            browser.leave()
        await self._http.close_all_connections()


def _listen(ports: Sequence[int]) -> socket.socket:
    """Listen on the first of the given ports that is available on the loopback address.

    Raises:
        TutorialError: no port is available.
    """
    reason = ""
    for port in ports:
        try:
            return socket.create_server((ADDRESS, port))
        except OSError as error:
            reason = os.strerror(error.errno or 0).lower()
    which = f"port {ports[0]}" if len(ports) == 1 else f"any of the ports {ports[0]} to {ports[-1]}"
    raise TutorialError(
        f"the 3D view cannot use {which}: {reason}. Specify a free port, or omit the port to use the first free one."
    )


class _Protected(RequestHandler):
    def set_default_headers(self) -> None:
        self.set_header("Cache-Control", "no-cache")
        self.set_header("Content-Security-Policy", POLICY)
        self.set_header("X-Content-Type-Options", "nosniff")


class _Page(_Protected):
    def get(self) -> None:
        self.render("page.html", title=self.settings["title"])


class _Script(_Protected):
    def get(self) -> None:
        self.set_header("Content-Type", "text/javascript; charset=utf-8")
        self.write(read_static(*VIEW, "page.js"))


class _Files(_Protected, StaticFileHandler):
    """Serves the files that the page loads."""


class _Browser(WebSocketHandler):
    """The connection to one page. It sends the whole scene, then every frame that the page can keep up with."""

    def initialize(self, scene: Scene, browsers: set[_Browser]) -> None:
        self.scene = scene
        self.browsers = browsers
        self.is_behind = False

    def open(self, *_args: str, **_kwargs: str) -> None:
        if self._stream.closed():  # the page is already closed
            return
        self.set_nodelay(True)
        self._stream.socket.setsockopt(socket.SOL_SOCKET, socket.SO_SNDBUF, BACKLOG)
        self.browsers.add(self)
        self._send(self.scene.snapshot())
        self.scene.attach(self.show)

    def on_message(self, message: str | bytes) -> None:
        """Ignore the message: the page never sends messages."""

    def on_close(self) -> None:
        self.browsers.discard(self)
        self.scene.detach(self.show)

    def show(self, message: bytes) -> None:
        """Send a frame. If an earlier frame is still being sent, send the whole scene afterwards instead."""
        if self._stream.writing():
            self.is_behind = True
        else:
            self._send(message)

    def leave(self) -> None:
        """Close the connection, even if the browser does not respond."""
        self.on_close()
        stream = self._stream
        self.close(1001, "the program has ended")
        stream.close()

    @property
    def _stream(self) -> Any:
        assert self.ws_connection is not None
        return self.ws_connection.stream

    def _send(self, message: bytes) -> None:
        try:
            self.write_message(message, binary=True).add_done_callback(self._sent)
        except WebSocketClosedError:
            self.on_close()

    def _sent(self, done: asyncio.Future[None]) -> None:
        if done.cancelled() or done.exception() is not None:
            self.on_close()
        elif self.is_behind and self in self.browsers:
            self.is_behind = False
            self._send(self.scene.snapshot())
