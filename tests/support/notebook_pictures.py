"""Pictures of the notebooks' widgets, which ``make notebooks`` stores in the notebooks' outputs.

GitHub, nbviewer and editors show them, and so does JupyterLab until the cell is run. Chromium draws them from the
figures that `keepsakes` saves for the book.
"""

import ast
import base64
import html
import io
import re
from collections.abc import Iterable, Iterator
from pathlib import Path
from string import Template
from typing import Any

import nbformat
import numpy as np
from browser import LIKE_A_CARD, find_chromium, open_browser
from PIL import Image
from playwright.async_api import Page

from tutorial.notebook.widgets.joystick import Joystick
from tutorial.view import replay
from tutorial.view.assets import zipped_viewer

SHOWN = Path(__file__).parents[2] / "book" / "shown"
WIDGET = re.compile(r"(SceneView|NodeGraph|JointPlot|Picture|ImageView|SideBySide|FloatProgress)\(")
"""The beginning of each widget's text, for widgets that get a picture. `keepsakes` has all but FloatProgress."""

WIDTH = 800  # a cell's width [CSS pixels]
QUALITY = 60  # JPEG quality, out of 100
HEIGHT = 240  # a view's maximum [CSS pixels]: JupyterLab scrolls before a live view replaces the picture
COLOURS = 32  # in a PNG
SQUARE = 4  # [pixels] side of the squares whose averages are compared, because JPEG changes single pixels
DIFFERENT = 24  # out of 255: a difference between two colours that is easy to see
FEW = 12  # squares that may differ: two digits do, a turning turret differs in more

PAGE = Template((Path(__file__).parent / "data" / "notebook_picture.html").read_text(encoding="utf-8"))
REPLAYS = "[...document.querySelectorAll('.tank-replay')]"
STICKS = "[...document.querySelectorAll('.joystick')]"
ARE_OPEN = f"""{REPLAYS}.every(({{replay}}) => replay?.picture) &&
    {STICKS}.every((sticks) => sticks.querySelector('.tank-joystick-status')?.textContent)"""
SEEK = f"{REPLAYS}.forEach(({{replay, dataset}}) => replay.seek(Number(dataset.at ?? replay.duration)))"
ARE_DRAWN = f"{REPLAYS}.every(({{replay}}) => !replay.picture.viewer.needs_render)"


async def store_pictures(paths: Iterable[Path], shown: Path = SHOWN) -> None:
    """Draw what the widgets of notebooks showed, and store each picture that looks different from the stored one.

    Args:
        paths: the notebooks' files.
        shown: the folder in which each notebook has a folder of saved figures.
    """
    chromium = find_chromium()
    if chromium is None:
        print("The notebooks keep the pictures they had, because there is no Chromium: apt-get install chromium")
        return
    async with open_browser(chromium, WIDTH, 600) as page:
        await page.add_init_script(LIKE_A_CARD)
        await page.goto("about:blank")  # content that is set later does not run the script
        for path in paths:
            notebook = nbformat.read(path, as_version=4)
            kept = (shown / path.stem / f"{number}.html" for number in range(1, 1000))
            count = 0
            for _, text, output in _pictured(notebook):
                is_kept = not text.startswith("FloatProgress(")
                figures = find_figures(next(kept).read_text(encoding="utf-8")) if is_kept else []
                count += store(output, await draw(page, text, figures), describe(text, figures))
            nbformat.write(notebook, path)
            print(f"{path.name}: {count} new pictures")


def keep_pictures(before: Any, now: Any) -> None:
    """Copy a notebook's pictures into a later run of it, where the same cell shows the same widget."""
    pictures = [(source, text, output) for source, text, output in _pictured(before)]
    for source, text, output in _pictured(now):
        for old in pictures:
            if old[:2] == (source, text):
                pictures.remove(old)
                output.update(data=old[2].data | output.data, metadata=old[2].metadata)
                break


def _pictured(notebook: Any) -> Iterator[tuple[str, str, Any]]:
    """Yield the source of the cell, the text and the output for each output that gets a picture."""
    for cell in notebook.cells:
        for output in cell.get("outputs", ()):
            text = output.get("data", {}).get("text/plain", "")
            if WIDGET.match(text):
                yield cell.source, text, output


def store(output: Any, picture: Image.Image, alt: str) -> bool:
    """Store a picture, unless the output has one that looks the same. Return whether it did."""
    is_photo = re.search(r"(SceneView|ImageView)\(", output.data["text/plain"])
    kind = "image/jpeg" if is_photo else "image/png"
    if kind in output.data and _are_alike(picture, Image.open(io.BytesIO(base64.b64decode(output.data[kind])))):
        return False
    file = io.BytesIO()
    if is_photo:
        picture.save(file, "JPEG", quality=QUALITY, optimize=True, progressive=True)
    else:
        picture.quantize(COLOURS).save(file, "PNG", optimize=True)
    output.data[kind] = base64.b64encode(file.getvalue()).decode()
    width = round(picture.width * min(1.0, HEIGHT / picture.height)) if is_photo else picture.width
    output.metadata = {kind: {"alt": alt, "width": width}}
    return True


def _are_alike(one: Image.Image, other: Image.Image) -> bool:
    if one.size != other.size:
        return False
    first, second = (np.asarray(each.convert("RGB").reduce(SQUARE), int) for each in (one, other))
    return bool((np.abs(first - second).max(axis=-1) > DIFFERENT).sum() <= FEW)


def find_figures(kept: str) -> list[str]:
    """Return a widget's saved figures, in the order of the widget's text."""
    return re.findall(r"<figure.*?</figure>", kept, re.DOTALL)


async def draw(page: Page, text: str, figures: list[str]) -> Image.Image:
    """Draw what a widget showed, arranged as in its text, such as ``SideBySide(SceneView('a'), [Joystick()])``."""
    shown = _arranged(ast.parse(text, mode="eval").body, iter(figures))
    style, viewer = replay.style() + Joystick._css, base64.b64encode(zipped_viewer()).decode()
    parts = {"style": style, "viewer": viewer, "player": replay.script(), "joystick": Joystick._esm, "shown": shown}
    await page.set_content(PAGE.substitute(parts))
    await page.wait_for_function(ARE_OPEN)
    await page.evaluate(SEEK)
    await page.wait_for_function(ARE_DRAWN)
    return Image.open(io.BytesIO(await page.locator("#shown").screenshot())).convert("RGB")


def _arranged(widget: ast.expr, figures: Iterator[str]) -> str:
    if isinstance(widget, ast.List):
        return f'<div class="column">{"".join(_arranged(each, figures) for each in widget.elts)}</div>'
    assert isinstance(widget, ast.Call)
    match ast.unparse(widget.func):
        case "SideBySide":
            return f'<div class="row">{"".join(_arranged(each, figures) for each in widget.args)}</div>'
        case "Joystick":
            return '<div class="joystick"></div>'
        case "FloatProgress":
            label = next(each.value for each in widget.keywords if each.arg == "description")
            return f'{ast.literal_eval(label)} <progress value="1"></progress>'
        case _:
            return next(figures, "")


def describe(text: str, figures: list[str]) -> str:
    """Return the alternative text of a widget's picture."""
    if text.startswith("FloatProgress("):
        return "a progress bar that is full"
    parts = []
    for figure in figures:
        label = html.unescape(re.search(r'(?:aria-label|alt)="([^"]*)"', figure)[1]).rstrip(".")
        parts.append(f"the {label} in 3D" if "tank-replay" in figure else label)
    if "Joystick()" in text:
        parts.append("a joystick of two sticks")
    return "; beside it: ".join(parts)
