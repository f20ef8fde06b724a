"""What a process behind walls can reach: with all of them, and where the system has no namespaces."""

from __future__ import annotations

import json
import os
import re
import socket
import subprocess
import sys

import pytest

from tutorial.commands.checking.namespaces import PROCESSES
from tutorial.commands.checking.walls import Walls

PRELUDE = """
import ctypes, json, os, signal, socket, sys
from pathlib import Path

import tutorial.commands.checking.walls as walls

folder, mine, how = Path(sys.argv[1]), Path(sys.argv[2]), sys.argv[3]
if how == "without namespaces":
    walls.may_enter_namespaces = lambda folder: False
stands = walls.raise_walls(folder, 60)

def outcome(attempt):
    try:
        return repr(attempt())
    except OSError as error:
        return type(error).__name__

def say(**attempts):
    found = {name: outcome(attempt) for name, attempt in attempts.items()}
    walls_found = [stands.namespaces, stands.landlock, stands.seccomp]
    print(json.dumps([walls_found, found]))
"""
REACHES = """
from tutorial.commands.checking.namespaces import _NEW, _SYS_MOUNT_SETATTR
from tutorial.commands.checking.system_calls import mount, syscall, unshare
import struct, subprocess
import mujoco

def send(kind, family=socket.AF_INET):
    return socket.socket(family, kind)

def output(code):
    return subprocess.run([sys.executable, "-c", code], capture_output=True, text=True).stdout.split()

model = mujoco.MjModel.from_xml_string("<mujoco/>")
secret, port, parent = mine / "secret.txt", *map(int, sys.argv[4:])
clear = ctypes.create_string_buffer(struct.pack("QQQQ", 0, 1, 0, 0))
say(
    child=lambda: output("import tutorial; from rclpy.node import Node; print(1)"),
    write=lambda: secret.write_text("hacked"),
    cut=lambda: os.truncate(secret, 0),
    delete=secret.unlink,
    move=lambda: secret.rename(mine / "other"),
    make=lambda: (mine / "new").touch(),
    close=lambda: mine.chmod(0),
    own=lambda: (folder / "x").write_text("1234"),
    read=secret.read_text,
    listing=lambda: os.listdir(mine),
    tcp=lambda: socket.create_connection(("127.0.0.1", port), 5).close(),
    far=lambda: socket.create_connection(("192.0.2.1", 80), 0.01).close(),
    bus=lambda: send(socket.SOCK_STREAM, socket.AF_UNIX).connect(str(mine / "bus")),
    datagram=lambda: send(socket.SOCK_DGRAM).sendto(b"x", ("192.0.2.1", 9)),
    loopback=lambda: send(socket.SOCK_DGRAM).sendto(b"x", ("127.0.0.1", 9)),
    kill=lambda: os.kill(parent, 0),
    look=lambda: Path(f"/proc/{parent}/environ").read_bytes(),
    writable=lambda: syscall(_SYS_MOUNT_SETATTR, -100, b"/", 0x8000, clear, ctypes.c_size_t(32)),
    mount=lambda: mount("tmpfs", str(folder), "tmpfs", 0),
    again=lambda: unshare(_NEW),
    capable=lambda: output("import re; print(re.search('CapEff:.*', open('/proc/self/status').read())[0])"),
)
"""
REFUSED = {"PermissionError", "OSError"}  # OSError: the file system is read-only


@pytest.fixture(params=["with namespaces", "without namespaces"])
def behind(request, tmp_path):
    """Run code behind walls; returns the walls, and by name what became of its attempts."""

    def run(code: str, *arguments: int) -> tuple[Walls, dict[str, str]]:
        folder = tmp_path / "folder"
        folder.mkdir()
        words = [sys.executable, "-c", PRELUDE + code, str(folder), str(tmp_path / "mine"), request.param]
        words += map(str, arguments)
        done = subprocess.run(words, capture_output=True, text=True, timeout=60, check=False)
        assert done.stdout, done.stderr
        stands, found = json.loads(done.stdout)
        walls = Walls(*stands)
        if request.param == "with namespaces" and not walls.namespaces:
            pytest.skip("this system lets nobody make namespaces")
        return walls, found

    if sys.platform != "linux":
        pytest.skip("these walls are Linux's")
    (tmp_path / "mine").mkdir()
    (tmp_path / "mine" / "secret.txt").write_text("the solutions")
    return run


