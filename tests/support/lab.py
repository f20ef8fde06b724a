"""A real JupyterLab for the tests, with a notebook in a browser and its kernel."""

import asyncio
import json
import os
import shutil
import subprocess
import sys
import time
from collections.abc import AsyncIterator, Iterable
from contextlib import asynccontextmanager, suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import nbformat
import psutil
import pytest
from browser import TIMEOUT
from loops import until
from playwright.async_api import Page

TOKEN = "a-token-for-the-tests"
NOTEBOOK = "window.jupyterapp.shell.currentWidget"
BUSY = "content.widgets.some((cell) => cell.model.executionState === 'running')"

_FOLDERS = {f"JUPYTER_{name.upper()}_DIR": name for name in ("config", "data", "runtime")}
_FOLDERS |= {f"JUPYTERLAB_{name.upper()}_DIR": name for name in ("settings", "workspaces")}
_FOLDERS["IPYTHONDIR"] = "ipython"


@dataclass
class Lab:
    """A running JupyterLab.

    Attributes:
        root: its server's address, with the base_url and a slash at the end.
        notebooks: the folder that it shows.
    """

    root: str
    notebooks: Path

    def write(self, name: str, cells: Iterable[str]) -> str:
        """Write a notebook of code cells into the folder, and return its name."""
        notebook = nbformat.v4.new_notebook(cells=[nbformat.v4.new_code_cell(source) for source in cells])
        nbformat.write(notebook, self.notebooks / name)
        return name

    async def open(self, page: Page, name: str) -> "Notebook":
        """Open a notebook in a page, which may already show the lab, and wait for its kernel."""
        if page.url.startswith(self.root):
            await _execute(page, "docmanager:open", path=name)
        else:
            await page.goto(f"{self.root}lab/tree/{name}?reset&token={TOKEN}")
        notebook = Notebook(page)
        await notebook.is_ready()
        return notebook


@dataclass
class Notebook:
    """The open notebook in a page. Its cells are numbered from 0.

    Attributes:
        page: the browser's page.
    """

    page: Page

    async def is_ready(self) -> None:
        """Wait until the notebook and its kernel are ready, and close dialogs and notifications."""
        ready = "window.jupyterapp?.shell.currentWidget?.context?.isReady && "
        ready += "window.jupyterapp.shell.currentWidget.sessionContext.session?.kernel?.status === 'idle'"

        dialog = self.page.locator(".jp-Dialog button.jp-mod-accept")

        async def is_so() -> bool:
            if await dialog.count():
                await dialog.first.click()
            return bool(await self.page.evaluate(ready))

        await until(is_so, "the notebook's kernel is ready")
        await self._do("sessionContext.ready")

        async def answers() -> bool:
            """Return whether its kernel runs this Python; the server drops replies until the connection exists."""
            return await self.run_new("import sys; print(sys.executable)") == f"{sys.executable}\n"

        await until(answers, "the notebook's kernel answers")

    async def go_to_the_top(self) -> None:
        """Choose the first cell, like a click beside it; keys are then the notebook's commands."""
        await self._choose(0)
        await self._do("content.activate()")

    async def run_all(self) -> None:
        """Run all cells, and wait until they are done."""
        await self._command("notebook:run-all-cells")
        await self.is_done()

    async def start(self, cell: int) -> None:
        """Start one cell without waiting."""
        await self._choose(cell)
        await _execute(self.page, "notebook:run-cell")

    async def run(self, cell: int) -> str:
        """Run one cell, wait until it is done, and return its printed text."""
        await self._choose(cell)
        await self._command("notebook:run-cell")
        return await self.text(cell)

    async def run_new(self, source: str) -> str:
        """Run code in the kernel without a cell, and return its printed text; fail if it raised."""
        said = await self.page.evaluate(
            """(code) => {
                const {kernel} = window.jupyterapp.shell.currentWidget.sessionContext.session;
                const future = kernel.requestExecute({code, silent: false, store_history: false});
                let text = "";
                future.onIOPub = ({content}) => { text += content.text ?? content.traceback?.join("\\n") ?? ""; };
                return future.done.then(({content}) => [content.status, text]);
            }""",
            source,
        )
        assert said[0] == "ok", said[1]
        return str(said[1])

    async def is_busy(self) -> bool:
        """Return whether a cell runs or waits to run."""
        return bool(await self._do(BUSY))

    async def is_done(self) -> None:
        """Wait until no cell runs or waits to run."""
        await self.page.wait_for_function(f"!{NOTEBOOK}.{BUSY}")

    async def interrupt(self) -> None:
        """Interrupt the kernel."""
        await self._do("sessionContext.session.kernel.interrupt()")

    async def count(self) -> int:
        """Return the number of cells."""
        return int(await self._do("content.widgets.length"))

    async def text(self, cell: int) -> str:
        """Return a cell's printed text."""
        outputs = await self._do(f"content.widgets[{cell}].model.outputs?.toJSON() ?? []")
        return "".join("".join(output["text"]) for output in outputs if output["output_type"] == "stream")

    async def errors(self) -> list[str]:
        """Return the cells' exceptions, one line each, with the cell's number."""
        errors = """content.widgets.flatMap((cell, number) => (cell.model.outputs?.toJSON() ?? [])
            .filter((output) => output.output_type === "error")
            .map((output) => `cell ${number}: ${output.ename}: ${output.evalue}`))"""
        return list(await self._do(errors))

    async def clear(self, cell: int) -> None:
        """Clear a cell's outputs."""
        await self._do(f"content.widgets[{cell}].model.clearExecution()")

    async def save(self) -> None:
        """Save the notebook with its outputs."""
        await self._do("context.save()")

    async def reload(self) -> None:
        """Save, reload the page, and wait until the notebook is back with the same kernel."""
        await self.save()
        await self.page.reload()
        await self.is_ready()

    async def reconnect(self) -> None:
        """Make the page drop its connection to the kernel and open a new one; wait until the new one carries messages.

        The server drops the kernel's messages while it opens a new connection, so ask until an answer arrives.
        The control channel answers even while a cell is busy.
        """
        await self._do("sessionContext.session.kernel.reconnect()")
        ask = """({kernel}) => Promise.race([
            kernel.requestListSubshell({}).done.then(() => true),
            new Promise((resolve) => setTimeout(resolve, 1000, false)),
        ])"""
        session = await self.page.evaluate_handle(f"{NOTEBOOK}.sessionContext.session")
        await until(lambda: session.evaluate(ask), "the new connection to the kernel carries messages")

    async def restart(self) -> None:
        """Restart the kernel, and wait until it is ready."""
        await self._do("sessionContext.restartKernel()")
        await self.is_ready()

    async def close(self) -> None:
        """Shut down the kernel, save the notebook and close it; the page stays."""
        await self._do("sessionContext.shutdown()")
        await self.save()
        await self.page.evaluate("void window.jupyterapp.shell.currentWidget.close()")

    def cell(self, cell: int) -> Any:
        """Return a cell's locator on the page."""
        return self.page.locator(f".jp-NotebookPanel:not(.lm-mod-hidden) .jp-Cell[data-windowed-list-index='{cell}']")

    async def _choose(self, cell: int) -> None:
        await self._do(f"content.activeCellIndex = {cell}")
        await self._do("content.deselectAll()")

    async def _do(self, code: str) -> Any:
        """Evaluate JavaScript about the notebook's widget."""
        return await self.page.evaluate(f"{NOTEBOOK}.{code}")

    async def _command(self, name: str) -> None:
        await self.page.evaluate("(name) => window.jupyterapp.commands.execute(name)", name)


