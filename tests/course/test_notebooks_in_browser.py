"""The notebooks as a learner has them: in JupyterLab, in a browser, run twice, reloaded, restarted."""

from __future__ import annotations

import asyncio
from contextlib import asynccontextmanager

import numpy as np
import pytest
from browser import AS_WITHOUT, PATIENCE, Witness, chromium, open_browser, pixels, until
from lab import DARK, copy_files, jupyter_lab

from tutorial.commands.lab import trust
from tutorial.paths import HOME

NOTEBOOKS = sorted(path.name for path in (HOME / "notebooks").glob("*.ipynb"))
DESK = "notebooks/0_setup.ipynb"
TOUR, MOMENT = "program.run(8)", "program.run(0.1)"
HAS_TURRET = """(pane) => {
    const body = pane.viewer && pane.viewer.scene_tree.find(["Bodies", "Tank", "Tank.TURRET_Y"]).object;
    return Boolean(body && body.children.length);
}"""
WHERE_IS_THE_TURRET = """(pane) => {
    const body = pane.viewer.scene_tree.find(["Bodies", "Tank", "Tank.TURRET_Y"]).object;
    return [...body.position.toArray(), ...body.quaternion.toArray()];
}"""
PANES = ".tank-view-pane"

pytestmark = [pytest.mark.browser, pytest.mark.timeout(400)]


@asynccontextmanager
async def at_the_desk(folder, base_url="/", theme=None, tour=True, **browser):
    """JupyterLab with the notebooks and what belongs to them, in a browser's page that is watched."""
    async with (
        jupyter_lab(folder, base_url, theme) as lab,
        open_browser(chromium(), 1280, 960, **browser) as page,
    ):
        copy_files(lab, HOME / "notebooks", HOME / "project", HOME / "launch_py")
        if not tour:
            shorten_the_tour(lab.notebooks)
        trust(lab.notebooks / "notebooks", data_dir=str(folder / "data"))
        witness = Witness(page)
        yield lab, page, witness
        own = (lab.root, lab.root.replace("http", "ws", 1), "data:", "blob:")
        assert [url for url in witness.requests if not url.startswith(own)] == []


def run(main):
    asyncio.run(asyncio.wait_for(main(), 6 * PATIENCE))


async def cell_with(notebook, text):
    """The number of the first code cell that holds a text."""
    for cell in await notebook.code_cells():
        if text in await notebook.source(cell):
            return cell
    raise AssertionError(f"no cell holds {text!r}")


@pytest.mark.parametrize("name", NOTEBOOKS)
def test_all_cells_run_twice_without_an_error(domain, tmp_path, name):
    """From the top to the end, and then once more from the top, each cell twice in a row."""
    chromium()

    async def main():
        async with at_the_desk(tmp_path, "/user/ada/", arguments=AS_WITHOUT, scale=0.25) as (lab, page, witness):
            notebook = await lab.open(page, f"notebooks/{name}")
            await notebook.run_all()
            assert await notebook.errors() == []
            for cell in await notebook.code_cells():
                await notebook.run(cell)
                await notebook.run(cell)
                assert await notebook.errors() == []
            assert witness.complaints == []

    run(main)


def test_the_desk_is_driven_reloaded_and_restarted(domain, tmp_path):
    chromium()

    async def main():
        async with at_the_desk(tmp_path, tour=False) as (lab, page, witness):
            notebook = await lab.open(page, DESK)
            await page.evaluate("void window.jupyterapp.commands.execute('application:toggle-left-area')")
            await run_up_to_the_drive(notebook)
            await drive_the_turret(page, notebook)
            await notebook.reload()
            await drive_the_turret(page, notebook, side=1)
            assert witness.complaints == []
            await notebook.restart()
            await page.get_by_text("The kernel has ended or was restarted.").first.wait_for()
            witness.complaints.clear()  # JupyterLab warns that it lost the kernel
            await run_up_to_the_drive(notebook)
            await drive_the_turret(page, notebook)
            await close_the_desk(page, notebook)
            assert await notebook.errors() == []
            assert witness.complaints == []

    run(main)


def test_the_dark_theme_is_readable(domain, tmp_path):
    """Text stands out from what it is written on, in every widget."""
    chromium()

    async def main():
        async with at_the_desk(tmp_path, theme=DARK, tour=False) as (lab, page, _):
            notebook = await lab.open(page, DESK)
            await run_up_to_the_drive(notebook)
            for cell, selector in ("side_by_side", ".tank-joystick"), ("node_graph()", ".jp-OutputArea svg[role=img]"):
                await notebook.scroll_to(await cell_with(notebook, cell))
                shades = await pixels(page, f"{selector} >> nth=-1")
                assert np.median(shades) < 128, f"{selector} is a light patch in the dark"
                assert shades.max() - np.median(shades) > 90, f"{selector} is dark on dark"

    run(main)


def shorten_the_tour(folder):
    """Have the desk's tour last a moment, or else the machine's speed decides where the tank is when it ends."""
    path = folder / DESK
    text = path.read_text(encoding="utf-8")
    assert TOUR in text
    path.write_text(text.replace(TOUR, MOMENT), encoding="utf-8")


async def run_up_to_the_drive(notebook):
    """Run all cells up to the one that lets time pass."""
    last = await cell_with(notebook, "program.start()")
    for cell in await notebook.code_cells():
        if cell <= last:
            await notebook.run(cell)


async def close_the_desk(page, notebook):
    """Everything ends, and everything stays to be looked at, marked as closed."""
    await notebook.run(await cell_with(notebook, "close_all()"))
    await notebook.scroll_to(await cell_with(notebook, "side_by_side"))
    await page.get_by_text("closed: this is its last picture").last.wait_for()
    await page.get_by_text("Closed. Run its cell again, and the joystick comes back.").wait_for()
    assert await page.locator(PANES).last.evaluate(HAS_TURRET)


async def drive_the_turret(page, notebook, side=-1):
    """Hold the right stick to one side with the mouse, until the turret has turned, in the scene and in pixels.

    Only a little to the side: at full stick it comes full circle within three seconds, and looks as it did before. So
    it takes a quarter of a minute, which is longer than the slowest machine takes to look.
    """
    await notebook.scroll_to(await cell_with(notebook, "side_by_side"))
    pads, view = page.locator(".tank-stick-pad"), page.locator(PANES).last
    await view.scroll_into_view_if_needed()
    await until(lambda: view.evaluate(HAS_TURRET), "the view shows the tank")
    before, looks = await view.evaluate(WHERE_IS_THE_TURRET), await pixels(page, f"{PANES} >> nth=-1")
    await pads.nth(1).scroll_into_view_if_needed()
    box = await pads.nth(1).bounding_box()
    x, y = box["x"] + box["width"] / 2, box["y"] + box["height"] / 2
    await page.mouse.move(x, y)
    await page.mouse.down()
    await page.mouse.move(x + side * 0.055 * box["width"], y, steps=3)

    async def has_turned():
        return np.abs(np.subtract(await view.evaluate(WHERE_IS_THE_TURRET), before)).max() > 0.3

    async def looks_different():
        after = await pixels(page, f"{PANES} >> nth=-1")
        return (np.abs(after - looks).max(axis=2) > 40).sum() > 50

    await until(has_turned, "the turret has turned")
    await page.mouse.up()
    await until(looks_different, "the turret is seen to have turned")
