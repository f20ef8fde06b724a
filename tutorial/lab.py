"""JupyterLab on the notebooks."""

from __future__ import annotations

import sys
from collections.abc import Sequence
from pathlib import Path

import nbformat
from nbformat.sign import NotebookNotary

from tutorial.paths import HOME

__all__ = ["NOTEBOOKS", "lab_command", "trust"]

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
    """Sign notebooks as the user's own, as ``jupyter trust`` does.

    JupyterLab shows no widget of a notebook that it does not trust when its page is loaded anew, and one that somebody
    else has run is not trusted.

    Args:
        folder: whose notebooks.
        settings: of Jupyter's notary, for instance ``data_dir``.
    """
    notary = NotebookNotary(**settings)  # type: ignore[no-untyped-call]
    for path in sorted(folder.glob("*.ipynb")):
        notary.sign(nbformat.read(path, as_version=4))  # type: ignore[no-untyped-call]
    notary.store.close()
