"""Run notebooks from the top and save their outputs: ``make notebooks``, after a change to one of them.

Only outputs are saved, so that git shows only real changes. A widget is saved as text and a picture, because no kernel
brings it to life when the notebook is opened again. Its figure is saved for the book.
"""

import asyncio
import os
import sys
from pathlib import Path

import nbformat
from jupyter_client.manager import AsyncKernelManager
from nbclient import NotebookClient
from notebook_domains import own_surroundings
from notebook_pictures import keep_pictures, store_pictures

WIDGET = "application/vnd.jupyter.widget-view+json"
HOME = Path(__file__).parents[2]
FOLDER = HOME / "notebooks"
STARTUP = """
import sys
from pathlib import Path
sys.path.append({book!r})
from keepsakes import FOLDER, keep
keep(FOLDER / {name!r})
del sys, Path, FOLDER, keep
"""


def execute(path: Path) -> None:
    """Run one notebook in a separate ROS domain, and save it."""
    notebook = nbformat.read(path, as_version=4)
    manager = AsyncKernelManager(kernel_name="python3")
    manager.kernel_spec.argv[0] = sys.executable
    with own_surroundings():
        startup = Path(os.environ["IPYTHONDIR"]) / "profile_default" / "startup" / "keep.py"
        startup.parent.mkdir(parents=True)
        startup.write_text(STARTUP.format(book=str(HOME / "book"), name=path.stem), encoding="utf-8")
        NotebookClient(
            notebook,
            km=manager,
            timeout=120,
            record_timing=False,
            store_widget_state=False,
            resources={"metadata": {"path": str(path.parent)}},
            on_cell_executed=lambda cell, **_: print(f"{path.name}: [{cell.execution_count}]", end="\r"),
        ).execute()
    for output in (output for cell in notebook.cells for output in cell.get("outputs", ())):
        output.get("data", {}).pop(WIDGET, None)
        if "text" in output:
            output["text"] = output["text"].replace(sys.prefix, "/path/to/.venv")  # of this machine
    notebook.metadata.language_info = {"name": "python"}
    keep_pictures(nbformat.read(path, as_version=4), notebook)
    nbformat.write(notebook, path)
    print(f"{path.name}: saved" + " " * 10)


if __name__ == "__main__":
    given = [Path(each).resolve() for each in sys.argv[1:] or sorted(FOLDER.glob("*.ipynb"))]
    for each in given:
        execute(each)
    asyncio.run(store_pictures(given))
