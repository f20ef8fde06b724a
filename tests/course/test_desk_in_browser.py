"""The desk as a learner has it: in JupyterLab, in a browser, driven, reloaded, restarted, and in the dark."""

from __future__ import annotations

import numpy as np
import pytest
from browser import pixels, until
from desk import course_desk
from lab import DARK

from tutorial.commands.lab import trust

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


@pytest.fixture
def desk(tmp_path):
    with course_desk(tmp_path, width=1280, height=960) as desk:
        shorten_the_tour(desk.lab.notebooks)
        trust(desk.lab.notebooks / "notebooks", data_dir=str(tmp_path / "data"))
        yield desk


def test_it_is_driven_reloaded_and_restarted_in_the_dark(desk):
    async def main():
        page, witness = desk.page, desk.witness
        notebook = await desk.lab.open(page, DESK)
        await page.evaluate("void window.jupyterapp.commands.execute('application:toggle-left-area')")
        await run_up_to_the_drive(notebook)
        await drive_the_turret(page, notebook)
        await notebook.reload()
        await drive_the_turret(page, notebook, side=1)
        assert witness.complaints == []
        await notebook.restart()
        await page.get_by_text("The kernel has ended or was restarted.").first.wait_for()
        witness.complaints.clear()  # JupyterLab warns that it lost the kernel
        await desk.lab.wear(page, DARK)
        await run_up_to_the_drive(notebook)
        await text_stands_out(page, notebook)
        await drive_the_turret(page, notebook)
        await close_the_desk(page, notebook)
        assert await notebook.errors() == []
        assert witness.complaints == []

    desk.run(main())


async def text_stands_out(page, notebook):
    """Text is of another shade than what it is written on, in every widget, and the page is a dark one."""
    for cell, selector in ("side_by_side", ".tank-joystick"), ("node_graph()", ".jp-OutputArea svg[role=img]"):
        await notebook.scroll_to(await cell_with(notebook, cell))
        shades = await pixels(page, f"{selector} >> nth=-1")
        assert np.median(shades) < 128, f"{selector} is a light patch in the dark"
        assert shades.max() - np.median(shades) > 90, f"{selector} is dark on dark"


async def cell_with(notebook, text):
    """The number of the first code cell that holds a text."""
    for cell in await notebook.code_cells():
        if text in await notebook.source(cell):
            return cell
    raise AssertionError(f"no cell holds {text!r}")


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
