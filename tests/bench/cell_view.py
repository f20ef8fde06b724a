"""What the 3D view in a cell costs its kernel, and how much of it reaches the page. In seconds, as `costs`."""

from __future__ import annotations

import asyncio
import atexit
import tempfile
import threading
from collections.abc import Callable
from functools import cache
from pathlib import Path

import zmq
from browser import chromium, open_browser
from jupyter_client.manager import start_new_kernel
from lab import jupyter_lab

FRAMES = 500
WATCHED = 5.0  # [s]

Timed = Callable[[], float]

SETUP = """
import itertools, time, warnings
import numpy as np
from tutorial.body import Body
from tutorial.paths import HOME
from tutorial.view.scene import Scene, unpack_records
from tutorial.view.bodies import View
from tutorial.notebook.widgets.scene_view import SceneView
from tutorial.world import Placement
warnings.simplefilter("ignore")
import meshcat

body = Body.displayed(Placement("Tank", HOME / "project" / "models" / "tank.xml"))
angles = itertools.count(1)

def move():
    body.qpos[:] = 0.001 * next(angles)
    body.calc_forward_kinematics()

scene = Scene()
view = View(scene)
view.add("Tank", body.model)
nodes = []
scene.attach(lambda message: nodes.append(len(unpack_records(message))))
move(); view.update("Tank", body.data); view.flush()
scene.detach(scene._sinks[0])
shown = SceneView(scene)
shown._audience.join("page")

def ours():
    move()
    view.update("Tank", body.data)
    shown._next_at = 0.0
    view.flush()
    shown._audience.note("page", shown._audience.frame)

visualizer = meshcat.Visualizer(zmq_url=ADDRESS)
parts = [visualizer[str(i)] for i in range(nodes[-1])]
matrix = np.eye(4)

def meshcats():
    move()
    for i, part in enumerate(parts):
        matrix[:3, :3], matrix[:3, 3] = body.data.xmat[i].reshape(3, 3), body.data.xpos[i]
        part.set_transform(matrix)

def timed(job):
    began = time.perf_counter()
    for _ in range(FRAMES):
        job()
    return (time.perf_counter() - began) / FRAMES
"""

DISPLAY = """
import tutorial
from sensor_msgs.msg import JointState
from tutorial.host import Host
from tutorial.paths import find_project
from tutorial.project import Project
from tutorial.ros.node_thread import NodeThread
from tutorial.view.scene import Scene
from tutorial.view.bodies import View
from tutorial.notebook.widgets.scene_view import SceneView

scene = Scene()
view = View(scene)
publisher = NodeThread("simulation")
topic = publisher.node.create_publisher(JointState, "Tank/joint_state", 1)
sent = 0

def publish():
    global sent
    sent += 1
    message = JointState(name=["TURRET_Y", "TURRET_P"], position=[0.01 * sent, 0.0])
    message.header.stamp = publisher.node.get_clock().now().to_msg()
    topic.publish(message)

publisher.node.create_timer(1 / 50, publish)
SceneView(scene)
"""
RUN = """
async with Host(Project.load(find_project("step3")), view=view) as host:
    await host.run(600)
"""
COUNT = """(pane, seconds) => new Promise((resolve) => {
    const {viewer} = pane, {set_transform} = viewer;
    let began = 0, frames = 0;
    viewer.set_transform = function (path, matrix) {
        const now = performance.now();
        if (path.at(-1).endsWith("TURRET_Y")) {
            if (began) frames += 1; else began = now;
            if (now - began > 1000 * seconds) {
                viewer.set_transform = set_transform;
                resolve((now - began) / 1000 / frames);
            }
        }
        set_transform.call(viewer, path, matrix);
    };
})"""


def cell_frame() -> tuple[Timed, Timed]:
    """A frame in which all of the tank moves, in a kernel of its own, sent to its page; and meshcat's own calls."""
    manager, client = start_new_kernel()
    atexit.register(manager.shutdown_kernel, now=True)

    def execute(code: str) -> str:
        printed: list[str] = []
        hook = printed.append
        reply = client.execute_interactive(code, output_hook=lambda message: hook(message["content"].get("text", "")))
        if reply["content"]["status"] != "ok":
            raise RuntimeError("\n".join(reply["content"]["traceback"]))
        return "".join(printed)

    execute(f"ADDRESS, FRAMES = {_answering()!r}, {FRAMES}")
    execute(SETUP)
    return lambda: float(execute("print(timed(ours))")), lambda: float(execute("print(timed(meshcats))"))


def _answering() -> str:
    """The address, on this machine only, of somebody who answers meshcat in its server's place."""
    socket = zmq.Context.instance().socket(zmq.REP)
    port = socket.bind_to_random_port("tcp://127.0.0.1")

    def answer() -> None:
        while True:
            socket.recv_multipart()
            socket.send(b"ok")

    threading.Thread(target=answer, daemon=True).start()
    return f"tcp://127.0.0.1:{port}"


def updates_in_the_page() -> tuple[Timed, None]:
    """From one update of the scene to the next, in a page that shows a program which gets 50 messages a second.

    Calling it raises ``pytest.skip.Exception`` where there is no browser; the text says why.
    """
    return cache(lambda: asyncio.run(_watch(chromium()))), None


async def _watch(path: str) -> float:
    with tempfile.TemporaryDirectory() as folder:
        async with jupyter_lab(Path(folder)) as lab, open_browser(path) as page:
            notebook = await lab.open(page, lab.write("bench.ipynb", [DISPLAY, RUN]))
            await notebook.run(0)
            assert await notebook.errors() == []
            await notebook.start(1)
            pane = page.locator(".tank-view-pane")
            await page.locator(".tank-view-curtain").wait_for(state="hidden")
            return float(await pane.evaluate(COUNT, WATCHED))
