"""The command that opens JupyterLab on the notebooks."""

from __future__ import annotations

import json
import logging
import os
import re
import shutil
import socket
import sys
from base64 import b64encode
from contextlib import closing, contextmanager
from http.client import HTTPConnection
from http.cookiejar import CookieJar
from urllib.parse import urlsplit
from urllib.request import HTTPCookieProcessor, Request, build_opener

import nbformat
import pytest
from nbformat.sign import NotebookNotary
from programs import PATIENCE, answer, until
from tornado.websocket import WebSocketClosedError

from tutorial.commands import lab
from tutorial.commands.lab import NOTEBOOKS, lab_command, own_course, trust
from tutorial.errors import TutorialError
from tutorial.paths import HOME

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
    try:
        return notary.check_signature(nbformat.read(path, as_version=4))
    finally:
        notary.store.close()


@pytest.fixture
def open_lab(program, own_folders):
    """Start ``tank lab`` where there is no browser, with more of JupyterLab's arguments, until it has said its say."""

    def start(*arguments, environment=None):
        nowhere = dict.fromkeys(("BROWSER", "DISPLAY", "WAYLAND_DISPLAY", "WSL_DISTRO_NAME", "VSCODE_IPC_HOOK_CLI"), "")
        nowhere |= dict.fromkeys(("JUPYTER_TOKEN", "JUPYTER_TOKEN_FILE", *CODESPACE), "")
        arguments = ("--ServerApp.port=0", *arguments)
        running = program("lab", "--", *arguments, environment={**nowhere, **own_folders, **(environment or {})})
        running.says("Ctrl-C ends it.\n")
        return running

    return start


def address_of(running):
    """The address that it has said."""
    return ADDRESS.search(running.output)[0]


def part_of(address, path):
    """Another address of the same server, with the token."""
    return f"{address.partition('/lab/')[0]}{path}?{urlsplit(address).query}"


def test_where_there_is_no_browser_it_says_in_one_line_what_to_open(open_lab):
    """As root, too, which the tests are in a container."""
    running = open_lab()
    said, how_to_end, *more = running.output.splitlines()
    assert re.fullmatch("Open this in a browser: " + ADDRESS.pattern, said)
    assert how_to_end == "Ctrl-C ends it."
    assert more == []
    with answer(address_of(running)) as page:
        assert page.url == address_of(running)  # and not the page that asks for the token


def test_ctrl_c_ends_it_and_its_kernels_without_a_word(open_lab):
    running = open_lab("--LanguageServerManager.autodetect=False")  # it asks npm where they might be
    said = list(running.lines)
    run_kernel(address_of(running))
    assert len(running.family()) == 2
    running.asks_to_stop()
    assert running.ends() == 0
    assert [line for line in running.lines if not line.startswith("[IPKernelApp]")] == said
    running.leaves_nothing()


def test_a_page_that_was_closed_is_no_news(caplog):
    from tutorial.commands import lab_server  # and with it JupyterLab, for a second: not while tests are collected

    log = logging.getLogger("asyncio")
    log.addFilter(lab_server._is_news)
    try:
        for error in (WebSocketClosedError(), ValueError()):
            log.error("Task exception was never retrieved", exc_info=error)
    finally:
        log.removeFilter(lab_server._is_news)
    assert [record.exc_info[0] for record in caplog.records] == [ValueError]


def run_kernel(address):
    """Start a kernel, as a notebook does, and wait until it is ready."""
    kernels = part_of(address, "/api/kernels")
    with answer(Request(kernels, data=b"{}", method="POST")) as reply:
        channels = f"/api/kernels/{json.load(reply)['id']}/channels"

    def is_ready():
        with answer(kernels) as reply:
            return json.load(reply)[0]["execution_state"] == "idle"

    with websocket(part_of(address, channels)) as status:
        assert status == 101
        until(is_ready, "the kernel")


@contextmanager
def websocket(address, **headers):
    """Ask a server to go on as a websocket; yield the status that it answers with."""
    url = urlsplit(address)
    asking = {"Connection": "Upgrade", "Upgrade": "websocket", "Sec-WebSocket-Version": "13"}
    connection = HTTPConnection(url.netloc, timeout=PATIENCE)
    with closing(connection):
        key = b64encode(bytes(16)).decode()
        connection.request("GET", f"{url.path}?{url.query}", headers={**asking, "Sec-WebSocket-Key": key, **headers})
        yield connection.getresponse().status


def test_it_trusts_the_notebooks(open_lab, own_folders):
    running = open_lab()
    for path in NOTEBOOKS.glob("*.ipynb"):
        assert is_trusted(path, own_folders["JUPYTER_DATA_DIR"]), path
    running.process.terminate()
    assert running.ends() == 0
    running.leaves_nothing()


@pytest.fixture
def browser(tmp_path):
    """A browser that writes down what it is asked to open."""
    script, opened = tmp_path / "browser", tmp_path / "opened"
    script.write_text(f'#!/bin/sh\necho "$1" > "{opened}.part" && mv "{opened}.part" "{opened}"\n')
    script.chmod(0o755)
    return script, opened


