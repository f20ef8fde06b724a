"""The process that answers the doctor's questions: ``python -m tutorial.commands.doctor._child QUESTION``.

The answer is the last line it prints, as JSON. An alarm ends it if nobody else does.
"""

from __future__ import annotations

import asyncio
import importlib
import json
import signal
import sys
import time
from importlib.metadata import PackageNotFoundError, version
from typing import Any

ALARM = 60  # [s]
LISTEN = 4.0  # [s] before the graph may count as settled: nodes on Fast DDS show up after 1 to 4 s
SCENE = "<mujoco><worldbody><light pos='0 0 3'/><geom size='1' rgba='1 1 1 1'/></worldbody></mujoco>"


def mujoco() -> str:
    """Which MuJoCo can be imported."""
    return str(importlib.import_module("mujoco").__version__)


def rendering() -> bool:
    """Whether a picture drawn off the screen has anything on it."""
    mj: Any = importlib.import_module("mujoco")
    model = mj.MjModel.from_xml_string(SCENE)
    data = mj.MjData(model)
    mj.mj_forward(model, data)
    with mj.Renderer(model, 16, 16) as renderer:
        renderer.update_scene(data)
        return bool(renderer.render().any())


def rclpy() -> dict[str, str]:
    """Which rclpy can be imported, and through which middleware it talks."""
    module: Any = importlib.import_module("rclpy")
    utilities: Any = importlib.import_module("rclpy.utilities")
    try:
        number = version("rclpy")
    except PackageNotFoundError:
        number = ""
    return {"file": module.__file__, "version": number, "rmw": utilities.get_rmw_implementation_identifier()}


def nodes() -> dict[str, Any]:
    """Who is in the domain, but for hidden nodes, which this one is; and whether that has stopped changing."""
    ros: Any = importlib.import_module("tutorial.ros.node_thread")
    topics: Any = importlib.import_module("tutorial.ros.topics")
    names: Any = importlib.import_module("tutorial.ros.topics.names")
    with ros.NodeThread("_doctor") as thread:
        time.sleep(LISTEN)
        is_settled = asyncio.run(topics.wait_for_graph(thread.node))
        return {"settled": is_settled, "nodes": [names.shown(name) for name in topics.node_names(thread.node)]}


if __name__ == "__main__":
    signal.alarm(ALARM)
    questions = {"mujoco": mujoco, "rendering": rendering, "rclpy": rclpy, "nodes": nodes}
    print(json.dumps(questions[sys.argv[1]]()))  # noqa: T201 - its answer
