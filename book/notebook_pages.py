"""Turn the committed notebooks into pages of the book, with saved figures in place of their widgets."""

import json
import re
import shutil
from pathlib import Path
from typing import Any

from keepsakes import FOLDER, WIDGET

TERM = re.compile(r"\[([^\]]+)\]\(\.\./book/glossary\.md#term-([\w-]+)\)")
TERMS = {
    term.replace(" ", "-"): term
    for term in re.findall(r"^(\w.*)$", (FOLDER.parent / "glossary.md").read_text(encoding="utf-8"), re.MULTILINE)
}
CONTROLLERS = re.compile(r"\]\(\.\./tutorial/controllers[^)]*\)")


def write_pages(notebooks: Path, pages: Path, kept: Path = FOLDER) -> None:
    """Write every notebook, with its drawings, into the folder of pages, unless its page is up to date.

    Raises:
        FileNotFoundError: a displayed widget has no saved figure. Run ``make notebooks``.
    """
    pages.mkdir(exist_ok=True)
    for page in pages.glob("*.ipynb"):
        if not (notebooks / page.name).exists():
            page.unlink()
    shutil.copytree(notebooks / "images", pages / "images", dirs_exist_ok=True)
    for path in sorted(notebooks.glob("[0-9]*_*.ipynb")):
        notebook = json.loads(path.read_text(encoding="utf-8"))
        _put_in_place(notebook, kept / path.stem)
        text = json.dumps(notebook, ensure_ascii=False)
        page = pages / path.name
        if not page.is_file() or page.read_text(encoding="utf-8") != text:  # rewriting a page makes Sphinx rebuild it
            page.write_text(text, encoding="utf-8")


def _put_in_place(notebook: dict[str, Any], kept: Path) -> None:
    number = 0
    for cell in notebook["cells"]:
        cell["source"] = "".join(cell["source"])
        if cell["cell_type"] == "markdown":
            cell["source"] = _with_links(cell["source"])
            continue
        if cell["metadata"].get("jupyter", {}).get("source_hidden"):
            cell["metadata"].setdefault("tags", []).append("hide-input")
        cell["outputs"] = [output for output in cell["outputs"] if not _text(output).startswith("FloatProgress(")]
        for output in cell["outputs"]:
            if WIDGET.match(_text(output)):
                number += 1
                figure = (kept / f"{number}.html").read_text(encoding="utf-8")
                output["data"] = {"text/html": figure}
                output["metadata"] = {}


def _with_links(text: str) -> str:
    """Make links point to the book's pages, and links to terms point to their glossary entries."""
    text = TERM.sub(lambda link: f"{{term}}`{link[1]} <{TERMS[link[2]]}>`", text)
    return CONTROLLERS.sub("](../controllers.md)", text.replace("](../book/", "](../"))


def _text(output: dict[str, Any]) -> str:
    return "".join(output.get("data", {}).get("text/plain", ""))
