"""The book builds, its pages open, and nothing comes from other sites."""

import asyncio
import gzip
import json
import re
import subprocess
import sys
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from functools import partial
from http.server import SimpleHTTPRequestHandler, ThreadingHTTPServer
from urllib.parse import urlsplit

import pytest
from browser import Witness, chromium, open_browser
from loops import until

from tutorial.system.paths import HOME

BOOK = HOME / "book"

pytestmark = pytest.mark.build


@pytest.fixture(scope="module")
def site(tmp_path_factory):
    """The book as ``make book`` builds it. Warnings are errors."""
    pytest.importorskip("sphinx", reason="Sphinx is not installed: make install installs it")
    folder = tmp_path_factory.mktemp("site")
    options = ("-W", "--keep-going", "-q", "-d", folder / "trees")
    command = [sys.executable, "-m", "sphinx", *options, BOOK, folder / "html"]
    done = subprocess.run(command, capture_output=True, text=True, timeout=300, check=False)
    assert done.returncode == 0, done.stdout + done.stderr
    return folder / "html"


def pages(site):
    return sorted(site.rglob("*.html"))


def test_every_widget_of_the_notebooks_is_saved(monkeypatch):
    monkeypatch.syspath_prepend(BOOK)
    from keepsakes import FOLDER, WIDGET

    for path in sorted((HOME / "notebooks").glob("[0-9]*_*.ipynb")):
        cells = json.loads(path.read_text(encoding="utf-8"))["cells"]
        outputs = [output for cell in cells for output in cell.get("outputs", ())]
        texts = ["".join(output.get("data", {}).get("text/plain", "")) for output in outputs]
        shown = sum(bool(WIDGET.match(text)) for text in texts)
        assert {kept.name for kept in (FOLDER / path.stem).glob("*")} == {f"{i + 1}.html" for i in range(shown)}


@pytest.mark.timeout(320)
def test_it_is_small_and_shares_one_viewer(site):
    driven = [*(site / "_static/drive").glob("*"), site / "_static/main.min.js"]
    size = sum(path.stat().st_size for path in site.rglob("*") if path.is_file() and path not in driven)
    assert size < 15_000_000
    assert sum(len(gzip.compress(path.read_bytes(), 6)) for path in driven) < 10_000_000
    assert len(list(site.rglob("main.min.js"))) == 1
    assert not [page for page in pages(site) if 'id="tank-viewer"' in page.read_text(encoding="utf-8")]


def test_every_picture_has_a_description(site):
    for page in pages(site):
        pictures = re.findall(r"<img\b[^>]*>", page.read_text(encoding="utf-8"))
        assert all(re.search(r'alt="[^"]{10,}"', picture) for picture in pictures), (page.name, pictures)


@pytest.mark.browser
@pytest.mark.timeout(320)
def test_pages_open_without_errors_and_play_their_replays(site):
    browser = chromium()

    async def main():
        async with open_browser(browser, 390, 800) as page:
            witness = Witness(page)
            for path in pages(site):
                await page.goto(path.as_uri())
                is_wide = await page.evaluate("document.documentElement.scrollWidth > innerWidth")
                assert not is_wide, f"{path.name} is wider than a phone"
                figures = await page.locator(".tank-replay").count()
                if figures:
                    played = "[...document.querySelectorAll('.tank-replay')].filter(({replay}) => replay).length"
                    await page.wait_for_function(f"{played} === {figures}")
            assert not witness.complaints
            assert {urlsplit(url).scheme for url in witness.requests} <= {"file", "blob", "data"}

    asyncio.run(asyncio.wait_for(main(), 300))


@contextmanager
def served(folder) -> Iterator[str]:
    """Serve a folder; yield its address, without a slash at the end."""
    with ThreadingHTTPServer(("127.0.0.1", 0), partial(SimpleHTTPRequestHandler, directory=folder)) as server:
        thread = threading.Thread(target=server.serve_forever)
        thread.start()
        try:
            yield f"http://127.0.0.1:{server.server_port}"
        finally:
            server.shutdown()
            thread.join()


BEYOND = """() => {
    const {state, setup} = drive.drive.simulation;
    const [body] = Object.entries(setup.paths).find(([, path]) => path.endsWith("CHASSIS"));
    return state && state.xpos[3 * body] > -1.5;
}"""
"""Whether the simulated tank has driven this far along the laboratory [m]."""


class DrivePage:
    """The page *Drive it*, as a visitor uses it."""

    def __init__(self, page):
        self.page = page

    async def joints(self, program):
        """Return the positions of a program's joints [rad]."""
        found = await self.page.evaluate(f"drive.drive.{program}.state?.joints ?? []")
        return {name: position for name, position, _ in found}

    async def edit(self, old, new):
        """Change the controller, and run it."""
        text = self.page.locator(".drive-text")
        source = await text.input_value()
        assert source.count(old) == 1
        await text.fill(source.replace(old, new))
        await self.page.get_by_role("button", name="Run").click()

    async def says(self, words):
        """Wait until the page shows an error."""
        await self.page.locator(".drive-error", has_text=words).wait_for()

    async def holds(self, joint, low, high):
        """Wait until a simulated joint is within a range [rad]."""

        async def is_there():
            return low < (await self.joints("simulation"))[joint] < high

        await until(is_there, f"{joint} is between {low} and {high}")


