"""A JupyterLab and a watched page, for all tests in a file."""

import asyncio
from collections.abc import Awaitable, Callable, Iterator
from contextlib import AsyncExitStack, contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pytest
from browser import TIMEOUT, Witness, chromium, open_browser
from lab import Lab, jupyter_lab
from playwright.async_api import Page

from tutorial.ros.domains import reserved_domain


@dataclass
class CourseDesk:
    """A JupyterLab in a browser's page.

    Attributes:
        lab: the JupyterLab.
        page: the page.
        witness: the page's errors and requests.
        run: runs a coroutine to its end, on the page's loop.
    """

    lab: Lab
    page: Page
    witness: Witness
    run: Callable[[Awaitable[Any]], Any]


@contextmanager
def lab_desk(folder: Path, base_url: str = "/", **browser: Any) -> Iterator[CourseDesk]:
    """Open a JupyterLab in a separate ROS domain, and check that the page contacts only its own server.

    Args:
        folder: an empty folder for all its files.
        base_url: see `jupyter_lab`.
        browser: see `open_browser`.
    """
    with asyncio.Runner() as runner, reserved_domain() as domain, pytest.MonkeyPatch.context() as patch:
        patch.setenv("ROS_DOMAIN_ID", str(domain))
        opened = AsyncExitStack()
        try:
            page = runner.run(opened.enter_async_context(open_browser(chromium(), **browser)))
            lab = runner.run(opened.enter_async_context(jupyter_lab(folder, base_url)))
            witness = Witness(page)
            yield CourseDesk(lab, page, witness, lambda main: runner.run(asyncio.wait_for(main, 6 * TIMEOUT)))
            own = (lab.root, lab.root.replace("http", "ws", 1), "data:", "blob:")
            assert [url for url in witness.requests if not url.startswith(own)] == []
        finally:
            runner.run(opened.aclose())
