"""Names that are markup, in the program's page and in a notebook's cell: they are text there, and run nothing."""

from __future__ import annotations

import asyncio
import base64
from html import escape

import mujoco
import pytest
from browser import chromium, open_browser, until
from hostile_peer import MARKUP
from sensor_msgs.msg import JointState

from tutorial.joints import match_joints
from tutorial.notebook.widgets.graph_picture import picture as draw_graph
from tutorial.notebook.widgets.graph_watch import TopicNews, Topology
from tutorial.notebook.widgets.joint_plot import _History, _picture
from tutorial.notebook.widgets.scene_view import SceneView
from tutorial.notebook.widgets.swimlane import swimlane
from tutorial.trace import Handoff, HandoffTrace, Moment
from tutorial.view.assets import read_static, zipped_viewer
from tutorial.view.bodies import View
from tutorial.view.scene import Scene
from tutorial.view.web import SceneServer

SCRIPT = "</title></script><script>window.pwned=1</script>"
NAMES = (MARKUP, SCRIPT, f"'\"`{MARKUP}", "javascript:window.pwned=1", "{{ pwned }}")

SHOW = """async ({script, traits, scene, library}) => {
  const bytes = (text) => new DataView(Uint8Array.from(atob(text), (c) => c.charCodeAt(0)).buffer);
  const module = await import(URL.createObjectURL(new Blob([script], {type: "text/javascript"})));
  const handlers = {};
  const answer = (...message) => setTimeout(() => handlers["msg:custom"](...message));
  module.default.render({el: document.body.appendChild(document.createElement("div")), model: {
    get: (name) => traits[name],
    on: (event, handler) => { handlers[event] = handler; },
    off: () => {},
    send: ({type, view}) => {
      if (type === "library") answer({type}, [bytes(library)]);
      if (type === "hello") answer({type: "scene", view}, [bytes(scene)]);
    },
  }});
}"""
"""Render a widget beside those that are there; to the 3D view, be the kernel."""


def scene_of(name: str) -> Scene:
    """A body, a link, a joint and the line of a message, all of one name."""
    quoted = escape(name, quote=True)
    link = f"<body name='{quoted}'><joint name='{quoted}'/><geom size='.1'/></body>"
    scene = Scene()
    model = mujoco.MjModel.from_xml_string(f"<mujoco><worldbody>{link}</worldbody></mujoco>")
    View(scene).add(name.replace("/", "_"), model)
    scene.line(f"{name}: {match_joints({}, JointState(name=[name], position=[0.0]))[1]}")
    scene.flush()
    return scene


def pictures_of(name: str) -> list[tuple[str, str]]:
    """Each picture that a cell may show, with its description."""
    graph = draw_graph(Topology({name: 1}, {name: TopicNews(name, 1.0, (name,), (name,))}))
    history = _History(10.0)
    history.add(JointState(name=[name], position=[0.0]))
    moment = Moment(0.0, name)
    trace = HandoffTrace()
    trace._keep(Handoff(name, received=moment, posted=moment, handled=moment, applied=moment))
    lanes = swimlane(trace)
    lanes.close()
    return [graph, (lanes.svg, lanes.alt), _picture(name, history.recent(), 10.0)]


@pytest.mark.browser
@pytest.mark.timeout(300)
def test_a_name_runs_no_script():
    path = chromium()

    async def main():
        async with open_browser(path) as page:

            async def is_clean():
                assert await page.evaluate("window.pwned") is None
                assert await page.locator("img, iframe, object, embed").count() == 0

            for name in NAMES:
                async with SceneServer(scene_of(name), 0, name) as server:
                    await page.goto(server.url)
                    await page.locator("#curtain").wait_for(state="hidden")
                    assert await page.title() == name
                    assert (await page.locator("#line").text_content()).startswith(name)
                    await is_clean()
            await page.goto("about:blank")
            for name in NAMES:
                for svg, alt in pictures_of(name):
                    await page.evaluate(SHOW, {"script": read_static("picture.js"), "traits": {"svg": svg, "alt": alt}})
                traits = {"title": name, "height": 90, "ended": False}
                parts = {"scene": text_of(scene_of(name).snapshot()), "library": text_of(zipped_viewer())}
                await page.evaluate(SHOW, {"script": SceneView._esm, "traits": traits, **parts})
            await until(lambda: shown(page, ".tank-view-line", len(NAMES)), "the lines below the views")
            lines = await page.locator(".tank-view-line").all_text_contents()
            assert [line.startswith(name) for line, name in zip(lines, NAMES, strict=True)] == [True] * len(NAMES)
            assert await page.locator("svg").count() == 3 * len(NAMES)
            await is_clean()

    asyncio.run(main())


def text_of(data: bytes) -> str:
    return base64.b64encode(data).decode()


async def shown(page, selector: str, count: int) -> bool:
    return await page.locator(f"{selector}:visible").count() == count
