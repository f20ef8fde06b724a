"""Widgets in a page. Names that contain markup are shown as text, and run no script."""

import base64
from html import escape

import mujoco
import numpy as np
import pytest
from browser import chromium, open_browser, pixels, red_spot
from loops import until
from sensor_msgs.msg import JointState

from tutorial.controllers.camera_publisher import image
from tutorial.joints import match_joints
from tutorial.notebook.desk import keep
from tutorial.notebook.widgets.image_view import ImageView
from tutorial.notebook.widgets.joystick import Joystick
from tutorial.notebook.widgets.picture import Picture
from tutorial.notebook.widgets.scene_view import SceneView
from tutorial.notebook.widgets.svg import INK, draw, new_picture, to_text
from tutorial.view.assets import zipped_viewer
from tutorial.view.bodies import View
from tutorial.view.scene import Scene

from .pages import say

pytestmark = [pytest.mark.browser, pytest.mark.timeout(300)]

SCRIPT = "</title></script><script>window.pwned=1</script>"
MARKUP = "<img src=x onerror=window.pwned=1>"
NAMES = (MARKUP, SCRIPT, f"'\"`{MARKUP}", "javascript:window.pwned=1", "{{ pwned }}")
SHOW = """async ({script, traits, scene, library, frame, pixels}) => {
  const bytes = (text) => new DataView(Uint8Array.from(atob(text), (c) => c.charCodeAt(0)).buffer);
  const module = await import(URL.createObjectURL(new Blob([script], {type: "text/javascript"})));
  const handlers = {};
  const answer = (...message) => setTimeout(() => handlers["msg:custom"](...message));
  const model = {
    get: (name) => traits[name],
    set: (name, value) => { traits[name] = value; handlers[`change:${name}`]?.(); },
    on: (event, handler) => { handlers[event] = handler; },
    off: (event) => { delete handlers[event]; },
    send: ({type, view}) => {
      (window.said ??= []).push(type);
      if (type === "library") answer({type}, [bytes(library)]);
      if (type === "hello") answer({...frame, type: "whole", frame: 0, view}, [bytes(scene ?? pixels)]);
    },
  };
  const el = document.body.appendChild(document.createElement("div"));
  Object.assign(window, {model, handlers, close_view: module.default.render({model, el})});
}"""
"""Render a widget beside those that exist; to a view, act as the kernel."""

HOSTILE = """<svg xmlns="http://www.w3.org/2000/svg" xmlns:xlink="http://www.w3.org/1999/xlink" viewBox="0 0 9 9"
onload="bad()"><script>bad()</script><a href="javascript:bad()"><text>link</text></a><image href="http://x.invalid/p.png"/>
<g onclick="bad()"><rect width="9" height="9" style="fill:url(http://x.invalid/#p)"/><animate attributeName="href"/></g>
<foreignObject><body xmlns="http://www.w3.org/1999/xhtml"><img src="x" onerror="bad()"/></body></foreignObject>
<style>@import "http://x.invalid/s.css";</style><text xlink:href="#x">&lt;img src=x onerror=bad()&gt;</text></svg>"""

HARMFUL = ("script", "onload", "onclick", "href", "foreignObject", "url(", "<style", "animate", "image", "link<")


def a_picture(colour: str = INK) -> str:
    root = new_picture(40, 20)
    draw(root, "rect", f"fill:{colour}", width=40, height=20)
    return to_text(root)


async def show_picture(page, svg: str, alt: str):
    await page.evaluate(SHOW, {"script": Picture._esm, "traits": {"svg": svg, "alt": alt}})


async def test_a_picture_is_drawn_described_redrawn_and_themed():
    async with open_browser(chromium()) as page:
        await page.evaluate("() => { window.bad = () => { window.harmed = true; }; }")
        await show_picture(page, a_picture(), "a rectangle")
        assert (await page.get_by_role("img", name="a rectangle").bounding_box())["width"] == 40
        assert await colours(page) == ["rgb(255, 255, 255)", "rgb(33, 33, 33)"]
        await page.evaluate(
            "document.body.style = '--jp-layout-color0: rgb(1, 2, 3); --jp-ui-font-color1: rgb(4, 5, 6)'"
        )
        assert await colours(page) == ["rgb(1, 2, 3)", "rgb(4, 5, 6)"]
        await page.evaluate("([svg]) => { model.set('alt', 'a dot'); model.set('svg', svg); }", [a_picture("red")])
        assert await page.get_by_role("img", name="a dot").count() == 1
        assert await page.locator("svg").count() == 1
        await page.evaluate("model.set('svg', 'no < picture')")
        assert await page.locator("svg").count() == 0
        asked = []
        page.on("request", lambda request: asked.append(request.url))
        await page.evaluate("([svg]) => model.set('svg', svg)", [HOSTILE])
        await until(lambda: shown(page, "svg text", 1), "the picture is shown")
        await page.locator("svg").click(force=True)
        html = await page.locator("body").inner_html()
        assert await page.evaluate("window.harmed") is None
        assert asked == []
        for word in HARMFUL:
            assert word not in html, word
        assert "&lt;img src=x onerror=bad()&gt;" in html
        assert await page.evaluate("(close_view(), Object.keys(handlers).length)") == 0