@pytest.mark.process
def test_my_files_processes_and_the_network_are_out_of_reach_and_what_is_needed_is_there(behind, tmp_path, monkeypatch):
    """Python, MuJoCo and a child process work behind the walls, which cannot be taken down."""
    monkeypatch.setenv("PASSWORD", "open sesame")
    with socket.create_server(("127.0.0.1", 0)) as server, socket.socket(socket.AF_UNIX) as service:
        service.bind(str(tmp_path / "mine" / "bus"))
        service.listen()
        walls, found = behind(REACHES, server.getsockname()[1], os.getpid())
    assert (found["own"], found["loopback"], found["child"]) == ("4", "1", "['1']")  # DDS needs the loopback
    if walls.landlock:
        assert found["read"] == found["listing"] == "PermissionError"
    if walls.namespaces or (walls.landlock >= 3 and walls.seccomp):
        assert {found[name] for name in ("write", "cut", "delete", "move", "make", "close")} <= REFUSED
        assert [path.name for path in (tmp_path / "mine").iterdir() if path.name != "bus"] == ["secret.txt"]
        assert (tmp_path / "mine" / "secret.txt").read_text() == "the solutions"
        assert (tmp_path / "mine").stat().st_mode & 0o700 == 0o700
    if walls.namespaces:
        assert found["datagram"] == "OSError"  # there is no way to it
        assert found["tcp"] == ("PermissionError" if walls.landlock >= 4 else "ConnectionRefusedError")
        assert (found["kill"], found["look"]) == ("ProcessLookupError", "FileNotFoundError")
        assert found["again"] in REFUSED
        assert found["capable"] == "['CapEff:', '0000000000000000']"
        assert found["writable"] == found["mount"] == "PermissionError"
    elif walls.landlock:
        assert found["look"] == "PermissionError"
        assert found["kill"] == ("PermissionError" if walls.landlock >= 6 else "None")
    if walls.landlock >= 4:
        assert found["far"] == "PermissionError"
    if walls.seccomp:
        assert found["bus"] == "PermissionError"


@pytest.mark.process
def test_files_memory_and_processes_have_an_end(behind):
    walls, found = behind(f"""
def fill():
    for i in range(10):
        (folder / str(i)).write_bytes(bytes(walls.FILE_SIZE))

def allocate():
    try:
        bytearray(walls.MEMORY)
    except MemoryError:
        return "refused"

def multiply():
    children = []
    held = stands.namespaces and (os.getuid() or int(Path("/proc/sys/kernel/pid_max").read_text()) == {2 * PROCESSES})
    try:
        for _ in range({2 * PROCESSES} if held else 0):
            child = os.fork()
            if child == 0:
                signal.pause()
            children.append(child)
    finally:
        for child in children:
            os.kill(child, signal.SIGKILL)
            os.waitpid(child, 0)

say(
    large=lambda: (folder / "large").write_bytes(bytes(walls.FILE_SIZE + 1)),
    many=fill if stands.namespaces else lambda: None,
    memory=allocate,
    processes=multiply,
)
""")
    assert found["large"] == "OSError"
    assert found["memory"] == "'refused'"
    if walls.namespaces:
        assert found["many"] == "OSError"
        assert found["processes"] in {"BlockingIOError", *["None"] * (os.getuid() == 0)}  # root before Linux 6.14


@pytest.mark.parametrize(
    ("walls", "reached"),
    [
        (Walls(namespaces=True, landlock=7, seccomp=True), []),
        (Walls(landlock=6, seccomp=True), ["COULD SEND UDP"]),
        (Walls(landlock=4, seccomp=True), ["COULD SEND UDP", "COULD END", "MAY STILL RUN"]),
        (Walls(landlock=2, seccomp=True), ["COULD CHANGE", "COULD REACH", "COULD END", "MAY STILL RUN"]),
        (Walls(), ["COULD CHANGE", "COULD READ", "COULD REACH", "COULD END", "MAY STILL RUN"]),
    ],
)
def test_what_could_be_reached_is_said(walls, reached):
    """Landlock refuses to cut files off from version 3 on."""
    assert re.findall(r"(?:COULD|MAY STILL)(?: [A-Z]+)+", " ".join(walls.sentences())) == reached
