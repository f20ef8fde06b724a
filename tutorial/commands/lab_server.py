"""JupyterLab's server as ``tank lab`` runs it: it says where to look in one line, and one Ctrl-C ends it.

A program of its own, with JupyterLab's own arguments: ``python -m tutorial.commands.lab_server``. What it decides are
defaults; the user's arguments and configuration files come before them.
"""

from __future__ import annotations

import signal

if __name__ == "__main__":
    signal.signal(signal.SIGINT, signal.SIG_DFL)  # until the server takes Ctrl-C over, it ends all without a traceback

import logging
import os
import re
import sys
import webbrowser
from types import FrameType
from typing import Any

sys.modules["rfc3987_syntax"] = None  # type: ignore[assignment]
"""Whoever imports it is told that it is not installed. It takes more than a second, half of the server's start, and is
there to check addresses with other than Latin letters, of which Jupyter's schemas have none."""

# ruff: noqa: E402
from jupyter_server.serverapp import ServerApp
from jupyterlab.labapp import LabApp
from tornado.iostream import StreamClosedError
from tornado.websocket import WebSocketClosedError
from traitlets import default
from traitlets.config import Config

from tutorial.commands.terminal import say

__all__ = ["CourseServer"]

HERE = "127.0.0.1"
IN_A_TERMINAL = {"www-browser", "links", "elinks", "lynx", "w3m"}
"""Browsers that Python may find where there is no desktop. They cannot show JupyterLab."""
BROWSER_IS_ELSEWHERE = ("WSL_DISTRO_NAME", "VSCODE_IPC_HOOK_CLI")
"""Variables of WSL, and of VS Code's terminals in containers and on other machines."""


class CourseServer(ServerApp):
    """Jupyter's server, quiet, for this machine alone."""

    def __init__(self, **settings: Any) -> None:
        quiet = Config(Application={"log_level": logging.WARNING})  # the server's extensions log at this level, too
        super().__init__(config=quiet, **settings)

    @default("ip")
    def _on_this_machine(self) -> str:
        return HERE

    @default("allow_root")
    def _root_may(self) -> bool:
        """Root may run it, for in a container there is nobody else.

        Jupyter refuses because whoever reaches root's server is root. This one is reached from this machine only, and
        with its token; for another address the user has to say ``--allow-root``.
        """
        return self.ip in (HERE, "localhost", "::1")

    @default("use_redirect_file")
    def _browser_reads_files_of_this_machine(self) -> bool:
        """Whether the browser can open the file by which Jupyter hides the token from other users of the machine."""
        return not any(os.environ.get(name) for name in BROWSER_IS_ELSEWHERE)

    @default("allow_origin_pat")
    def _forwarded(self) -> str:
        """The addresses by which a browser reaches a GitHub codespace, a regular expression; none elsewhere."""
        name, domain = map(os.environ.get, ("CODESPACE_NAME", "GITHUB_CODESPACES_PORT_FORWARDING_DOMAIN"))
        return rf"https://{re.escape(name)}-\d+\.{re.escape(domain)}" if name and domain else ""

    @default("max_body_size")
    def _largest_request(self) -> int:
        """Jupyter reads what it is sent before it asks who sent it, by itself up to 512 MB [bytes].

        A notebook is far smaller, and JupyterLab sends large files in pieces.
        """
        return 64_000_000

    def init_signal(self) -> None:
        """End at one Ctrl-C, without a question and in the same way whether there is a terminal or not."""
        super().init_signal()
        for number in (signal.SIGINT, signal.SIGTERM):
            signal.signal(number, self._end)

    def start_app(self) -> None:
        """Say where to look as soon as the server answers."""
        address = self.public_url if self.custom_display_url else self.local_url
        self.identity_provider.token_generated = False  # or Jupyter says it, too, in five lines
        super().start_app()
        browser = self.open_browser and _browser(self.browser) is not None
        what = "It opens in the browser, at" if browser else "Open this in a browser:"
        self.io_loop.add_callback(self._say, f"{what} {address}\nCtrl-C ends it.")

    def launch_browser(self) -> None:
        """Open the browser, if there is one."""
        if _browser(self.browser) is not None:
            super().launch_browser()

    def _say(self, text: str) -> None:
        say(f"{text}\n")
        if self.log_level == logging.WARNING:  # what it warns of from now on is what the pages ask for, all the time
            self.log_level = logging.ERROR

    def _end(self, _number: int, _frame: FrameType | None) -> None:
        """Stop; a second signal ends it at once."""
        for each in (signal.SIGINT, signal.SIGTERM):
            signal.signal(each, signal.SIG_DFL)
        self.stop(from_signal=True)


def _browser(name: str) -> webbrowser.BaseBrowser | None:
    """Return the browser that Jupyter would open, if it can show JupyterLab."""
    try:
        browser = webbrowser.get(name or None)
    except webbrowser.Error:
        return None
    return None if getattr(browser, "name", "") in IN_A_TERMINAL else browser


def _is_news(record: logging.LogRecord) -> bool:
    """Whether somebody wants to read it; not that a page was closed while something was on its way to it."""
    return not (record.exc_info and isinstance(record.exc_info[1], (WebSocketClosedError, StreamClosedError)))


def main() -> None:
    """Run JupyterLab on this server."""
    logging.getLogger("asyncio").addFilter(_is_news)
    LabApp.serverapp_class = CourseServer
    LabApp.launch_instance(sys.argv[1:])


if __name__ == "__main__":
    main()