async def _execute(page: Page, name: str, **arguments: str) -> None:
    """Make JupyterLab execute a command, without waiting."""
    await page.evaluate("(all) => void window.jupyterapp.commands.execute(...all)", [name, arguments])


@asynccontextmanager
async def jupyter_lab(folder: Path, base_url: str = "/") -> AsyncIterator[Lab]:
    """Run a JupyterLab that ignores the user's settings, and end it with all its children.

    Args:
        folder: an empty folder for its notebooks and settings.
        base_url: the path of its server, such as ``/user/ada/``.
    """
    environment = _environment(folder)
    _write_settings(folder)
    notebooks = folder / "notebooks"
    notebooks.mkdir()
    with (folder / "server.log").open("wb") as log:
        server = psutil.Popen(_command(notebooks, base_url), env=environment, stdout=log, stderr=log, cwd=notebooks)
        try:
            yield Lab(await _address(folder, server), notebooks)
        finally:
            _end(server)


def copy_files(lab: Lab, *folders: Path) -> None:
    """Put copies of folders into the lab's folder."""
    for folder in folders:
        shutil.copytree(folder, lab.notebooks / folder.name)


def _environment(folder: Path) -> dict[str, str]:
    kept = {name: value for name, value in os.environ.items() if not name.startswith("JUPYTER")}
    return kept | {name: str(folder / part) for name, part in _FOLDERS.items()}


def _write_settings(folder: Path) -> None:
    path = folder / _FOLDERS["JUPYTERLAB_SETTINGS_DIR"] / "@jupyterlab/apputils-extension"
    path.mkdir(parents=True)
    quiet = json.dumps({"fetchNews": "false", "checkForUpdates": False})
    (path / "notification.jupyterlab-settings").write_text(quiet, encoding="utf-8")


def _command(notebooks: Path, base_url: str) -> list[str]:
    options = {
        "ServerApp": {"ip": "127.0.0.1", "port": 0, "base_url": base_url, "root_dir": notebooks, "allow_root": True},
        "IdentityProvider": {"token": TOKEN},
        "LabApp": {"expose_app_in_browser": True, "news_url": None},
        "LanguageServerManager": {"autodetect": False},  # otherwise it asks npm for language servers
    }
    words = [f"--{part}.{name}={value}" for part, given in options.items() for name, value in given.items()]
    return [sys.executable, "-m", "jupyterlab", "--no-browser", *words]


async def _address(folder: Path, server: psutil.Popen) -> str:
    """Wait until the server prints its address."""
    deadline = time.monotonic() + TIMEOUT
    while True:
        for path in (folder / _FOLDERS["JUPYTER_RUNTIME_DIR"]).glob("jpserver-*.json"):
            if text := path.read_text(encoding="utf-8"):
                return str(json.loads(text)["url"])
        if server.poll() is not None or time.monotonic() > deadline:
            pytest.fail("JupyterLab did not start:\n" + (folder / "server.log").read_text(encoding="utf-8")[-3000:])
        await asyncio.sleep(0.05)


def _end(server: psutil.Popen) -> None:
    family = [server, *server.children(recursive=True)]
    server.terminate()
    with suppress(psutil.TimeoutExpired, subprocess.TimeoutExpired):
        server.wait(10)
    for process in family:
        if process.is_running():
            process.kill()
    psutil.wait_procs(family, 10)
