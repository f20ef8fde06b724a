"""The command that opens JupyterLab on the notebooks."""

from __future__ import annotations

import shutil

import nbformat
import pytest
from nbformat.sign import NotebookNotary

from tutorial.lab import NOTEBOOKS, trust

FOLDERS = ("JUPYTER_CONFIG_DIR", "JUPYTER_DATA_DIR", "JUPYTER_RUNTIME_DIR", "JUPYTERLAB_WORKSPACES_DIR")


@pytest.fixture
def own_folders(tmp_path):
    """Jupyter's folders, so that the user's are left alone."""
    return {name: str(tmp_path / name) for name in FOLDERS}


def is_trusted(path, folder):
    notary = NotebookNotary(data_dir=str(folder))
    try:
        return notary.check_signature(nbformat.read(path, as_version=4))
    finally:
        notary.store.close()


def test_it_opens_on_the_first_notebook_and_trusts_them_all(program, own_folders):
    running = program("lab", "--", "--no-browser", "--ServerApp.port=0", "--allow-root", environment=own_folders)
    running.says("http://127.0.0.1:")
    running.says("/lab/tree/notebooks/0_setup.ipynb?token=")
    for path in NOTEBOOKS.glob("*.ipynb"):
        assert is_trusted(path, own_folders["JUPYTER_DATA_DIR"]), path
    running.process.terminate()
    running.ends()
    running.leaves_nothing()


def test_only_what_is_there_now_is_trusted(tmp_path):
    mine = tmp_path / "notebooks"
    mine.mkdir()
    (mine / "5_broken.ipynb").write_text("<<<<<<< mine")
    somebody_elses = shutil.copy(NOTEBOOKS / "2_joint_state_publisher.ipynb", mine / "found.ipynb")
    first = shutil.copy(NOTEBOOKS / "0_setup.ipynb", mine)
    second = shutil.copy(NOTEBOOKS / "1_tank_controller.ipynb", tmp_path)
    trust(mine, data_dir=str(tmp_path))
    assert is_trusted(first, tmp_path)
    assert not is_trusted(somebody_elses, tmp_path)
    assert not is_trusted(second, tmp_path)
