"""The command that opens JupyterLab on the notebooks."""

from __future__ import annotations

import logging
import shutil

import nbformat
import pytest
from nbformat.sign import NotebookNotary

from tutorial.commands import lab
from tutorial.commands.lab import NOTEBOOKS, lab_command, own_course, trust
from tutorial.errors import TutorialError
from tutorial.paths import HOME

FOLDERS = ("JUPYTER_CONFIG_DIR", "JUPYTER_DATA_DIR", "JUPYTER_RUNTIME_DIR", "JUPYTERLAB_WORKSPACES_DIR")


@pytest.fixture
def own_folders(tmp_path):
    """Jupyter's folders, so that the user's are left alone."""
    return {name: str(tmp_path / name) for name in FOLDERS}


@pytest.fixture
def shipped(tmp_path, monkeypatch):
    """The course folder of an installed package; the current directory is one with nothing in it."""
    folder = tmp_path / "package"
    for name in ("book/glossary.md", "launch_py/step1.launch.py", "notebooks/0_setup.ipynb", "project/step1.yaml"):
        path = folder / name
        path.parent.mkdir(parents=True)
        path.write_text(name)
        path.chmod(0o444)
    monkeypatch.setattr(lab, "SHIPPED", folder)
    monkeypatch.setattr(lab, "HOME", folder)
    (tmp_path / "here").mkdir()
    monkeypatch.chdir(tmp_path / "here")
    return folder


def files_in(folder):
    return {path.relative_to(folder).as_posix(): path.read_text() for path in folder.rglob("*") if path.is_file()}


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


def test_in_a_checkout_the_checkout_is_opened():
    before = set(HOME.iterdir())
    assert own_course() == HOME
    assert set(HOME.iterdir()) == before
    assert f"--ServerApp.root_dir={HOME}" in lab_command()


def test_where_there_is_no_course_folder_one_is_made(shipped, tmp_path, caplog):
    caplog.set_level(logging.INFO)
    course = own_course()
    assert course == tmp_path / "here" / "tank-tutorial"
    copied = files_in(course)
    controllers = {name: text for name, text in copied.items() if name.startswith("tutorial/controllers/")}
    assert "class TankController" in controllers["tutorial/controllers/tank_controller.py"]
    assert files_in(shipped) == {name: text for name, text in copied.items() if name not in controllers}
    assert caplog.messages == [f"the course is now in {course}; all that you change there stays"]
    assert f"--ServerApp.root_dir={course}" in lab_command((), course)


def test_what_pip_has_compiled_is_not_copied(shipped):
    compiled = shipped / "launch_py" / "__pycache__" / "step1.launch.cpython-311.pyc"
    compiled.parent.mkdir()
    compiled.write_bytes(b"")
    assert [path.name for path in (own_course() / "launch_py").iterdir()] == ["step1.launch.py"]


def test_what_is_copied_can_be_changed_though_the_package_is_read_only(shipped):
    for name in files_in(shipped):
        assert (own_course() / name).stat().st_mode & 0o200, name


def test_what_a_learner_has_changed_stays_and_what_is_missing_is_added(shipped, caplog):
    course = own_course()
    (course / "notebooks" / "0_setup.ipynb").write_text("my answers")
    (course / "notebooks" / "mine.ipynb").write_text("my own")
    (shipped / "notebooks" / "4_imu_publisher.ipynb").write_text("a later version's")
    caplog.set_level(logging.INFO)
    assert own_course() == own_course() == course
    assert caplog.messages == [
        f"what was missing of the course, 1 of its files, is now in {course}; all that you change there stays"
    ]
    copied = files_in(course / "notebooks")
    assert copied == {
        "0_setup.ipynb": "my answers",
        "mine.ipynb": "my own",
        "4_imu_publisher.ipynb": "a later version's",
    }


def test_one_who_works_in_a_course_folder_goes_on_in_it(shipped, tmp_path, monkeypatch):
    course = own_course()
    monkeypatch.setattr(lab, "HOME", course)
    monkeypatch.chdir(course / "notebooks")
    (course / "project" / "step1.yaml").unlink()
    assert own_course() == course
    assert (course / "project" / "step1.yaml").read_text() == "project/step1.yaml"
    assert not (course / "notebooks" / "tank-tutorial").exists()


def test_nothing_is_added_to_a_checkout(shipped, tmp_path, monkeypatch):
    """Of another version, perhaps, than the one that is installed."""
    monkeypatch.setattr(lab, "HOME", tmp_path / "checkout")
    package = tmp_path / "checkout" / "tutorial"
    package.mkdir(parents=True)
    (package / "__init__.py").touch()
    assert own_course() == tmp_path / "checkout"
    assert files_in(tmp_path / "checkout") == {"tutorial/__init__.py": ""}


def test_a_folder_that_cannot_be_written_to_is_said(shipped, tmp_path):
    (tmp_path / "here" / "tank-tutorial").write_text("a file in the way")
    with pytest.raises(TutorialError, match=r"cannot be copied to .*tank-tutorial: .*\. Go to a folder of your own"):
        own_course()


def test_a_strangers_course_is_not_opened(shipped, monkeypatch):
    own_course()
    monkeypatch.setattr(lab, "is_ours", lambda folder: False)
    with pytest.raises(TutorialError, match=r"tank-tutorial belongs to another user\. Go to a folder of your own"):
        own_course()


def test_a_deleted_directory_is_said(shipped, tmp_path):
    (tmp_path / "here").rmdir()
    with pytest.raises(TutorialError, match="the current directory has been deleted"):
        own_course()


def test_no_python_file_that_lies_about_is_run():
    assert lab_command()[1] == "-P"
