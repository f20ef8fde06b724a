"""`tank lab`, which opens JupyterLab on the notebooks."""

import json
import logging
import os
import re
import shutil
from contextlib import closing
from urllib.request import Request

import nbformat
import psutil
import pytest
from nbformat.sign import NotebookNotary
from programs import TIMEOUT, answer, until
from websocket import create_connection

from tutorial.commands import lab
from tutorial.commands.lab import lab_command, own_course, trust
from tutorial.errors import TutorialError
from tutorial.system.paths import HOME

NOTEBOOKS = HOME / "notebooks"
ADDRESS = re.compile(r"http://127\.0\.0\.1:(\d+)/lab/tree/notebooks/0_setup\.ipynb\?token=(\w+)")
CODESPACE = {"CODESPACE_NAME": "animated-tank", "GITHUB_CODESPACES_PORT_FORWARDING_DOMAIN": "app.github.dev"}


@pytest.fixture
def shipped(tmp_path, monkeypatch):
    """The course folder of an installed package; the current directory is an empty one."""
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
    with closing(notary.store):
        return notary.check_signature(nbformat.read(path, as_version=4))


NOWHERE = dict.fromkeys(("BROWSER", "DISPLAY", "WAYLAND_DISPLAY", "WSL_DISTRO_NAME", "VSCODE_IPC_HOOK_CLI"), "")
JUPYTERS = ("JUPYTER_CONFIG", "JUPYTER_DATA", "JUPYTER_RUNTIME", "JUPYTERLAB_WORKSPACES")  # hide the user's settings
NOWHERE |= dict.fromkeys(("JUPYTER_TOKEN", "JUPYTER_TOKEN_FILE", *CODESPACE), "")


@pytest.mark.process
def test_lab_prints_its_address_trusts_the_notebooks_and_ends_with_its_kernels(program, tmp_path):
    """Run without a browser, and possibly as root, as in a container. Ctrl-C stops it silently."""
    folders = {f"{name}_DIR": str(tmp_path / name) for name in JUPYTERS}
    quick = ("--ServerApp.port=0", "--LanguageServerManager.autodetect=False")  # without npm
    running = program("lab", "--", *quick, environment=NOWHERE | folders | {"PATH": os.defpath})
    running.says("?token=")
    until(lambda: ADDRESS.search(running.output), "the address")
    address = ADDRESS.search(running.output)[0]
    with answer(address) as page:
        assert page.url == address  # not redirected to the page that asks for the token
        assert b'"news": {"disabled": true}' in page.read()  # JupyterLab does not ask about news
    assert shutil.which("tank", path=psutil.Process(running.process.pid).environ()["PATH"])  # in its terminals
    for path in NOTEBOOKS.glob("*.ipynb"):
        assert is_trusted(path, folders["JUPYTER_DATA_DIR"]), path
    kernels = address.replace("/lab/tree/notebooks/0_setup.ipynb", "/api/kernels")
    with answer(Request(kernels, data=b"{}", method="POST")) as reply:
        channels = kernels.replace("?", f"/{json.load(reply)['id']}/channels?").replace("http", "ws")

    def is_ready():
        with answer(kernels) as reply:
            return json.load(reply)[0]["execution_state"] == "idle"

    with closing(create_connection(channels, TIMEOUT)):
        until(is_ready, "the kernel")
    assert len(running.family()) == 2
    said = len(running.lines)
    running.asks_to_stop()
    assert running.ends() == 0
    assert [line for line in running.lines[said:] if not line.startswith("[IPKernelApp]")] == []
    assert "without encryption" not in running.output  # each kernel would warn about it
    running.leaves_nothing()


def test_jupyterlabs_arguments(tmp_path, monkeypatch):
    for name, value in NOWHERE.items():
        monkeypatch.setenv(name, value)
    told = lab_command(["--no-browser"], tmp_path)
    assert told[1] == "-P"  # run no Python file from the current directory
    assert told[-1] == "--no-browser"  # the user's arguments come last
    assert {"--ServerApp.ip=127.0.0.1", f"--ServerApp.root_dir={tmp_path}", "--ServerApp.allow_origin_pat="} < {*told}
    assert {"--ServerApp.use_redirect_file=True", "--ServerApp.max_body_size=64000000"} < {*told}
    assert {"--LabApp.news_url=None", "--KernelManager.transport_encryption=auto"} < {*told}
    monkeypatch.setenv("WSL_DISTRO_NAME", "Ubuntu")  # where the browser cannot open this machine's files
    assert "--ServerApp.use_redirect_file=False" in lab_command()


