"""The command that opens JupyterLab on the notebooks."""

from __future__ import annotations

import json
import logging
import re
import shutil
import socket
from contextlib import closing, contextmanager
from functools import partial
from http.cookiejar import CookieJar
from urllib.parse import urlsplit
from urllib.request import HTTPCookieProcessor, Request, build_opener

import nbformat
import pytest
from nbformat.sign import NotebookNotary
from programs import PATIENCE, Program, answer, until
from websocket import WebSocketBadStatusException, create_connection

from tutorial.commands import lab
from tutorial.commands.lab import lab_command, own_course, trust
from tutorial.errors import TutorialError
from tutorial.paths import HOME

NOTEBOOKS = HOME / "notebooks"
JUPYTERS_FOLDERS = ("JUPYTER_CONFIG_DIR", "JUPYTER_DATA_DIR", "JUPYTER_RUNTIME_DIR", "JUPYTERLAB_WORKSPACES_DIR")
ADDRESS = re.compile(r"http://127\.0\.0\.1:(\d+)/lab/tree/notebooks/0_setup\.ipynb\?token=(\w+)")
CODESPACE = {"CODESPACE_NAME": "animated-tank", "GITHUB_CODESPACES_PORT_FORWARDING_DOMAIN": "app.github.dev"}
FORWARDED = "https://animated-tank-8888.app.github.dev"


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
    with closing(notary.store):
        return notary.check_signature(nbformat.read(path, as_version=4))


NOWHERE = dict.fromkeys(("BROWSER", "DISPLAY", "WAYLAND_DISPLAY", "WSL_DISTRO_NAME", "VSCODE_IPC_HOOK_CLI"), "")
NOWHERE |= dict.fromkeys(("JUPYTER_TOKEN", "JUPYTER_TOKEN_FILE", *CODESPACE), "")


@contextmanager
def opened(folder, *arguments, **environment):
    """``tank lab`` where there is no browser, with more of JupyterLab's arguments, when it has said where to look."""
    folders = {name: str(folder / name) for name in JUPYTERS_FOLDERS}
    running = Program("lab", "--", "--ServerApp.port=0", *arguments, environment={**NOWHERE, **folders, **environment})
    try:
        running.says("?token=")
        until(lambda: running.output.endswith("\n"))
        yield running
    finally:
        running.clear()
        print(running.output)


@pytest.fixture(scope="module")
def server(tmp_path_factory):
    """One in a codespace, where its page is forwarded, and its folder."""
    folder = tmp_path_factory.mktemp("jupyter")
    with opened(folder, **CODESPACE) as running:
        yield running, folder


def address_of(running):
    """The address that it has said."""
    return ADDRESS.search(running.output)[0]


def cookies_of(address):
    """Those by which a page goes on that was opened with the token."""
    cookies = CookieJar()
    build_opener(HTTPCookieProcessor(cookies)).open(address).close()
    return {cookie.name: cookie.value for cookie in cookies}


def as_header(cookies):
    return "; ".join(f"{name}={value}" for name, value in cookies.items())


@pytest.mark.process
def test_where_there_is_no_browser_it_says_what_to_open_and_trusts_the_notebooks(server):
    """As root, too, which the tests are in a container."""
    running, folder = server
    with answer(address_of(running)) as page:
        assert page.url == address_of(running)  # and not the page that asks for the token
    for path in NOTEBOOKS.glob("*.ipynb"):
        assert is_trusted(path, folder / "JUPYTER_DATA_DIR"), path


@pytest.mark.process
def test_in_a_codespace_the_forwarded_page_reaches_its_server_and_no_other_does(server):
    address = address_of(server[0])
    events, cookies = address.partition("/lab/")[0] + "/api/events/subscribe", as_header(cookies_of(address))
    connect = partial(create_connection, events.replace("http", "ws"), PATIENCE, cookie=cookies)
    connect(origin=FORWARDED).close()
    for origin in ("https://another-tank-8888.app.github.dev", f"{FORWARDED}.example"):
        with pytest.raises(WebSocketBadStatusException, match="403 Forbidden"):
            connect(origin=origin)


@pytest.mark.process
def test_what_is_larger_than_any_notebook_is_not_read(server):
    url = urlsplit(address_of(server[0]))
    head = f"PUT /api/contents/x.txt HTTP/1.1\r\nHost: {url.netloc}\r\nContent-Length: 89000000\r\n\r\n"
    with socket.create_connection(("127.0.0.1", url.port), timeout=PATIENCE) as connection:
        connection.sendall(head.encode())
        assert connection.makefile().readline().strip() == "HTTP/1.1 400 Bad Request"


