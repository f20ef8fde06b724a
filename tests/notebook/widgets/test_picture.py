"""The picture in a cell: what gets into the page, and what doesn't."""

from __future__ import annotations

import asyncio
import threading
from xml.etree import ElementTree

import pytest
from browser import chromium, open_browser, until

from tutorial.errors import WrongThreadError
from tutorial.notebook.widgets.picture import Picture
from tutorial.notebook.widgets.svg import INK, PAPER, draw, new_picture, shorten, to_text, write
from tutorial.view.assets import read_static

SHOW = """async ({script, traits}) => {
  const module = await import(URL.createObjectURL(new Blob([script], {type: "text/javascript"})));
  const handlers = {};
  window.model = {
    get: (name) => traits[name],
    set: (name, value) => { traits[name] = value; handlers[`change:${name}`]?.(); },
    on: (event, handler) => { handlers[event] = handler; },
    off: (event) => { delete handlers[event]; },
  };
  window.handlers = handlers;
  window.close_view = module.default.render({model, el: document.getElementById("cell")});
}"""

HOSTILE = """<svg xmlns="http://www.w3.org/2000/svg" xmlns:xlink="http://www.w3.org/1999/xlink" viewBox="0 0 9 9"
onload="bad()"><script>bad()</script><a href="javascript:bad()"><text>link</text></a><image href="http://x.invalid/p.png"/>
<g onclick="bad()"><rect width="9" height="9" style="fill:url(http://x.invalid/#p)"/><animate attributeName="href"/></g>
<foreignObject><body xmlns="http://www.w3.org/1999/xhtml"><img src="x" onerror="bad()"/></body></foreignObject>
<style>@import "http://x.invalid/s.css";</style><text xlink:href="#x">&lt;img src=x onerror=bad()&gt;</text></svg>"""


def in_browser(scenario, **traits):
    """Run a scenario on a page that shows the picture with these traits."""

    async def main():
        async with open_browser(chromium()) as page:
            await page.set_content("<div id='cell'></div>")
            await page.evaluate("() => { window.bad = () => { window.harmed = true; }; }")
            await page.evaluate(SHOW, {"script": read_static("picture.js"), "traits": traits})
            return await scenario(page)

    return asyncio.run(main())


def a_picture(colour: str = INK) -> str:
    root = new_picture(40, 20)
    draw(root, "rect", f"fill:{colour}", width=40, height=20)
    return to_text(root)


@pytest.fixture
def picture():
    picture = Picture(a_picture(), "a rectangle", "rectangle")
    yield picture
    picture.close()


def test_its_text_is_short(picture):
    assert repr(picture) == "Picture('rectangle')"


def test_it_shows_another_picture_with_its_description(picture):
    picture.show("<svg/>", "nothing")
    assert (picture.svg, picture.alt) == ("<svg/>", "nothing")


def test_it_belongs_to_its_thread(picture):
    errors = []

    def show():
        try:
            picture.show("", "")
        except WrongThreadError as error:
            errors.append(str(error))

    thread = threading.Thread(target=show, name="executor")
    thread.start()
    thread.join()
    assert errors == [
        "Picture.show was called on the thread 'executor', but the picture belongs to the thread 'MainThread'. "
        "Post the call instead: call_later(f, message)."
    ]


def test_closing_twice_is_fine():
    picture = Picture()
    picture.close()
    picture.close()


@pytest.mark.browser
def test_it_is_drawn_described_and_redrawn():
    async def scenario(page):
        svg = page.get_by_role("img", name="a rectangle")
        assert (await svg.bounding_box())["width"] == 40
        await page.evaluate("([svg]) => { model.set('alt', 'a dot'); model.set('svg', svg); }", [a_picture("red")])
        assert await page.get_by_role("img", name="a dot").count() == 1
        assert await page.locator("svg").count() == 1
        await page.evaluate("model.set('svg', 'no < picture')")
        assert await page.locator("svg").count() == 0
        assert await page.evaluate("(close_view(), Object.keys(handlers).length)") == 0

    in_browser(scenario, svg=a_picture(), alt="a rectangle")


@pytest.mark.browser
def test_it_follows_the_theme():
    async def scenario(page):
        def colour(selector, name):
            return page.evaluate(f"getComputedStyle(document.querySelector('{selector}'))['{name}']")

        plain = [await colour("svg", "backgroundColor"), await colour("rect", "fill")]
        await page.evaluate(
            "document.body.style = '--jp-layout-color0: rgb(1, 2, 3); --jp-ui-font-color1: rgb(4, 5, 6)'"
        )
        return plain, [await colour("svg", "backgroundColor"), await colour("rect", "fill")]

    plain, dark = in_browser(scenario, svg=a_picture(), alt="")
    assert plain == ["rgb(255, 255, 255)", "rgb(33, 33, 33)"]
    assert dark == ["rgb(1, 2, 3)", "rgb(4, 5, 6)"]
    assert PAPER.startswith("var(--jp-layout-color0")


@pytest.mark.browser
def test_nothing_but_shapes_gets_into_the_page():
    async def scenario(page):
        asked = []
        page.on("request", lambda request: asked.append(request.url))
        await page.evaluate("([svg]) => model.set('svg', svg)", [HOSTILE])

        async def is_shown():
            return await page.locator("svg text").count() == 1

        await until(is_shown, "the picture is shown")
        await page.locator("svg").click(force=True)
        html = await page.locator("#cell").inner_html()
        return html, asked, await page.evaluate("window.harmed")

    html, asked, harmed = in_browser(scenario, svg="", alt="")
    assert harmed is None
    assert asked == []
    for word in ("script", "onload", "onclick", "href", "foreignObject", "url(", "style", "animate", "image", "link<"):
        assert word not in html, word
    assert "&lt;img src=x onerror=bad()&gt;" in html


class TestSvg:
    def test_every_name_is_escaped(self):
        root = new_picture(10, 10)
        text = write(root, 1, 2, "<b>&\x00\x1b\ud800")
        draw(text, "title").text = "a\x01b"
        read = ElementTree.fromstring(to_text(root))
        assert read[0].text == r"<b>&\x00\x1b\ud800"
        assert read[0][0].text == r"a\x01b"

    def test_numbers_are_short(self):
        assert 'x1="1.5" y1="2"' in to_text(draw(new_picture(1, 1), "line", x1=1.5, y1=2.0))

    @pytest.mark.parametrize("number", [float("nan"), float("inf")])
    def test_a_place_is_a_number(self, number):
        with pytest.raises(ValueError, match="is no place in a picture"):
            draw(new_picture(1, 1), "line", x1=number)

    @pytest.mark.parametrize(("text", "short"), [("abcdef", "abcdef"), ("abcdefg", "abc…fg"), ("a" * 99, "aaa…aa")])
    def test_the_middle_of_a_long_name_is_left_out(self, text, short):
        assert shorten(text, 6) == short