def test_in_a_codespace_only_the_forwarded_page_reaches_the_server(monkeypatch):
    pages = (
        "animated-tank-8888.app.github.dev",
        "another-tank-8888.app.github.dev",
        "animated-tank-1.app.github.dev.me",
    )

    def reaching():
        (pattern,) = (word.partition("=")[2] for word in lab_command() if "allow_origin_pat" in word)
        return [page for page in pages if re.fullmatch(pattern, f"https://{page}")]

    for name, value in CODESPACE.items():
        monkeypatch.setenv(name, value)
    assert reaching() == [pages[0]]
    monkeypatch.setenv("CODESPACE_NAME", "")
    assert reaching() == []


def test_only_existing_notebooks_are_trusted(tmp_path):
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


def test_the_course_is_copied_without_compiled_files(shipped, tmp_path):
    compiled = shipped / "launch_py" / "__pycache__" / "step1.launch.cpython-311.pyc"
    compiled.parent.mkdir()
    compiled.write_bytes(b"")
    course = own_course()
    assert course == tmp_path / "here" / "tank-tutorial"
    copied = files_in(course)
    controllers = {name: text for name, text in copied.items() if name.startswith("tutorial/controllers/")}
    assert "class TankController" in controllers["tutorial/controllers/tank_controller.py"]
    compiled.unlink()
    assert files_in(shipped) == {name: text for name, text in copied.items() if name not in controllers}
    assert all((course / name).stat().st_mode & 0o200 for name in copied)  # although the package is read-only


def test_changed_files_stay_and_missing_ones_are_added(shipped, caplog):
    course = own_course()
    (course / "notebooks" / "0_setup.ipynb").write_text("my answers")
    (course / "notebooks" / "mine.ipynb").write_text("my own")
    (shipped / "notebooks" / "4_imu_publisher.ipynb").write_text("a later version's")
    caplog.set_level(logging.INFO)
    assert own_course() == own_course() == course
    assert caplog.messages == [f"added the missing course files to {course}; your changes there are kept"]
    names = ("0_setup.ipynb", "mine.ipynb", "4_imu_publisher.ipynb")
    assert files_in(course / "notebooks") == dict(zip(names, ("my answers", "my own", "a later version's")))


def test_lab_in_a_course_folder_uses_it(shipped, tmp_path, monkeypatch):
    course = own_course()
    monkeypatch.setattr(lab, "HOME", course)
    monkeypatch.chdir(course / "notebooks")
    (course / "project" / "step1.yaml").unlink()
    assert own_course() == course
    assert (course / "project" / "step1.yaml").read_text() == "project/step1.yaml"
    assert not (course / "notebooks" / "tank-tutorial").exists()


def test_a_checkout_stays_unchanged(shipped, tmp_path, monkeypatch):
    """It may have a different version than the installed package."""
    monkeypatch.setattr(lab, "HOME", tmp_path / "checkout")
    package = tmp_path / "checkout" / "tutorial"
    package.mkdir(parents=True)
    (package / "__init__.py").touch()
    assert own_course() == tmp_path / "checkout"
    assert files_in(tmp_path / "checkout") == {"tutorial/__init__.py": ""}


@pytest.mark.parametrize(
    ("spoil", "said"),
    [
        (lambda here: (here / "tank-tutorial").write_text(""), r"be copied to .*tank-tutorial: .*\. Change to a"),
        (lambda here: own_course(), r"tank-tutorial belongs to another user\. Change to a folder of your own"),
    ],
)
def test_an_unusable_folder_is_reported(shipped, tmp_path, monkeypatch, spoil, said):
    spoil(tmp_path / "here")
    monkeypatch.setattr(lab, "is_ours", lambda folder: folder.is_file())
    with pytest.raises(TutorialError, match=said):
        own_course()


def test_the_users_settings_and_the_hubs_address_win(monkeypatch):
    assert [word for word in lab_command(["--ServerApp.ip=0.0.0.0"]) if "ServerApp.ip" in word] == [
        "--ServerApp.ip=0.0.0.0"
    ]
    monkeypatch.delenv("JUPYTER_SERVER_URL", raising=False)
    monkeypatch.setenv("JUPYTERHUB_SERVICE_URL", "http://127.0.0.1:50000/user/ada/")
    told = lab_command()
    assert "jupyterhub.singleuser" in told
    assert not [word for word in told if "ServerApp.ip" in word]
    monkeypatch.setenv("JUPYTER_SERVER_URL", "http://127.0.0.1:50000/user/ada/")  # set in a terminal of a hub's server
    assert "jupyterlab" in lab_command()
