"""Serves the 3D view to browsers on this machine: for programs outside Jupyter.

The server is part of the program: no thread, no second process. It lives on the event loop of the main
thread and is gone when the program is, however it ends.
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
from tutorial.view.assets import STATIC, meshcats_viewer
from tutorial.view.scene import Scene

ADDRESS = "127.0.0.1"
PORTS = range(7000, 7100)
"""The first free one is taken."""

POLICY = (
    "default-src 'self'; img-src 'self' data: blob:; style-src 'self' 'unsafe-inline'; "
    "worker-src 'self' blob:; object-src 'none'; base-uri 'none'; form-action 'none'"
)
"""The browser lets the page load from its own origin only."""

BACKLOG = 1 << 18
"""What the system holds for one browser [bytes]. One that is further behind misses frames."""

OWN_HOSTS = r"127\.0\.0\.1|localhost"
"""The names by which a browser reaches this server. A page from elsewhere can have its own name lead to this machine
(DNS rebinding): it is not found here. One that asks by the right name is of another origin, and gets no socket."""

LARGEST_BODY = 1024
"""Of a request, which needs none [bytes]."""


class SceneServer(AbstractAsyncContextManager["SceneServer"]):
    """A page that shows a scene, on this machine only, as long as an ``async with`` block runs.

    It belongs to the scene's thread, whose event loop is running. Leaving the block closes the connections to the
    browsers and frees the port.

    Args:
        scene: what to show.
        port: where to serve; 0 for any that is free, None for the first free one from 7000 on.
        title: of the page.

    Attributes:
        url: where the page is, for instance ``http://127.0.0.1:7000/``.

    Raises:
        TutorialError: the port is in use or not allowed.
    """

    def __init__(self, scene: Scene, port: int | None = None, title: str = "Tank") -> None:
        self._browsers: set[_Browser] = set()
        pages = [
            (r"/", _Page),
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
    """Take the first of these ports, of this machine's own address, that can be had.

    Raises:
        TutorialError: there is none.
    """
    reason = ""
    for port in ports:
        try:
            return socket.create_server((ADDRESS, port))
        except OSError as error:
            reason = os.strerror(error.errno or 0).lower()
    which = f"port {ports[0]}" if len(ports) == 1 else f"any of the ports {ports[0]} to {ports[-1]}"
    raise TutorialError(f"the 3D view cannot have {which}: {reason}. Give another one, or none for the first free one.")


class _Protected(RequestHandler):
    def set_default_headers(self) -> None:
        self.set_header("Cache-Control", "no-cache")
        self.set_header("Content-Security-Policy", POLICY)
        self.set_header("X-Content-Type-Options", "nosniff")


class _Page(_Protected):
    def get(self) -> None:
        self.render("page.html", title=self.settings["title"])


class _Files(_Protected, StaticFileHandler):
    """A file of the page's."""


class _Browser(WebSocketHandler):
    """One page that looks at the scene: it gets the whole scene, then each frame that it can keep up with."""

    def initialize(self, scene: Scene, browsers: set[_Browser]) -> None:
        self.scene = scene
        self.browsers = browsers
        self.is_behind = False

    def open(self, *_args: str, **_kwargs: str) -> None:
        if self._stream.closed():  # the page has gone already
            return
        self.set_nodelay(True)
        self._stream.socket.setsockopt(socket.SOL_SOCKET, socket.SO_SNDBUF, BACKLOG)
        self.browsers.add(self)
        self._send(self.scene.snapshot())
        self.scene.attach(self.show)

    def on_message(self, message: str | bytes) -> None:
        """Ignore it: the page sends nothing."""

    def on_close(self) -> None:
        self.browsers.discard(self)
        self.scene.detach(self.show)

    def show(self, message: bytes) -> None:
        """Send one frame, unless an earlier one still waits: then all is sent when that is gone."""
        if self._stream.writing():
            self.is_behind = True
        else:
            self._send(message)

    def leave(self) -> None:
        """Close the connection, also if the other side does not answer."""
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
