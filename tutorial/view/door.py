"""The door of the page's server: who may ask for what is told from a request's head, before anything else is read.

What is served is a handful of files and a socket, to pages of its own. None of that needs a body, so none is read. How
many connections there are at a time, how long a head may be and how long anything may take is bounded, and whatever is
refused is counted and said.
"""

from __future__ import annotations

import asyncio
import logging
import re
import time
from collections.abc import Awaitable
from http import HTTPStatus
from typing import Any

from tornado.httpserver import HTTPServer
from tornado.httputil import (
    HTTPConnection,
    HTTPHeaders,
    HTTPMessageDelegate,
    RequestStartLine,
    ResponseStartLine,
)
from tornado.iostream import IOStream
from tornado.log import gen_log
from tornado.web import Application

from tutorial.errors import printable

__all__ = ["GuardedServer", "Refusals"]

_log = logging.getLogger(__name__)

CONNECTIONS = 24
"""How many there may be beside those of the pages that are connected. A browser opens six; each takes the main loop
about a millisecond in a turn."""
LONGEST_HEAD = 16 * 1024
"""Of a request [bytes]; a browser's has about one thousand."""
PATIENCE = 30.0
"""How long a connection may wait for a request's head, and then for its answer to be taken [s]."""
BETWEEN_LINES = 10.0
"""From one line about what was refused to the next [s]."""

OWN_HOST = re.compile(r"(127\.0\.0\.1|localhost)(:[0-9]{1,5})?", re.IGNORECASE)
"""The names by which a browser reaches this server; of a port that is forwarded, the number may be another."""


class Refusals:
    """Counts what was refused, and says so: the first time at once, then once in a while how many more there were.

    What Tornado refuses by itself is counted, too, in the place of a line in its log for each.

    Attributes:
        count: how many there were.
    """

    def __init__(self) -> None:
        self.count = 0
        self._said = 0
        self._quiet_until = 0.0
        gen_log.addFilter(self._take_over)

    def add(self, what: str) -> None:
        """Count one more.

        Args:
            what: it was, and why it was refused; it may be from outside.
        """
        self.count += 1
        if time.monotonic() >= self._quiet_until:
            self._quiet_until = time.monotonic() + BETWEEN_LINES
            text = "a request:" if self.count == 1 else f"{self.count} requests by now, the last:"
            _log.warning("the page of the 3D view has refused %s %s", text, printable(what[:200]))
            self._said = self.count

    def close(self) -> None:
        """Say how many there were, if that was not said yet, and leave Tornado's log alone. Idempotent."""
        gen_log.removeFilter(self._take_over)
        if self.count > self._said:
            _log.warning("the page of the 3D view has refused %d requests in all", self.count)
            self._said = self.count

    def _take_over(self, record: logging.LogRecord) -> bool:
        is_refusal = record.levelno <= logging.WARNING
        if is_refusal:
            self.add(record.getMessage())
        return not is_refusal


class GuardedServer(HTTPServer):
    """Serves an application to whoever comes through the door.

    Where there are too many connections, the one that has been silent for longest makes room.

    Args:
        application: what is served.
        refusals: counts what is refused.
    """

    def initialize(self, application: Application, refusals: Refusals) -> None:  # type: ignore[override]
        """Take the place of ``__init__``, as in all of Tornado's configurable classes."""
        super().initialize(application, max_header_size=LONGEST_HEAD, max_buffer_size=1 << 20)
        self._refusals = refusals
        self._deadlines: dict[IOStream, asyncio.TimerHandle] = {}
        self._answering: set[IOStream] = set()

    def handle_stream(self, stream: IOStream, address: tuple[Any, ...]) -> None:
        """Serve a connection."""
        if len(self._deadlines) >= CONNECTIONS:
            self._refusals.add(f"there are {CONNECTIONS} connections already; the oldest is closed")
            self._hang_up(min(self._deadlines, key=self._answering.__contains__))  # the first of those that ask nothing
        self._be_patient(stream)
        super().handle_stream(stream, address)

    def start_request(self, server_conn: Any, request_conn: HTTPConnection) -> HTTPMessageDelegate:
        """Wait for one more request of a connection."""
        self._be_patient(server_conn.stream)
        return _Request(self, super().start_request(server_conn, request_conn), request_conn)

    def lets_in(self, connection: Any, line: RequestStartLine, headers: HTTPHeaders) -> bool:
        """Whether a request may pass; if not, it is answered, and its connection closed."""
        status, why = _judge(line, headers)
        if status == HTTPStatus.OK:
            self._be_patient(connection.stream)
            self._answering.add(connection.stream)
            return True
        self._refusals.add(f"{line.method} {line.path}: {why}")
        stream = connection.detach()
        head = f"HTTP/1.1 {status.value} {status.phrase}\r\nContent-Length: 0\r\nConnection: close\r\n\r\n"
        stream.write(head.encode())
        stream.close()
        return False

    def on_close(self, server_conn: Any) -> None:
        """Forget a connection: it was closed, or became a page's socket."""
        super().on_close(server_conn)
        self._forget(server_conn.stream)

    def _be_patient(self, stream: IOStream) -> None:
        self._forget(stream)
        self._deadlines[stream] = asyncio.get_running_loop().call_later(PATIENCE, self._hang_up, stream)

    def _hang_up(self, stream: IOStream) -> None:
        self._forget(stream)
        stream.close()

    def _forget(self, stream: IOStream) -> None:
        self._answering.discard(stream)
        if stream in self._deadlines:
            self._deadlines.pop(stream).cancel()


class _Request(HTTPMessageDelegate):
    """A request, as it comes: its head goes to the door first."""

    def __init__(self, server: GuardedServer, inner: HTTPMessageDelegate, connection: HTTPConnection) -> None:
        self._server = server
        self._inner = inner
        self._connection = connection

    def headers_received(
        self, start_line: RequestStartLine | ResponseStartLine, headers: HTTPHeaders
    ) -> Awaitable[None] | None:
        assert isinstance(start_line, RequestStartLine)
        if not self._server.lets_in(self._connection, start_line, headers):
            return None
        return self._inner.headers_received(start_line, headers)

    def finish(self) -> None:
        self._inner.finish()

    def on_connection_close(self) -> None:
        self._inner.on_connection_close()


def _judge(line: RequestStartLine, headers: HTTPHeaders) -> tuple[HTTPStatus, str]:
    """Judge a request by its head.

    The host is looked at as well as the origin: a page from elsewhere can have its own name lead to this machine (DNS
    rebinding), and then its origin and host agree.

    Returns:
        The status to answer with, and why; OK for one that may pass.
    """
    host = headers.get("Host", "")
    if not OWN_HOST.fullmatch(host):
        return HTTPStatus.FORBIDDEN, f"its host {host[:50]!r} is not this machine"
    if headers.get("Origin") not in (None, f"http://{host}"):
        return HTTPStatus.FORBIDDEN, f"only the view's own page may ask, not one of {headers['Origin'][:50]!r}"
    if line.method not in ("GET", "HEAD"):
        return HTTPStatus.METHOD_NOT_ALLOWED, "there is nothing here to change"
    if "Transfer-Encoding" in headers or headers.get("Content-Length", "0") != "0":
        return HTTPStatus.REQUEST_ENTITY_TOO_LARGE, "nothing here takes a body"
    return HTTPStatus.OK, ""
