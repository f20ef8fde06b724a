"""A browser, for tests of what a learner sees."""

import io
import os
import re
import shutil
from collections.abc import AsyncIterator, Sequence
from contextlib import asynccontextmanager

import numpy as np
import pytest
from loops import until
from PIL import Image
from playwright.async_api import Page, async_playwright
from red_box import DISTANCE

NAMES = ("chromium", "chromium-browser", "google-chrome-stable", "google-chrome", "chrome")
SOFTWARE = ["--enable-unsafe-swiftshader", "--no-sandbox"]
AS_WITH_A_CARD = ["--use-gl=angle", "--use-angle=swiftshader", "--disable-gpu-rasterization", *SOFTWARE]
"""An emulated graphics card composites WebGL and the page: 3D appears on the page at once."""
AS_WITHOUT = ["--disable-gpu", *SOFTWARE]
"""It draws only WebGL: a page with a lot of text takes a third less time, one with moving 3D takes longer."""
LIKE_A_CARD = """
for (const {prototype} of [WebGLRenderingContext, WebGL2RenderingContext]) {
    const {getExtension} = prototype;
    prototype.getExtension = function (name) {
        return name === "WEBGL_debug_renderer_info" ? null : getExtension.call(this, name);
    };
}"""
"""Makes a page draw as if there were a graphics card, by hiding the renderer's name."""
OF_THE_MACHINE = re.compile(
    r"GPU stall due to ReadPixels"
    r"|^Plugin (@jupyter[\w-]*/|anywidget:)\S+ .*(is taking too long|took [\d.]+ms) to activate"
    r"|^\[anywidget\] Failed to initialize model\.$"  # it is logged after two seconds; an exception logs different text
    r"|^still waiting on run dependencies:$|^dependency: wasm-instantiate$|^\(end of list\)$"  # after ten seconds
)
"""Harmless messages of Chromium without a graphics card, and of JupyterLab and Pyodide on a busy machine."""
TIMEOUT = 60.0


def find_chromium() -> str | None:
    """Return the path of a Chromium, if there is one."""
    return os.environ.get("CHROMIUM") or next(filter(None, map(shutil.which, NAMES)), None)


def chromium() -> str:
    """Return the path of Chromium. Without one, skip the test with a reason; in CI (CI=true) fail it."""
    path = find_chromium()
    if path is not None:
        return path
    reason = f"there is no Chromium on PATH ({', '.join(NAMES)}), and CHROMIUM is not set"
    if os.environ.get("CI") == "true":
        pytest.fail(reason)
    pytest.skip(reason)


@asynccontextmanager
async def open_browser(
    path: str, width: int = 800, height: int = 600, arguments: Sequence[str] = AS_WITH_A_CARD, scale: float = 1
) -> AsyncIterator[Page]:
    """Open a page in a headless browser that draws WebGL in software.

    Args:
        path: the path of the browser.
        width, height: the page's size [CSS pixels].
        arguments: more of the browser's arguments, such as `AS_WITHOUT`.
        scale: pixels per CSS pixel; less than one is enough for a page that nobody looks at.
    """
    async with async_playwright() as playwright:
        browser = await playwright.chromium.launch(executable_path=path, args=[*arguments])
        try:
            page = await browser.new_page(viewport={"width": width, "height": height}, device_scale_factor=scale)
            page.set_default_timeout(TIMEOUT * 1000)
            yield page
        finally:
            await browser.close()


class Witness:
    """Records the errors and requests of a page."""

    def __init__(self, page: Page) -> None:
        self.complaints: list[str] = []
        self.requests: list[str] = []
        page.on("console", self._on_console)
        page.on("pageerror", lambda error: self._take_down(str(error)))
        page.on("request", lambda request: self.requests.append(request.url))
        page.on("websocket", lambda socket: self.requests.append(socket.url))

    def _on_console(self, message) -> None:
        if message.type in ("error", "warning"):
            self._take_down(message.text)

    def _take_down(self, complaint: str) -> None:
        if not OF_THE_MACHINE.search(complaint):
            self.complaints.append(complaint)


async def pixels(page: Page, selector: str) -> np.ndarray:
    """Return an element's pixels: (height, width, 3), 0 to 255."""
    picture = await page.locator(selector).screenshot()
    return np.asarray(Image.open(io.BytesIO(picture)).convert("RGB")).astype(int)


def red_spot(picture: np.ndarray) -> tuple[float, float] | None:
    """Return the centre of all red pixels, (x, y) from the top left; None if there are nearly none."""
    red, green, blue = np.moveaxis(picture, -1, 0)
    rows, columns = np.nonzero((red > 90) & (red > 2.5 * green) & (red > 2.5 * blue))
    return None if len(rows) < 20 else (float(columns.mean()), float(rows.mean()))


HALF_ANGLE = 0.46630765815  # tan(50 degrees / 2)


async def red_is_at(page: Page, selector: str, x: float, z: float) -> None:
    """Wait until a red box is x to the right of an element's centre and z above it [m], to 5 % of its height."""

    async def is_there() -> bool:
        picture = await pixels(page, selector)
        height, width, _ = picture.shape
        scale = height / 2 / HALF_ANGLE / DISTANCE  # pixels per metre, at the box's centre
        spot, expected = red_spot(picture), (width / 2 + scale * x, height / 2 - scale * z)
        return spot is not None and np.abs(np.subtract(spot, expected)).max() < 0.05 * height

    await until(is_there, f"{selector} shows the box at {x}, {z}")
