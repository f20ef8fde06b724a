"""The JupyterHub of ``make hub``, for the tests, and students who log in and run a notebook."""

import json
import os
import random
import secrets
import signal
import socket
import subprocess
import sys
import uuid
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass, field
from http.client import HTTPResponse
from http.cookiejar import CookieJar
from pathlib import Path
from urllib.parse import urlencode
from urllib.request import HTTPCookieProcessor, Request, build_opener

import nbformat
import psutil
from programs import TIMEOUT, answer, marked, until
from websocket import WebSocket, WebSocketConnectionClosedException, WebSocketTimeoutException, create_connection

CHECKOUT = Path(__file__).parents[2]
CONFIG = CHECKOUT / "tests/hub/jupyterhub_config.py"
PROXY = CHECKOUT / ".venv/node_modules/.bin/configurable-http-proxy"
NOTEBOOK = "notebooks/1_tank_controller.ipynb"
START = "program.start()"
LONG = 300.0  # [s] how long a server or a cell can take: all students start at the same time


def cells() -> tuple[list[str], list[str]]:
    """Return the code cells of notebook 1: those up to its running tank, and those after it."""
    notebook = nbformat.read(CHECKOUT / NOTEBOOK, as_version=4)
    sources = [cell.source for cell in notebook.cells if cell.cell_type == "code"]
    return sources[: (i := sources.index(START) + 1)], sources[i:]


@dataclass
class Hub:
    """A running JupyterHub.

    Attributes:
        root: its address.
        mark: the mark of all its processes.
        password: all students' password.
        sockets: the connections to its kernels.
    """

    root: str
    mark: str
    password: str
    sockets: list[WebSocket] = field(default_factory=list)

    def processes(self) -> list[psutil.Process]:
        """Return all its running processes: hub, proxy, servers and kernels."""
        return marked(self.mark)


@contextmanager
def hub(folder: Path) -> Iterator[Hub]:
    """Run a JupyterHub in a folder, and end it and everything that it has started with Ctrl-C."""
    public, api, proxy = (f"http://127.0.0.1:{port}" for port in _free_ports(3))
    ports = (
        f"--JupyterHub.bind_url={public}",
        f"--JupyterHub.hub_bind_url={api}",
        f"--ConfigurableHTTPProxy.api_url={proxy}",
    )
    running = Hub(public, uuid.uuid4().hex, secrets.token_urlsafe())
    environment = {name: value for name, value in os.environ.items() if name != "ROS_DOMAIN_ID"}
    environment |= {"TANK_TEST_MARK": running.mark, "TANK_HUB_PASSWORD": running.password}
    command = [sys.executable, "-m", "jupyterhub", "-f", str(CONFIG), *ports]
    with (folder / "hub.log").open("wb") as log:
        started = subprocess.Popen(command, cwd=folder, env=environment, stdout=log, stderr=log)
    try:
        said = (folder / "hub.log").read_text
        until(
            lambda: started.poll() is not None or "JupyterHub is now running" in said(), "the hub and its proxy", LONG
        )
        assert started.poll() is None, said()
        yield running
        started.send_signal(signal.SIGINT)
        started.wait(TIMEOUT)
        until(lambda: not running.processes(), f"the end of {running.processes()}")
    finally:
        for each in running.sockets:
            each.shutdown()
        for process in running.processes():
            process.kill()
        started.wait()