@pytest.mark.process
def test_ctrl_c_ends_it_and_its_kernels_without_a_word(tmp_path):
    with opened(tmp_path, "--LanguageServerManager.autodetect=False") as running:  # it asks npm where they might be
        said, (before, _, after) = list(running.lines), address_of(running).partition("/lab/")
        kernels = f"{before}/api/kernels?{after.partition('?')[2]}"
        with answer(Request(kernels, data=b"{}", method="POST")) as reply:
            channels = kernels.replace("?", f"/{json.load(reply)['id']}/channels?").replace("http", "ws")

        def is_ready():
            with answer(kernels) as reply:
                return json.load(reply)[0]["execution_state"] == "idle"

        with closing(create_connection(channels, PATIENCE)):
            until(is_ready, "the kernel")
        assert len(running.family()) == 2
        running.asks_to_stop()
        assert running.ends() == 0
        assert [line for line in running.lines if not line.startswith("[IPKernelApp]")] == said
        running.leaves_nothing()


def test_what_jupyterlab_is_told(tmp_path, monkeypatch):
    for name, value in NOWHERE.items():
        monkeypatch.setenv(name, value)
    told = lab_command(["--no-browser"], tmp_path)
    assert told[1] == "-P"  # no Python file that lies about is run
    assert told[-1] == "--no-browser"  # the last word is the user's
    assert {"--ServerApp.ip=127.0.0.1", f"--ServerApp.root_dir={tmp_path}", "--ServerApp.allow_origin_pat="} < {*told}
    assert "--ServerApp.use_redirect_file=True" in told
    monkeypatch.setenv("WSL_DISTRO_NAME", "Ubuntu")  # where the browser cannot open this machine's files
    monkeypatch.setenv("CODESPACE_NAME", "animated-tank")  # and no domain
    told = lab_command()
    assert {"--ServerApp.use_redirect_file=False", "--ServerApp.allow_origin_pat="} < {*told}


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


def test_where_there_is_no_course_folder_one_is_made_of_all_but_what_pip_has_compiled(shipped, tmp_path):
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
    assert all((course / name).stat().st_mode & 0o200 for name in copied)  # though the package is read-only


def test_what_a_learner_has_changed_stays_and_what_is_missing_is_added(shipped, caplog):
    course = own_course()
    (course / "notebooks" / "0_setup.ipynb").write_text("my answers")
    (course / "notebooks" / "mine.ipynb").write_text("my own")
    (shipped / "notebooks" / "4_imu_publisher.ipynb").write_text("a later version's")
    caplog.set_level(logging.INFO)
    assert own_course() == own_course() == course
    assert caplog.messages == [f"what was missing of the course is now in {course}; all that you change there stays"]
    names = ("0_setup.ipynb", "mine.ipynb", "4_imu_publisher.ipynb")
    assert files_in(course / "notebooks") == dict(zip(names, ("my answers", "my own", "a later version's")))


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


@pytest.mark.parametrize(
    ("spoil", "said"),
    [
        (lambda here: (here / "tank-tutorial").write_text(""), r"be copied to .*tank-tutorial: .*\. Go to a folder"),
        (lambda here: own_course(), r"tank-tutorial belongs to another user\. Go to a folder of your own"),
    ],
)
def test_a_folder_in_which_there_can_be_no_course_is_said(shipped, tmp_path, monkeypatch, spoil, said):
    spoil(tmp_path / "here")
    monkeypatch.setattr(lab, "is_ours", lambda folder: folder.is_file())
    with pytest.raises(TutorialError, match=said):
        own_course()


def test_a_setting_that_is_given_takes_the_place_of_ours_and_a_hub_says_where_its_students_servers_listen(monkeypatch):
    assert [word for word in lab_command(["--ServerApp.ip=0.0.0.0"]) if "ServerApp.ip" in word] == [
        "--ServerApp.ip=0.0.0.0"
    ]
    monkeypatch.delenv("JUPYTER_SERVER_URL", raising=False)
    monkeypatch.setenv("JUPYTERHUB_SERVICE_URL", "http://127.0.0.1:50000/user/ada/")
    told = lab_command()
    assert "jupyterhub.singleuser" in told
    assert not [word for word in told if "ServerApp.ip" in word]
    monkeypatch.setenv("JUPYTER_SERVER_URL", "http://127.0.0.1:50000/user/ada/")  # in a terminal of such a server
    assert "jupyterlab" in lab_command()
