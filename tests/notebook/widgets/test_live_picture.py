"""Live pictures in a real JupyterLab."""

from __future__ import annotations

import asyncio
import re

import pytest
from browser import Witness, chromium, open_browser
from lab import DARK, jupyter_lab

SIMULATION = """
import math
import tutorial
from sensor_msgs.msg import JointState
from tutorial.ros.node_thread import NodeThread
from tutorial.notebook.widgets.joint_plot import JointPlot
from tutorial.notebook.widgets.node_graph import NodeGraph

simulation = NodeThread("simulation")
publisher = simulation.node.create_publisher(JointState, "/Tank/joint_state", 1)
count = 0

def publish():
    global count
    count += 1
    message = JointState(name=["TURRET_Y", "TURRET_P"], position=[math.sin(count / 50), 0.25])
    message.header.stamp.sec, message.header.stamp.nanosec = divmod(count * 20_000_000, 10**9)
    publisher.publish(message)

timer = simulation.node.create_timer(0.02, publish)
"""
CELLS = [SIMULATION, "plot = JointPlot()\nplot", "graph = NodeGraph()\ngraph"]
CLOSE = (
    "import threading\nplot.close(); graph.close(); simulation.close()\nprint(*{t.name for t in threading.enumerate()})"
)


@pytest.mark.browser
@pytest.mark.timeout(240)
def test_they_live_in_a_notebook(domain, tmp_path):
    async def main():
        path = chromium()
        async with jupyter_lab(tmp_path, "/user/ada/", DARK) as lab, open_browser(path, 1000, 800) as page:
            witness = Witness(page)
            notebook = await lab.open(page, lab.write("live.ipynb", CELLS))
            await notebook.run_all()
            plot = page.get_by_role("img", name=re.compile(r"TURRET_P \+0\.2500 rad"))
            graph = page.get_by_role("img", name=re.compile(r"joint_state \(.* Hz\): from .simulation to .joint_plot"))
            await plot.wait_for()
            await graph.wait_for()
            await plot.locator("polyline").nth(1).wait_for(state="attached")
            await graph.locator("ellipse").nth(1).wait_for(state="attached")
            assert await plot.evaluate("(svg) => getComputedStyle(svg).backgroundColor") == await page.evaluate(
                "getComputedStyle(document.querySelector('.jp-Notebook')).backgroundColor"
            )
            texts = [output["data"]["text/plain"] for cell in (1, 2) for output in await notebook.outputs(cell)]
            assert texts == ["JointPlot('/Tank/joint_state')", "NodeGraph()"]
            assert "executor" not in await notebook.run_new(CLOSE)
            assert await notebook.errors() == []
            assert witness.complaints == []
            own = (lab.root, lab.root.replace("http", "ws"), "data:", "blob:")
            assert [url for url in witness.requests if not url.startswith(own)] == []

    asyncio.run(asyncio.wait_for(main(), 200))
