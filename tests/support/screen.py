"""What a learner who presses Shift+Enter has on the screen: a notebook's views, plots, graphs and joysticks."""

import asyncio
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import nbformat
from lab import Notebook
from loops import until

SEE = "**What you should see:**"
HALF = 0.5  # of its area: then it counts as on the screen
WHOLE = 0.8  # of its area: then a new view counts as whole; what a cell prints below it may hide a strip at its top
GLANCE = 0.1  # [s] from one glance to the next
TOO_LONG = 3  # glances in which something moved off the screen
NAMES = """
const WIDGET = "application/vnd.jupyter.widget-view+json";
const SHOWN = [
    ".tank-view", ".tank-joystick", ".tank-image", "svg[role=img]", ".widget-hprogress", ".jupyter-widget-hprogress",
].map((kind) => `.jp-OutputArea-output ${kind}`).join();
"""
LOOK = """([number, isStart]) => {
    const panel = document.querySelector(".jp-NotebookPanel:not(.lm-mod-hidden) .jp-WindowedPanel-outer");
    const screen = panel.getBoundingClientRect();
    const share = (element) => {
        const {left, right, top, bottom} = element.getBoundingClientRect();
        const width = Math.min(right, screen.right) - Math.max(left, screen.left);
        const height = Math.min(bottom, screen.bottom) - Math.max(top, screen.top);
        return Math.max(0, width) * Math.max(0, height) / Math.max(1, (right - left) * (bottom - top));
    };
    // To measure what is in a cell off the screen, the browser would have to lay it out.
    const shareOf = (element, cell) => share(cell) && share(element);
    const poses = (node, path, all) => {
        const {position, quaternion, scale} = node.object;
        all[path] = [...position.toArray(), ...quaternion.toArray(), ...scale.toArray()];
        for (const [name, child] of Object.entries(node.children)) poses(child, `${path}/${name}`, all);
        return all;
    };
    const moved = (now, then) => !!now && !!then && Object.entries(now).some(([path, pose]) => {
        const old = then[path];
        if (!old) return true;
        const turn = pose.slice(3, 7).reduce((sum, each, i) => sum + each * old[3 + i], 0);
        return Math.abs(turn) < 1 - 5e-5 || [0, 1, 2, 7, 8, 9].some((i) => Math.abs(pose[i] - old[i]) > 0.01);
    });
    const sights = [...panel.querySelectorAll(".tank-view-pane")].map((pane) => {
        const bodies = pane.viewer?.scene_tree.children.Bodies;
        const now = bodies && poses(bodies, "", {});
        const moves = moved(now, pane.atLast);
        if (isStart) pane.atStart = now;
        const sight = {
            name: pane.ariaLabel, share: shareOf(pane, pane.closest(".jp-Cell")),
            has_moved: moved(now, pane.atStart), moves,
            is_new: Number(pane.closest(".jp-Cell").dataset.windowedListIndex) === number,
        };
        pane.atLast = now;
        return sight;
    });
    const cell = panel.querySelector(`.jp-Cell[data-windowed-list-index="${number}"]`);
    const {model} = window.jupyterapp.shell.currentWidget.content.widgets[number];
    const widgets = (model.outputs?.toJSON() ?? []).filter(({data = {}}) => WIDGET in data);
    const drawn = [...cell.querySelectorAll(".jp-OutputArea-child")].filter((output) => output.querySelector(SHOWN));
    const curtains = [...cell.querySelectorAll(".tank-view-curtain")];
    const isDrawn = drawn.length >= widgets.length && curtains.every((curtain) => curtain.hidden);
    return [sights, isDrawn];
}"""
HEIGHT = """([first, said]) => {
    const panel = document.querySelector(".jp-NotebookPanel:not(.lm-mod-hidden) .jp-WindowedPanel-outer");
    const cells = [...panel.querySelectorAll(".jp-Cell")].map((cell) => [Number(cell.dataset.windowedListIndex), cell]);
    const described = cells.filter(([number]) => first <= number && number < said).map(([, cell]) => cell);
    const shown = described.findLast((cell) => cell.querySelector(SHOWN))?.querySelector(SHOWN);
    if (!shown) return [0, panel.clientHeight];
    const {top} = shown.closest(".jp-OutputArea-output").getBoundingClientRect();
    const words = [...new Map(cells).get(said).querySelectorAll("strong")];
    const line = words.find((word) => word.textContent.startsWith("What you should see"));
    return [line.getBoundingClientRect().bottom - top, panel.clientHeight];
}"""
"""The height from the top of the last widgets in these cells to the line that says what to see; the screen's [px]."""


