"""The book: it is built, its pages open, what has moved moves again, and nothing comes from outside."""

from __future__ import annotations

import asyncio
import json
import re
import subprocess
import sys
from urllib.parse import urlsplit

import pytest
from browser import Witness, chromium, open_browser

from tutorial.paths import HOME

BOOK = HOME / "book"
MEGABYTE = 1_000_000

pytestmark = pytest.mark.build


@pytest.fixture(scope="module")
def site(tmp_path_factory):
    """The book as ``make book`` builds it: warnings are errors."""
    pytest.importorskip("sphinx", reason="Sphinx is not installed: make install installs it")
    folder = tmp_path_factory.mktemp("site")
    options = ("-W", "--keep-going", "-q", "-d", folder / "trees")
    command = [sys.executable, "-m", "sphinx", *options, BOOK, folder / "html"]
    done = subprocess.run(command, capture_output=True, text=True, timeout=300, check=False)
    assert done.returncode == 0, done.stdout + done.stderr
    return folder / "html"


def pages(site):
    return sorted(site.rglob("*.html"))


def test_every_widget_of_the_notebooks_is_kept(monkeypatch):
    monkeypatch.syspath_prepend(BOOK)
    from keepsakes import FOLDER, WIDGET

    for path in sorted((HOME / "notebooks").glob("[0-9]_*.ipynb")):
        cells = json.loads(path.read_text(encoding="utf-8"))["cells"]
        outputs = [output for cell in cells for output in cell.get("outputs", ())]
        texts = ["".join(output.get("data", {}).get("text/plain", "")) for output in outputs]
        shown = sum(bool(WIDGET.match(text)) for text in texts)
        assert {kept.name for kept in (FOLDER / path.stem).glob("*")} == {f"{i + 1}.html" for i in range(shown)}


@pytest.mark.timeout(320)
def test_it_is_small_and_shares_one_viewer(site):
    size = sum(path.stat().st_size for path in site.rglob("*") if path.is_file())
    assert size < 15 * MEGABYTE
    assert len(list(site.rglob("main.min.js"))) == 1
    assert not [page for page in pages(site) if 'id="tank-viewer"' in page.read_text(encoding="utf-8")]


def test_every_picture_has_a_description(site):
    for page in pages(site):
        pictures = re.findall(r"<img\b[^>]*>", page.read_text(encoding="utf-8"))
        assert all(re.search(r'alt="[^"]{10,}"', picture) for picture in pictures), (page.name, pictures)


MOVED = """async () => {
    const {replay} = [...document.querySelectorAll(".tank-replay")].find(({replay}) => replay?.duration > 1);
    replay.pane.scrollIntoView();
    while (!replay.picture) await new Promise((resolve) => setTimeout(resolve, 50));
    const {Tank} = replay.picture.viewer.scene_tree.children.Bodies.children;
    const poses = () => JSON.stringify(Object.values(Tank.children).map(({object}) => object.matrixWorld));
    const look = async (time) => {
        replay.slider.value = time;
        replay.slider.dispatchEvent(new Event("input"));
        await new Promise((resolve) => requestAnimationFrame(() => setTimeout(resolve, 50)));
        replay.picture.viewer.render();
        return poses();
    };
    const seen = new Set();
    for (const share of [0, 0.25, 0.5, 0.75, 1]) seen.add(await look(share * replay.duration));
    return seen.size > 1;
}"""


@pytest.mark.browser
@pytest.mark.timeout(320)
def test_pages_open_without_a_complaint_and_their_runs_move(site):
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
                if await page.evaluate(
                    "[...document.querySelectorAll('.tank-replay')].some(f => f.replay.duration > 1)"
                ):
                    assert await page.evaluate(MOVED), path.name
            assert not witness.complaints
            assert {urlsplit(url).scheme for url in witness.requests} <= {"file", "blob", "data"}

    asyncio.run(asyncio.wait_for(main(), 300))
