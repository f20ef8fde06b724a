"""Configure Sphinx to build the book from the pages in this folder and the notebooks with their committed outputs."""

import re
import shutil
import sys
from pathlib import Path
from typing import Any

BOOK = Path(__file__).parent
sys.path[:0] = [str(BOOK.parent), str(BOOK)]
sys.modules["rfc3987_syntax"] = None  # block this import: it takes a second, and no page needs it

# ruff: noqa: E402
from docutils.nodes import SkipNode
from drive_page import fetch, write_site
from latex2mathml.converter import convert
from notebook_pages import write_pages
from sphinx.util.logging import getLogger

import tutorial  # noqa: F401  (makes rclpy importable for the API page)
from tutorial.view import replay
from tutorial.view.assets import meshcats_viewer

project = "The tank tutorial"
author = "the authors of the tank tutorial"
copyright = "the authors of the tank tutorial"

extensions = ["myst_nb", "sphinx.ext.autodoc", "sphinx.ext.napoleon", "sphinx_copybutton"]
exclude_patterns = ["_build", "shown", "README.md"]
default_role = "code"
nb_execution_mode = "off"
nb_ipywidgets_js: dict[str, dict[str, str]] = {}
myst_enable_extensions = ["colon_fence", "dollarmath", "smartquotes"]
myst_heading_anchors = 3
napoleon_use_ivar = True
autodoc_member_order = "bysource"
autodoc_typehints = "description"
autodoc_typehints_description_target = "documented"
html_math_renderer = "mathml"
html_theme = "furo"
html_title = project
html_static_path = ["book.css"]
html_css_files = ["book.css"]
html_favicon = "images/icon.svg"
html_copy_source = False
html_domain_indices = False
html_show_sphinx = False
copybutton_prompt_text = "$ "
copybutton_only_copy_prompt_lines = False

logger = getLogger(__name__)

WITHOUT_NPM = "This copy of the book was built without npm, so you cannot drive the tank here."
VIEWER = ("main.min.js", "main.min.js.LICENSE.txt")


def setup(app: Any) -> None:
    """Write the notebooks' pages, and register the hooks that complete the pages and the site."""
    write_pages(BOOK.parent / "notebooks", BOOK / "notebooks")
    app.add_html_math_renderer("mathml", (visit_math, None), (visit_math_block, None))
    app.connect("env-get-outdated", lambda *_: ["controllers", "drive"])
    app.connect("source-read", add_controllers)
    app.connect("source-read", leave_drive_out)
    app.connect("html-page-context", add_player)
    app.connect("html-page-context", add_drive)
    app.connect("build-finished", write_player)


def add_controllers(_app: Any, page: str, source: list[str]) -> None:
    """Add the controllers' code to the page `controllers`, in the order of the notebooks."""
    if page == "controllers":
        for path in sorted((BOOK.parent / "notebooks").glob("[1-9]_*.ipynb")):
            number, name = path.stem.split("_", 1)
            files = (BOOK.parent / "tutorial" / "controllers").glob(f"{name}*.py")
            for file in sorted(file.name for file in files if f"{file.stem}_".startswith(f"{name}_")):
                source[0] += f"\n## Step {number}: `{file}`\n\n"
                source[0] += f"```{{literalinclude}} ../tutorial/controllers/{file}\n:language: python\n```\n"


def add_player(app: Any, _page: str, _template: str, context: dict[str, Any], _tree: Any) -> None:
    """Add the replay player to a page that has replays."""
    if '"tank-replay"' in context.get("body", ""):
        app.add_css_file("replay.css")
        app.add_js_file("main.min.js", loading_method="defer")
        app.add_js_file("replay.js", loading_method="defer")


def leave_drive_out(_app: Any, page: str, source: list[str]) -> None:
    """If npm is missing or fails, replace the drivable tank on the page `drive` with an explanation."""
    if page == "drive" and not fetch():
        source[0] = re.sub(r"```\{raw\} html.*?```", WITHOUT_NPM, source[0], flags=re.DOTALL)
        logger.info(WITHOUT_NPM)


def add_drive(app: Any, page: str, *_: Any) -> None:
    """Add the script and the style sheet to the page `drive`."""
    if page == "drive" and fetch():
        app.add_css_file("drive.css")
        app.add_js_file("drive.js", loading_method="defer")


def write_player(app: Any, error: Exception | None) -> None:
    """Write the replay player that all pages share, and the files of the page `drive`."""
    if error is not None or app.builder.format != "html":
        return
    static = Path(app.outdir) / "_static"
    write_site(static)
    static.joinpath("replay.js").write_text(replay.script(), encoding="utf-8")
    static.joinpath("replay.css").write_text(replay.style(), encoding="utf-8")
    for name in VIEWER:
        shutil.copy(meshcats_viewer() / name, static / name)


def visit_math(translator: Any, node: Any) -> None:
    """Write a formula as MathML, which browsers display without loading anything."""
    translator.body.append(convert(node.astext()))
    raise SkipNode


def visit_math_block(translator: Any, node: Any) -> None:
    """Write a formula as MathML, on a line of its own."""
    translator.body.append(convert(node.astext(), display="block"))
    raise SkipNode
