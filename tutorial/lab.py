"""JupyterLab on the notebooks."""

from __future__ import annotations

import logging
import sys
from collections.abc import Sequence
from pathlib import Path

import nbformat
from nbformat.sign import NotebookNotary

from tutorial.paths import HOME

__all__ = ["NOTEBOOKS", "lab_command", "trust"]

_log = logging.getLogger(__name__)

NOTEBOOKS = HOME / "notebooks"


def lab_command(arguments: Sequence[str] = ()) -> list[str]:
    """Return the command that opens JupyterLab on the first notebook.

    Args:
        arguments: more of JupyterLab's own.
    """
    first = (NOTEBOOKS / "0_setup.ipynb").relative_to(HOME).as_posix()
    options = [f"--ServerApp.root_dir={HOME}", f"--LabApp.default_url=/lab/tree/{first}"]
    return [sys.executable, "-m", "jupyterlab", *options, *arguments]


def trust(folder: Path = NOTEBOOKS, **settings: str) -> None:
    """Sign the course's notebooks as the user's own, as ``jupyter trust`` does. One that cannot be read is left out.

    JupyterLab shows no widget of a notebook that it does not trust when its page is loaded anew, and one that somebody
    else has run is not trusted.

    Args:
        folder: whose notebooks.
        settings: of Jupyter's notary, for instance ``data_dir``.
    """
    notary = NotebookNotary(**settings)  # type: ignore[no-untyped-call]
    for path in sorted(folder.glob("[0-9]_*.ipynb")):
        try:
            notary.sign(nbformat.read(path, as_version=4))  # type: ignore[no-untyped-call]
        except Exception as error:  # noqa: BLE001 - whatever is wrong with it, JupyterLab will say
            _log.warning("%s is not trusted: %s", path.name, str(error).partition("\n")[0])
    notary.store.close()