def test_where_there_is_a_browser_it_opens(open_lab, browser):
    script, opened = browser
    running = open_lab(environment={"BROWSER": str(script)})
    assert running.output == f"It opens in the browser, at {address_of(running)}\nCtrl-C ends it.\n"
    until(opened.exists, "the browser to be opened")
    with build_opener().open(opened.read_text().strip()) as page:  # a file that hides the token from other users
        assert address_of(running) in page.read().decode()


@pytest.mark.parametrize("sign", ["WSL_DISTRO_NAME", "VSCODE_IPC_HOOK_CLI"])
def test_a_browser_that_cannot_read_this_machines_files_gets_the_address(open_lab, browser, sign):
    script, opened = browser
    running = open_lab(environment={"BROWSER": str(script), sign: "yes"})
    until(opened.exists, "the browser to be opened")
    assert opened.read_text().strip() == address_of(running)


def test_a_browser_in_the_terminal_is_none(open_lab, browser):
    script, opened = browser
    lynx = script.rename(script.with_name("lynx"))
    path = os.pathsep.join((str(lynx.parent), os.environ["PATH"]))
    running = open_lab(environment={"BROWSER": "lynx", "PATH": path})
    assert running.output.startswith("Open this in a browser: ")
    assert not opened.exists()


def test_the_users_own_arguments_are_heard(open_lab):
    running = open_lab("--no-browser", "--log-level=INFO", "--IdentityProvider.token=mine", "--ServerApp.prot=1")
    assert "Jupyter Server" in running.output
    assert "Did you mean `port`?" in running.output
    assert "/lab/tree/notebooks/0_setup.ipynb?token=..." in running.output  # he knows it, and others may look on


def test_a_port_in_use_leads_to_another(program, own_folders):
    with socket.create_server(("127.0.0.1", 0)) as taken:
        port = taken.getsockname()[1]
        options = ("--no-browser", f"--port={port}")
        running = program("lab", "--", *options, environment=own_folders)
        running.says("Ctrl-C ends it.\n")
        assert len(running.lines) == 2
        assert ADDRESS.search(running.output)[1] != str(port)
        running = program("lab", "--", *options, "--port-retries=0", environment=own_folders)
        assert running.ends() == 1
        assert f"port {port} is not available" in running.output


@pytest.mark.skipif(os.geteuid() != 0 or sys.platform != "linux", reason="is about root, and an address that Linux has")
def test_root_has_to_ask_for_another_address(program, own_folders):
    options = ("--no-browser", "--port=0", "--ip=127.0.0.2")
    running = program("lab", "--", *options, environment=own_folders)
    assert running.ends() == 1
    assert "Use --allow-root" in running.output


def test_in_a_codespace_the_forwarded_page_reaches_its_server_and_no_other_does(open_lab):
    running = open_lab(environment=CODESPACE)
    cookies = CookieJar()  # by which a page goes on that was opened with the token
    build_opener(HTTPCookieProcessor(cookies)).open(address_of(running)).close()
    sent = "; ".join(f"{cookie.name}={cookie.value}" for cookie in cookies)
    events = address_of(running).partition("/lab/")[0] + "/api/events/subscribe"
    answered = {}
    for origin in (FORWARDED, "https://another-tank-8888.app.github.dev", f"{FORWARDED}.example"):
        with websocket(events, Cookie=sent, Origin=origin) as status:
            answered[origin] = status
    assert list(answered.values()) == [101, 403, 403]


def first_line(port, text):
    """Send something, and return the first line of the answer; empty if there is none."""
    with socket.create_connection(("127.0.0.1", port), timeout=PATIENCE) as connection:
        connection.sendall(text.encode())
        return connection.makefile().readline().strip()


def test_what_a_stranger_sends_is_not_read(open_lab):
    address = address_of(open_lab())
    url = urlsplit(address)
    head = f"PUT /api/contents/x.txt HTTP/1.1\r\nHost: {url.netloc}\r\n"
    refused = "HTTP/1.1 403 Forbidden"
    for length in ("Content-Length: 89000000", "Transfer-Encoding: chunked"):
        assert first_line(url.port, f"{head}{length}\r\n\r\n") == refused
        assert first_line(url.port, f"{head}{length}\r\nAuthorization: token wrong\r\n\r\n") == refused
    cookies = CookieJar()
    build_opener(HTTPCookieProcessor(cookies)).open(address).close()
    held = {cookie.name: cookie.value for cookie in cookies}
    by_cookie = f"Cookie: {'; '.join(f'{name}={held[name]}' for name in held)}\r\nX-XSRFToken: {held['_xsrf']}"
    body = "x" * 100_000  # which is read, and found to be no JSON
    for known in (f"Authorization: token {url.query.partition('=')[2]}", by_cookie):
        sent = f"{head}{known}\r\nContent-Length: {len(body)}\r\n\r\n{body}"
        assert first_line(url.port, sent) == "HTTP/1.1 400 Bad Request"
    small = f"POST /login HTTP/1.1\r\nHost: {url.netloc}\r\nContent-Length: 3\r\n\r\nx=y"
    assert first_line(url.port, small) == refused  # by Jupyter, as it has no _xsrf


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