@dataclass
class Sight:
    """A 3D view on the page.

    Attributes:
        name: the view's name; the view may be shown several times.
        share: how much of it is on the screen, 0 to 1.
        has_moved: whether something in it has moved since the cell was started.
        moves: whether something in it has moved since the last glance.
        is_new: whether the cell that runs shows it.
    """

    name: str
    share: float
    has_moved: bool
    moves: bool
    is_new: bool


def described_cells(path: Path) -> Iterator[range]:
    """Yield for each *What you should see* the cells that it describes: back to the one before it, or to a heading."""
    first = 0
    for number, cell in enumerate(nbformat.read(path, as_version=4).cells):
        if cell.cell_type == "markdown":
            if SEE in cell.source:
                yield range(first, number)
            if SEE in cell.source or "\n#" in f"\n{cell.source}":
                first = number + 1


class Learner:
    """Somebody who presses Shift+Enter, waits for the cell, and looks.

    A view that moves between two cells belongs to a program that runs by itself, perhaps with pauses. Until a cell
    shows the view again, its motion is not the effect of a cell.

    Args:
        notebook: the open notebook, at its beginning.
        path: its file.
    """

    def __init__(self, notebook: Notebook, path: Path) -> None:
        self._missed: list[str] = []
        self._moved: dict[str, list[int]] = {}  # off the screen, and the cells that may have moved them
        self._running: set[str] = set()  # views of programs that run by themselves
        self._notebook = notebook
        cells = nbformat.read(path, as_version=4).cells
        self._code = {number for number, cell in enumerate(cells) if cell.cell_type == "code"}
        self._described = {cells[-1]: cells for cells in described_cells(path) if cells}

    @property
    def missed(self) -> list[str]:
        """What happened off the screen, one line each."""
        return [*self._missed, *(line for name in self._moved for line in self._lines(name))]

    def _lines(self, name: str) -> list[str]:
        return [f"cell {number} moves what is not on the screen: {name}" for number in self._moved.get(name, ())]

    async def run_cell(self, number: int) -> None:
        """Run the next cell, and note the effects off the screen. A cell of text has none."""
        if number in self._code:
            await self._run_code(number)
        else:
            await self._notebook.page.keyboard.press("Shift+Enter")
            await asyncio.sleep(GLANCE)
        if cells := self._described.get(number):
            height, screen = await self._notebook.page.evaluate(_with_names(HEIGHT), [cells.start, cells.stop])
            if height > screen:
                self._missed.append(f"what is shown up to cell {number} and its description need {height:.0f} px")

    async def _run_code(self, number: int) -> None:
        await self._look(number)
        await asyncio.sleep(GLANCE)
        before, _ = await self._look(number, is_start=True)
        for name in {sight.name for sight in before if sight.moves}:
            self._running.add(name)
            self._moved.pop(name, None)
        await self._notebook.page.keyboard.press("Shift+Enter")
        unseen: dict[str, int] = {}

        async def is_drawn() -> bool:
            await asyncio.sleep(GLANCE)
            sights, drawn = await self._look(number)
            for name in {sight.name for sight in sights if sight.moves} - _on_screen(sights):
                unseen[name] = unseen.get(name, 0) + 1
            return drawn

        async def has_run() -> bool:
            await is_drawn()
            return not await self._notebook.is_busy()

        await until(has_run, f"cell {number} to be done")
        assert await self._notebook.errors() == []
        await until(is_drawn, f"what cell {number} shows to be drawn")
        sights, _ = await self._look(number)
        gone = {sight.name for sight in sights if sight.has_moved} - _on_screen(sights)
        gone |= {name for name, glances in unseen.items() if glances > TOO_LONG}
        for name in gone - self._running:
            self._moved.setdefault(name, []).append(number)
        for sight in sights:
            if sight.is_new and sight.share < WHOLE:
                self._missed.append(f"cell {number} shows only {sight.share:.0%} of {sight.name}")
        for name in {sight.name for sight in sights if sight.is_new}:
            self._missed += self._lines(name)
            self._moved.pop(name, None)
            self._running.discard(name)

    async def _look(self, number: int, is_start: bool = False) -> tuple[list[Sight], bool]:
        sights, drawn = await self._notebook.page.evaluate(_with_names(LOOK), [number, is_start])
        return [Sight(**sight) for sight in sights], drawn


def _on_screen(sights: list[Sight]) -> set[str]:
    return {sight.name for sight in sights if sight.share >= HALF}


def _with_names(function: str) -> str:
    return f"(given) => {{ {NAMES} return ({function})(given); }}"
