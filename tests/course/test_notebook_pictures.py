"""Pictures in the notebooks: what a visitor sees before anything runs and without JavaScript, as on GitHub."""

import asyncio
import re
from types import SimpleNamespace

import nbformat
import notebook_pictures
import numpy as np
import pytest
from browser import chromium, open_browser
from ipywidgets import Widget
from nbconvert import HTMLExporter
from nbformat.v4 import new_code_cell, new_notebook, new_output
from notebook_pictures import WIDTH, draw, find_figures, keep_pictures, store, store_pictures
from PIL import Image, ImageDraw

import tutorial.notebook  # noqa: F401  (it defines the widgets)
from tutorial.system.paths import HOME

NOTEBOOKS = sorted((HOME / "notebooks").glob("[0-9]*_*.ipynb"))
LARGEST = 400_000  # bytes


@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)
def test_its_page_shows_pictures_with_descriptions(path):
    assert path.stat().st_size < LARGEST
    page, _ = HTMLExporter(template_name="basic").from_filename(path)
    pictures = re.findall(r"<img\b[^>]*>", page)
    assert all(re.search(r'alt="(?!No description)[^"]{10,}"', picture) for picture in pictures)
    assert sum("progress bar" not in picture for picture in pictures) >= (2 if path == NOTEBOOKS[0] else 3)
    texts = re.findall(r'class="output_text[^>]*>\s*<pre>(.*?)</pre>', page, re.DOTALL)
    assert not {text.partition("(")[0] for text in texts} & widget_names(Widget)


def widget_names(kind):
    return {kind.__name__}.union(*map(widget_names, kind.__subclasses__()))


def shown(text="SceneView('simulation')", source="program.view", **data):
    output = new_output("display_data", data={"text/plain": text, **data})
    return new_notebook(cells=[new_code_cell(source, outputs=[output])]), output


def square(left):
    picture = Image.new("RGB", (200, 100), "white")
    ImageDraw.Draw(picture).rectangle((left, 40, left + 20, 60), "green")
    return picture


def test_a_picture_is_only_replaced_by_one_that_looks_different():
    _, output = shown()
    assert store(output, square(50), "a square")
    first = output.data["image/jpeg"]
    assert not store(output, square(50.4), "a square that has hardly moved")
    assert output.data["image/jpeg"] == first
    assert output.metadata == {"image/jpeg": {"alt": "a square", "width": 200}}
    assert store(output, square(80), "a square further right")
    assert output.metadata["image/jpeg"]["alt"] == "a square further right"
    assert output.data["text/plain"] == "SceneView('simulation')"
    assert store(output, square(50).resize((800, 560)), "a square that is taller than a live view")
    assert output.metadata["image/jpeg"]["width"] == 343


def test_a_later_run_has_the_pictures_of_cells_that_are_unchanged():
    before, output = shown()
    store(output, square(50), "a square")
    now, same = shown()
    keep_pictures(before, now)
    assert (same.data, same.metadata) == (output.data, output.metadata)
    now, other = shown(source="program.view  # of another program")
    keep_pictures(before, now)
    assert "image/jpeg" not in other.data


def test_without_chromium_the_pictures_stay(tmp_path, monkeypatch, capsys):
    monkeypatch.setattr(notebook_pictures, "find_chromium", lambda: None)
    path = tmp_path / "0_setup.ipynb"
    nbformat.write(shown(**{"image/jpeg": "AAAA"})[0], path)
    written = path.read_bytes()
    asyncio.run(store_pictures([path]))
    assert path.read_bytes() == written
    assert "no Chromium" in capsys.readouterr().out


@pytest.mark.parametrize(("turret", "time"), [([0.0, 0.9, 0.1], 1.0), ([0.0, 0.05, 0.01], 2.0)])
def test_a_view_is_shown_with_its_joints_farthest_from_where_they_began(turret, time, monkeypatch):
    monkeypatch.syspath_prepend(HOME / "book")
    from keepsakes import _telling_time

    positions = [{"Tank TURRET_Y": position} for position in turret]
    assert _telling_time(SimpleNamespace(_times=[0.0, 1.0, 2.0], _positions=positions)) == time


@pytest.mark.browser
def test_a_view_is_drawn_with_the_sticks_beside_it():
    figures = find_figures((HOME / "book/shown/0_setup/1.html").read_text(encoding="utf-8"))

    async def main():
        async with open_browser(chromium(), WIDTH) as page:
            return await draw(page, "SideBySide(SceneView('simulation'), Joystick())", figures)

    red, _, blue = np.moveaxis(np.asarray(asyncio.run(main()), int), -1, 0)
    coloured = np.abs(red - blue) > 20
    assert coloured[:, : WIDTH // 3].mean() > 0.3, "the sky, the floor and the tank"
    assert 0.02 < coloured[:, -WIDTH // 3 :].mean() < 0.3, "the knobs of the sticks"
