"""What a process in the sandbox can and cannot reach."""

import json
import os
import shutil
import socket
import subprocess
import sys

import pytest
from programs import need_sandbox_here

from tutorial.commands.checking import sandbox
from tutorial.commands.checking.sandbox import FOLDER_SIZE, LIMITS, PROCESSES, need_sandbox
from tutorial.errors import TutorialError

PRELUDE = """
import ctypes, json, os, resource, signal, socket, subprocess, sys
from pathlib import Path
from tutorial.commands.checking.sandbox import limit

limit(60, True)
mine, folder = Path(sys.argv[1]), Path.cwd()

def outcome(attempt):
    try:
        return repr(attempt())
    except OSError as error:
        return type(error).__name__

def say(**attempts):
    print(json.dumps({name: outcome(attempt) for name, attempt in attempts.items()}))
"""
REACHES = """
import mujoco

def send(kind, family=socket.AF_INET):
    return socket.socket(family, kind)

def output(code):
    return subprocess.run([sys.executable, "-c", code], capture_output=True, text=True).stdout.split()

model = mujoco.MjModel.from_xml_string("<mujoco/>")
secret, port, parent = mine / "secret.txt", *map(int, sys.argv[2:])
say(
    child=lambda: output("import tutorial; from rclpy.node import Node; print(1)"),
    write=lambda: secret.write_text("hacked"),
    package=lambda: Path(mujoco.__file__).touch(),
    own=lambda: (folder / "x").write_text("1234"),
    read=secret.read_text,
    tcp=lambda: socket.create_connection(("127.0.0.1", port), 5).close(),
    bus=lambda: send(socket.SOCK_STREAM, socket.AF_UNIX).connect(str(mine / "bus")),
    datagram=lambda: send(socket.SOCK_DGRAM).sendto(b"x", ("192.0.2.1", 9)),
    loopback=lambda: send(socket.SOCK_DGRAM).sendto(b"x", ("127.0.0.1", 9)),
    kill=lambda: os.kill(parent, 0),
    look=lambda: Path(f"/proc/{parent}/environ").read_bytes(),
    mount=lambda: output("import ctypes; print(ctypes.CDLL(None).mount(b'x', b'/etc', b'tmpfs', 0, None))"),
    first_to_go=lambda: Path("/proc/self/oom_score_adj").read_text(),
    not_last=lambda: Path("/proc/self/oom_score_adj").write_text("0"),
    mode=lambda: os.fchmod(1, 0o600),
    hidden=lambda: os.memfd_create("x"),
    first=os.getpid,
    capable=lambda: output("import re; print(re.search('CapEff:.*', open('/proc/self/status').read())[0])"),
)
"""
ENDS = f"""
def fill():
    for i in range({FOLDER_SIZE // LIMITS[sandbox.resource.RLIMIT_FSIZE] + 1}):
        (folder / str(i)).write_bytes(bytes({LIMITS[sandbox.resource.RLIMIT_FSIZE]}))

def allocate():
    try:
        bytearray({LIMITS[sandbox.resource.RLIMIT_AS]})
    except MemoryError:
        return "refused"

def multiply():
    children = []
    try:
        for _ in range({2 * PROCESSES} if os.getuid() else 0):
            if (child := os.fork()) == 0:
                signal.pause()
            children.append(child)
    finally:
        for child in children:
            os.kill(child, signal.SIGKILL)
            os.waitpid(child, 0)

say(
    large=lambda: (folder / "large").write_bytes(bytes({LIMITS[sandbox.resource.RLIMIT_FSIZE]} + 1)),
    many=fill,
    memory=allocate,
    processes=multiply,
)
"""