async def colours(page) -> list[str]:
    """Return the colours of the picture's paper and ink."""
    style = "getComputedStyle(document.querySelector('{}')).{}"
    return [await page.evaluate(style.format(*each)) for each in (("svg", "backgroundColor"), ("rect", "fill"))]


async def test_camera_images_are_drawn_until_the_end_is_shown(domain, sent):
    view = keep("pictures", ImageView, ImageView.close)
    rows = np.zeros((40, 60, 3), np.uint8)
    rows[10:20, 40:50] = 255, 0, 0
    view._on_image(image(rows))
    await say(view, "hello")
    [(frame, [pixels_sent])] = sent
    async with open_browser(chromium()) as page:
        traits = {"title": view.title, "ended": False}
        await page.evaluate(
            SHOW, {"script": ImageView._esm, "traits": traits, "frame": frame, "pixels": text_of(pixels_sent)}
        )
        await page.get_by_text(frame["line"]).wait_for()
        picture = await pixels(page, "canvas")
        x, y = red_spot(picture)
        await page.wait_for_function("said.includes('seen')")
        assert (x / picture.shape[1], y / picture.shape[0]) == pytest.approx((45 / 60, 15 / 40), abs=0.03)
        await page.evaluate("model.set('ended', true)")
        await page.get_by_text("closed: this is its last image").wait_for()


async def test_sticks_shrink_side_by_side():
    async with open_browser(chromium(), width=400) as page:
        await page.add_style_tag(content=Joystick._css)
        await page.evaluate(SHOW, {"script": Joystick._esm, "traits": {"ended": False}})
        for width, size in ((400, 148), (180, 60)):
            await page.set_viewport_size({"width": width, "height": 600})
            left, right = [await page.locator(".tank-stick-pad").nth(i).bounding_box() for i in range(2)]
            assert left["y"] == right["y"]
            assert left["width"] == left["height"] == pytest.approx(size, abs=10)
            assert await page.evaluate("document.documentElement.scrollWidth") <= width


def scene_of(name: str) -> Scene:
    """Return a scene in which a body, a link, a joint and a message's line have the same name."""
    quoted = escape(name, quote=True)
    link = f"<body name='{quoted}'><joint name='{quoted}'/><geom size='.1'/></body>"
    scene = Scene()
    model = mujoco.MjModel.from_xml_string(f"<mujoco><worldbody>{link}</worldbody></mujoco>")
    View(scene).add(name.replace("/", "_"), model)
    scene.line(f"{name}: {match_joints({}, JointState(name=[name], position=[0.0]))[1]}")
    scene.flush()
    return scene


async def test_a_name_runs_no_script():
    async with open_browser(chromium()) as page:
        for name in NAMES:
            traits = {"title": name, "ended": False}
            parts = {"scene": text_of(scene_of(name).snapshot()), "library": text_of(zipped_viewer())}
            await page.evaluate(SHOW, {"script": SceneView._esm, "traits": traits, **parts})
        await until(lambda: shown(page, ".tank-view-line", len(NAMES)), "the lines below the views")
        lines = await page.locator(".tank-view-line").all_text_contents()
        assert [line.startswith(name) for line, name in zip(lines, NAMES, strict=True)] == [True] * len(NAMES)
        assert await page.evaluate("window.pwned") is None
        assert await page.locator("img, iframe, object, embed").count() == 0
        await page.evaluate("model.set('ended', true)")
        await page.get_by_text("closed: this is its last picture").last.wait_for()


def text_of(data: bytes) -> str:
    return base64.b64encode(data).decode()


async def shown(page, selector: str, count: int) -> bool:
    return await page.locator(f"{selector}:visible").count() == count