class Student:
    """A student who logs in to a hub, and runs cells in a notebook's kernel, like JupyterLab.

    Args:
        at: the hub.
        name: any name.
    """

    def __init__(self, at: Hub, name: str) -> None:
        self._hub, self._name = at, name
        self._token = self._log_in()
        self._wait_for_server()
        wanted = {"path": NOTEBOOK, "type": "notebook", "name": "", "kernel": {"name": "python3"}}
        with self._ask(f"/user/{name}/api/sessions", wanted) as reply:
            kernel = json.load(reply)["kernel"]["id"]
        self._session = uuid.uuid4().hex
        self._connect(f"{at.root.replace('http', 'ws')}/user/{name}/api/kernels/{kernel}/channels")

    def run(self, source: str) -> str:
        """Run a cell, wait until it is done, and return its output; fail if it raised."""
        asked = self._send("execute_request", code=source, silent=False, store_history=True, allow_stdin=False)
        text, ended = "", set()
        while ended != {"execute_reply", "idle"}:
            said = self._socket.recv()
            if not said:
                raise WebSocketConnectionClosedException(f"{self._name}: the server has closed the connection")
            if isinstance(said, bytes):  # a widget's message with binary parts
                continue
            message = json.loads(said)
            if message["parent_header"].get("msg_id") != asked:
                continue
            content = message["content"]
            text += content.get("text", "")
            if message["msg_type"] == "execute_reply":
                assert content["status"] == "ok", f"{self._name}: {content['ename']}: {content['evalue']}, in\n{source}"
            ended |= {message["msg_type"], content.get("execution_state")} & {"execute_reply", "idle"}
        return text

    def look(self, comm: str, word: str) -> None:
        """Send a message as a widget's page, for instance ``hello`` or ``bye``."""
        self._send("comm_msg", comm_id=comm, data={"method": "custom", "content": {"type": word, "view": "page"}})

    def processes(self) -> list[psutil.Process]:
        """Return the student's server and kernels, with their descendants."""
        return [each for each in self._hub.processes() if each.environ().get("JUPYTERHUB_USER") == self._name]

    def _log_in(self) -> str:
        """Log in with the form, which starts the server, and return a token for the later requests."""
        jar = CookieJar()
        opener = build_opener(HTTPCookieProcessor(jar))
        form = f"{self._hub.root}/hub/login?next="

        def xsrf() -> str:
            return next(cookie.value or "" for cookie in jar if cookie.name == "_xsrf" and cookie.path == "/hub/")

        opener.open(form, timeout=TIMEOUT).close()
        words = {"username": self._name, "password": self._hub.password, "_xsrf": xsrf()}
        opener.open(form, urlencode(words).encode(), timeout=TIMEOUT).close()
        headers = {"Content-Type": "application/json", "X-XSRFToken": xsrf()}
        wanted = Request(f"{self._hub.root}/hub/api/users/{self._name}/tokens", b"{}", headers)
        with opener.open(wanted, timeout=TIMEOUT) as reply:
            return str(json.load(reply)["token"])

    def _wait_for_server(self) -> None:
        """Follow the hub's reports of the server's start until it is ready."""
        with self._ask(f"/hub/api/users/{self._name}/server/progress") as events:
            said = [json.loads(line.removeprefix(b"data:")) for line in events if line.startswith(b"data:")]
        assert said[-1].get("ready"), f"{self._name}: {said[-1]}"

    def _connect(self, address: str) -> None:
        """Connect to the kernel, again if it restarts: a different process may have taken one of its ports."""
        while True:
            self._socket = create_connection(address, TIMEOUT, header={"Authorization": f"token {self._token}"})
            self._hub.sockets.append(self._socket)
            with suppress(WebSocketConnectionClosedException, WebSocketTimeoutException):
                self.run("")
                self._socket.settimeout(LONG)
                return

    def _ask(self, path: str, data: object = None) -> HTTPResponse:
        headers = {"Authorization": f"token {self._token}", "Content-Type": "application/json"}
        body = None if data is None else json.dumps(data).encode()
        return answer(Request(self._hub.root + path, body, headers), LONG)

    def _send(self, kind: str, **content: object) -> str:
        number = uuid.uuid4().hex
        header = {
            "msg_id": number,
            "msg_type": kind,
            "session": self._session,
            "username": self._name,
            "version": "5.3",
        }
        message = {"header": header, "parent_header": {}, "metadata": {}, "content": content, "channel": "shell"}
        self._socket.send(json.dumps(message))
        return number


def _free_ports(count: int) -> list[int]:
    """Return ports that nobody listens on, below those that the system gives to connections."""
    ports: list[int] = []
    for port in random.sample(range(20_000, 32_000), 1000):
        with suppress(OSError), socket.create_server(("127.0.0.1", port)):
            ports.append(port)
        if len(ports) == count:
            break
    return ports
