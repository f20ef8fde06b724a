"""Make the README's picture: in a notebook, the joystick drives the tank to the rail and back. ``make screenshots``."""

import asyncio
import io
import json
import os
import tempfile
from pathlib import Path

import numpy as np
from browser import LIKE_A_CARD, TIMEOUT, Witness, chromium, open_browser
from lab import copy_files, jupyter_lab
from PIL import Image

from tutorial.ros.domains import reserved_domain
from tutorial.system.paths import HOME

PATH = HOME / "book/images/drive.webp"
FRAME = 0.1  # [s] between two pictures
WIDTH = 800  # [pixels]
QUALITY = 60  # out of 100, for WebP
SOON = 0.38  # largest movement of a stick between two pictures

CELL = """
from tutorial.notebook import joystick, open_program, side_by_side

program = open_program("step1")
program.start()
side_by_side(program.view, joystick())
""".strip()

DIRECTOR = """
import json
import numpy as np
from tutorial.notebook import until
from tutorial.view.bodies import CAMERA

far, room = map(np.array, CAMERA)
barrel = np.array([0.1, 0.0, 0.1])  # from the centre of the tank
arms = far - room, np.array([-0.6, -1.1, 0.36])  # from the target to the camera, at the start and at the end
lengths = np.linalg.norm(arms, axis=1)

program.stop()
joy = program.controller("TankController").joy
joint = program.body("Tank").joint("TURRET_P")
pose = program.body("Tank").data.body("Tank/CHASSIS").xpos
start, rail = pose[0], 2.655

def follow():
    "Move the camera along with the tank, from a view of the room to a view of the barrel."
    way = np.clip((pose[0] - start) / (rail - start), 0, 1)
    near = way * way * (3 - 2 * way)
    target = room + near * (pose + barrel - room)
    arm = arms[0] / lengths[0] * (1 - near) + arms[1] / lengths[1] * near
    arm *= lengths[0] ** (1 - near) * lengths[1] ** near / np.linalg.norm(arm)
    program.view.scene.look_at(tuple((target + arm).tolist()), tuple(target.tolist()))
    return [*pose, *target, *(target + arm)]

def touching():
    model, data = program.simulation.model, program.simulation.world.data
    return ["Labo/RAIL", "Tank/BARREL"] in [sorted(model.geom(g).name for g in pair) for pair in data.contact.geom]

async def take(stick, seconds):
    "Advance the simulation with the stick held, and print the resulting state."
    await until(lambda: len(joy.get().axes) > 1 and abs(joy.get().axes[1] - stick) < 0.01)
    program.advance(seconds)
    program.host.refresh()
    seen = follow()
    program.host.refresh()
    print(json.dumps({"driven": pose[0] - start, "touching": touching(), "barrel": joint.position, "seen": seen}))
"""
IS_SEEN = """([pane, wanted]) => {
    const {viewer} = pane, {camera, controls} = viewer;
    const tank = viewer.scene_tree.find(["Bodies", "Tank", "Tank.CHASSIS"]).object;
    const [[toX, toY, toZ], [x, y, z]] = [controls.target.toArray(), camera.position.toArray()];
    const shown = [...tank.position.toArray(), toX, -toZ, toY, x, -z, y];
    return !viewer.needs_render && shown.every((number, i) => Math.abs(number - wanted[i]) < 1e-4);
}"""


async def drive(folder: Path) -> list[Image.Image]:
    """Drive the tank to the rail and back, and return a picture of the cell every `FRAME` seconds."""
    async with jupyter_lab(folder) as lab, open_browser(chromium(), 1280, 800) as page:
        await page.add_init_script(LIKE_A_CARD)
        copy_files(lab, HOME / "project")
        witness = Witness(page)
        notebook = await lab.open(page, lab.write("drive.ipynb", [CELL]))
        await page.evaluate("void window.jupyterapp.commands.execute('application:toggle-left-area')")
        await notebook.run(0)
        await notebook.run_new(DIRECTOR)
        await page.locator(".tank-stick-pad").first.hover()
        await page.mouse.down()
        part = await notebook.cell(0).bounding_box()
        pad = await page.locator(".tank-stick-pad").first.bounding_box()
        pane = await page.locator(".tank-view-pane").element_handle()
        size = WIDTH, round(WIDTH * part["height"] / part["width"])
        takes, pictures, stick = [], [], 0.0

        async def take(towards: float) -> None:
            """Move the stick towards a position, take a picture, and save the tank's state with it."""
            nonlocal stick
            stick += float(np.clip(towards - stick, -SOON, SOON))
            y = pad["y"] + (0.5 - 0.28 * stick) * pad["height"]
            await page.mouse.move(pad["x"] + pad["width"] / 2, y)
            takes.append(json.loads(await notebook.run_new(f"await take({stick}, {FRAME})")))
            await page.wait_for_function(IS_SEEN, arg=[pane, takes[-1]["seen"]])
            picture = Image.open(io.BytesIO(await page.screenshot(clip=part))).convert("RGB")
            pictures.append(picture.resize(size, Image.Resampling.LANCZOS))

        for _ in range(4):
            await take(0)
        while not takes[-1]["touching"]:
            await take(0.85)
        for _ in range(10):
            await take(0.85)
        while takes[-1]["driven"] > 0.08:
            await take(-min(1.0, 0.15 + takes[-1]["driven"]))
        for _ in range(3):
            await take(0)  # the picture is a loop, so it ends where it starts
        await page.mouse.up()
        assert max(take["barrel"] for take in takes) > takes[0]["barrel"] + 0.05, "the rail has not lifted the barrel"
        assert witness.complaints == []
        return pictures


def main() -> None:
    with reserved_domain() as domain, tempfile.TemporaryDirectory() as folder:
        os.environ["ROS_DOMAIN_ID"] = str(domain)
        first, *others = asyncio.run(asyncio.wait_for(drive(Path(folder)), 28 * TIMEOUT))
    how = {"duration": round(1000 * FRAME), "loop": 0, "quality": QUALITY, "method": 6}
    first.save(PATH, save_all=True, append_images=others, **how)


if __name__ == "__main__":
    main()
