"""A door for JupyterLab's server: whoever sends more than a few lines has to be logged in before they are read.

Jupyter reads what it is sent, up to 512 MB, and then asks who sent it: a dozen requests of a stranger on this machine,
or of a page from elsewhere, can take all of its memory.
"""

from __future__ import annotations

from collections.abc import Awaitable
from inspect import isawaitable
from typing import Any

from jupyter_server.base.handlers import JupyterHandler
from tornado.httputil import (
    HTTPConnection,
    HTTPHeaders,
    HTTPMessageDelegate,
    HTTPServerConnectionDelegate,
    HTTPServerRequest,
    RequestStartLine,
    ResponseStartLine,
)
from tornado.web import Application

__all__ = ["BODY_PATIENCE", "Door"]

SMALL = 1 << 16
"""What a stranger may send [bytes]: enough for the page that asks for a token."""
BODY_PATIENCE = 120.0
"""How long a body may take to come [s]; JupyterLab sends large files in pieces."""
REFUSAL = b"HTTP/1.1 403 Forbidden\r\nContent-Length: 0\r\nConnection: close\r\n\r\n"


class Door(HTTPServerConnectionDelegate):
    """Lets requests in to Jupyter's application.

    Args:
        application: the application, whose settings know who may be let in.
    """

    def __init__(self, application: Application) -> None:
        self.application = application

    def start_request(self, server_conn: object, request_conn: HTTPConnection) -> HTTPMessageDelegate:
        """Wait for one more request of a connection."""
        return _Request(self, self.application.start_request(server_conn, request_conn), request_conn)

    async def knows(self, request: HTTPServerRequest) -> bool:
        """Whether a request comes from somebody who is logged in."""
        user = self.application.settings["identity_provider"].get_user(JupyterHandler(self.application, request))
        return (await user if isawaitable(user) else user) is not None


class _Request(HTTPMessageDelegate):
    """A request, as it comes: its head goes to the door first."""

    def __init__(self, door: Door, inner: HTTPMessageDelegate, connection: Any) -> None:
        self._door = door
        self._inner = inner
        self._connection = connection

    def headers_received(
        self, start_line: RequestStartLine | ResponseStartLine, headers: HTTPHeaders
    ) -> Awaitable[None] | None:
        length = headers.get("Content-Length", "0")
        if "Transfer-Encoding" in headers or not length.isdecimal() or len(length) > 9 or int(length) > SMALL:
            return self._receive(start_line, headers)
        return self._inner.headers_received(start_line, headers)

    async def _receive(self, start_line: Any, headers: HTTPHeaders) -> None:
        request = HTTPServerRequest(start_line=start_line, headers=headers, connection=self._connection)
        if not await self._door.knows(request):
            stream = self._connection.detach()
            stream.write(REFUSAL)
            stream.close()
        elif (started := self._inner.headers_received(start_line, headers)) is not None:
            await started

    def data_received(self, chunk: bytes) -> Awaitable[None] | None:
        return self._inner.data_received(chunk)

    def finish(self) -> None:
        self._inner.finish()

    def on_connection_close(self) -> None:
        self._inner.on_connection_close()