async def drive_and_be_followed(page, visitor):
    """Drive the tank and lift its barrel with keys, and check that the viewer in the second program follows."""
    views = page.locator(".drive-view .tank-view-pane")
    stood = [await views.nth(i).screenshot() for i in range(2)]
    await page.keyboard.down("KeyW")  # the joystick has the focus
    await page.wait_for_function(BEYOND)
    await page.keyboard.up("KeyW")

    await page.keyboard.down("ArrowUp")
    await visitor.holds("TURRET_P", 0.2, 1.0)
    await page.keyboard.up("ArrowUp")

    async def viewer_shows_the_same():
        simulated, shown = await visitor.joints("simulation"), await visitor.joints("viewer")
        return bool(shown) and all(abs(q - shown[name]) < 1e-6 for name, q in simulated.items())

    await until(viewer_shows_the_same, "the viewer's joints are the simulation's")
    assert (await visitor.joints("viewer"))["TURRET_P"] > 0.2

    async def are_drawn():
        return all([await views.nth(i).screenshot() != stood[i] for i in range(2)])

    await until(are_drawn, "both views show that the tank has moved")
    await page.locator(".drive-topics", has_text="/Tank/joint_state").wait_for()


async def edit_and_err(page, visitor):
    """Edit the gains, make an error and endless loops, and restore the original."""
    await page.get_by_role("button", name="Reset the tank").click()
    await visitor.holds("TURRET_P", -0.0101, -0.0095)  # 1.96 N.m of the gun's weight, by 200 N.m/rad
    await visitor.edit("P_GAIN = 200.0", "P_GAIN = 2000.0")
    await visitor.holds("TURRET_P", -0.0112, -0.0104)  # a tenth of that below the reference
    await visitor.edit("self.joint.effort = P_GAIN", "self.joint.effort = 0.0 * P_GAIN")
    await visitor.holds("TURRET_P", -1.0, -0.05)  # without a torque it sinks
    await visitor.edit("return axis if", "return 1 / 0 if")
    line = (await page.locator(".drive-text").input_value()).partition("return 1 / 0 if")[0].count("\n") + 1
    await page.keyboard.down("KeyW")
    await visitor.says(f"tank_controller.py, line {line}, in dead_zone: ZeroDivisionError: division by zero")
    await page.keyboard.up("KeyW")
    assert (await page.locator(".drive-wrong").text_content()).strip().startswith("return 1 / 0 if")
    await visitor.edit("return 1 / 0 if", "while True: pass\n    return axis if")
    await visitor.says("Is there a loop that never ends?")
    await visitor.edit("P_GAIN = 2000.0", "while True: pass")
    await visitor.says("Is there a loop that never ends?")
    await page.get_by_role("button", name="Original").click()
    await page.locator(".drive-error").wait_for(state="hidden")


COPY_IS_THE_TEXT = """() => {
    const [copy, text] = [".drive-copy", ".drive-text"].map((name) => document.querySelector(name));
    return copy.textContent === `${text.value}\\n` && copy.scrollHeight === text.scrollHeight;
}"""


async def see_what_one_edits(page):
    """Check that the visible code is the edited one, in colours, with long lines broken in the same places."""
    assert await page.evaluate(COPY_IS_THE_TEXT)
    assert await page.locator(".drive-keyword", has_text="class").first.is_visible()


async def drive_on_a_phone(page):
    """Check that everything fits on a phone's screen, and that a dragged stick moves the restarted tank."""
    await page.set_viewport_size({"width": 390, "height": 800})
    assert not await page.evaluate("document.documentElement.scrollWidth > innerWidth")
    await page.evaluate("drive.drive.simulation.state = null")
    stick = page.locator(".tank-stick-pad").first
    await stick.hover()
    await page.mouse.down()
    await stick.hover(position={"x": 74, "y": 1}, force=True)
    await page.wait_for_function(BEYOND)
    await page.mouse.up()


@pytest.mark.browser
@pytest.mark.timeout(320)
def test_the_tank_drives_in_a_browser(site):
    if not (site / "_static/drive.js").exists():
        pytest.skip("without npm, the book does not have this page")
    browser = chromium()

    async def main(address):
        async with open_browser(browser, 1280, 900, scale=0.5) as page:
            witness, visitor = Witness(page), DrivePage(page)
            await page.goto(f"{address}/{site.name}/drive.html")  # in a subfolder of the site
            before = [url for url in witness.requests if "/_static/drive/" in url or "main.min.js" in url]
            assert not before, "the page loaded large files before the button was pressed"
            await page.get_by_role("button", name="Start").click()
            await page.wait_for_function("drive.drive.isReady", timeout=200_000)
            await drive_and_be_followed(page, visitor)
            await see_what_one_edits(page)
            await edit_and_err(page, visitor)
            await drive_on_a_phone(page)
            assert {urlsplit(url).netloc for url in witness.requests if not url.startswith(("blob:", "data:"))} == {
                urlsplit(address).netloc
            }
            assert not witness.complaints

    with served(site.parent) as address:
        asyncio.run(asyncio.wait_for(main(address), 300))