@pytest.fixture
def inside(tmp_path):
    """Run code in the sandbox, beside a folder of the user's; return the results of its attempts by name."""
    need_sandbox_here()
    folder, mine = tmp_path / "folder", tmp_path / "mine"
    folder.mkdir()
    mine.mkdir()
    (mine / "secret.txt").write_text("the solutions")

    def run(code: str, *arguments: int) -> dict[str, str]:
        words = [*sandbox.sandbox(str(folder)), sys.executable, "-c", PRELUDE + code, str(mine), *map(str, arguments)]
        done = subprocess.run(words, capture_output=True, text=True, timeout=60, check=False)
        assert done.stdout, done.stderr
        return json.loads(done.stdout)

    return run


@pytest.mark.process
def test_the_sandbox_hides_the_users_things_and_has_what_answers_need(inside, tmp_path):
    """Python, MuJoCo, ROS 2 and a child process work in it, and none of them can get out."""
    with socket.create_server(("127.0.0.1", 0)) as server, socket.socket(socket.AF_UNIX) as service:
        service.bind(str(tmp_path / "mine" / "bus"))
        service.listen()
        found = inside(REACHES, server.getsockname()[1], os.getpid())
    assert (found["own"], found["loopback"], found["child"]) == ("4", "1", "['1']")  # DDS needs the loopback interface
    for name in ("write", "read", "bus", "look"):
        assert found[name] == "FileNotFoundError", name
    assert (tmp_path / "mine" / "secret.txt").read_text() == "the solutions"
    assert found["package"] == found["not_last"] == "OSError"  # read-only
    assert found["tcp"] == "ConnectionRefusedError"
    assert (found["datagram"], found["kill"]) == ("OSError", "ProcessLookupError")
    assert found["mount"] == "['-1']"
    assert found["first_to_go"] == repr("1000\n")  # if memory runs out, the kernel kills these processes first
    assert found["capable"] == "['CapEff:', '0000000000000000']"
    assert found["mode"] == found["hidden"] == "PermissionError"
    assert found["first"] == "1"  # no process in the sandbox is without limits


@pytest.mark.process
def test_files_memory_and_processes_are_limited(inside):
    found = inside(ENDS)
    assert (found["large"], found["many"], found["memory"]) == ("OSError", "OSError", "'refused'")
    assert found["processes"] == ("BlockingIOError" if os.getuid() else "None")  # limits do not apply to root


@pytest.mark.process
@pytest.mark.skipif(shutil.which("keyctl") is None, reason="there is no keyctl: apt-get install keyutils")
def test_keys_of_the_session_are_refused(inside):
    show = "subprocess.run(['keyctl', 'show', '@u'], capture_output=True, text=True).stderr"
    found = inside(f"say(keys=lambda: {show})")
    assert "Operation not permitted" in found["keys"]


def test_the_current_folder_is_hidden_even_if_python_imports_from_it(monkeypatch, tmp_path):
    monkeypatch.chdir(tmp_path)
    monkeypatch.syspath_prepend(tmp_path)
    monkeypatch.setenv("PYTHONPATH", ".")
    assert str(tmp_path) not in sandbox.sandbox("/tmp")


@pytest.mark.process
def test_a_missing_sandbox_is_reported_with_the_fix(monkeypatch, tmp_path):
    monkeypatch.setattr(shutil, "which", lambda _: None)
    with pytest.raises(TutorialError, match=r"bwrap is not found\. On Debian and Ubuntu, sudo apt-get .*--no-sandbox"):
        need_sandbox()
    monkeypatch.undo()
    monkeypatch.setattr(sandbox, "find_library", lambda _: None)
    with pytest.raises(TutorialError, match=r"libseccomp\.so\.2 is not found\. On Debian"):
        need_sandbox()
    monkeypatch.undo()
    (tmp_path / "bwrap").write_text("#!/bin/sh\necho No permissions to create a new namespace >&2\nexit 1\n")
    (tmp_path / "bwrap").chmod(0o755)
    monkeypatch.setenv("PATH", f"{tmp_path}:{os.environ['PATH']}")
    with pytest.raises(TutorialError, match=r"No permissions to create a new namespace\. On Debian"):
        need_sandbox()
