"""The commands ``tank ros``: the real ROS 2 of PyPI's wheels, in a folder beside this environment."""

# ruff: noqa: PLC0415 - help must be fast

import os
import signal
from collections.abc import Callable
from pathlib import Path

import click

from tutorial.commands.terminal import INTERRUPTED, status_line
from tutorial.errors import TutorialError
from tutorial.printing import say

ABOUT = """\
what      ROS 2 Jazzy: rclpy 7.1.5, rcl 9.2.7, Fast DDS 2.14.5 (rmw_fastrtps_cpp); no ros2 command, no tf2_ros
origin    built by one person (ycheng517/ros-python-wheels, Apache-2.0), last uploaded in November 2025
security  Fast DDS 2.14.7 fixes 17 known vulnerabilities that 2.14.5 has; OpenSSL 1.1.1k is no longer maintained
for       this machine only: do not expose its nodes to a network that you do not trust
"""


@click.group("ros", short_help="Install a real ROS 2 beside this environment, and use it.")
def ros() -> None:
    """Install a real ROS 2 Jazzy beside this environment, and use it.

    The tutorial uses it where TUTORIAL_ROS=rclpy is set, and in a notebook after use_real_ros(). Nothing else changes.
    """


@ros.command(short_help="Install it, or bring it up to date.")
def install() -> int:
    """Install the real ROS 2 into a folder of its own, unless it is already complete."""
    from tutorial.ros.wheels import folder
    from tutorial.ros.wheels.install import install, size
    from tutorial.ros.wheels.interfaces import install_tf2_msgs

    place = folder.prefix()

    def work(report: Callable[[str], object]) -> None:
        install(report)
        install_tf2_msgs(place, report)

    if not _finish(work):
        return INTERRUPTED
    say(f"The real ROS 2 is in {place} ({size(place) / 1e6:.0f} MB).\n\n{ABOUT}")
    say("\nUse it with export TUTORIAL_ROS=rclpy, or in a notebook with use_real_ros().\n")
    if not (folder.site_packages(place) / "tf2_msgs").exists():
        say(f"\nFor step 7, {folder.NO_TF2_MSGS}\n")
    return 0


@ros.command(short_help="Build messages, services and actions of your own for it.")
@click.argument("package", type=click.Path(file_okay=False, path_type=Path))
def build(package: Path) -> int:
    """Build the interface package in the folder PACKAGE, and install it beside the messages of the real ROS 2.

    tank package --interfaces makes such a package. Building it needs a C++ compiler.
    """
    from tutorial.ros.wheels import folder
    from tutorial.ros.wheels.interfaces import build_interfaces

    folder.check()
    names: list[str] = []
    if not _finish(lambda report: names.append(build_interfaces(package, folder.prefix(), report))):
        return INTERRUPTED
    say(f"{names[0]} is built. Programs with TUTORIAL_ROS=rclpy can import it.\n")
    return 0


@ros.command(short_help="Remove it.")
def remove() -> None:
    """Remove the real ROS 2, and what an interrupted installation has left behind."""
    from tutorial.ros.wheels.install import remove

    say(f"{remove() / 1e6:.0f} MB removed.\n")


@ros.command(short_help="Show what it is, and whether it is installed and in use.")
def info() -> None:
    """Show what the real ROS 2 is, where it came from, and whether it is installed and in use."""
    import pocket_ros2
    from tutorial.ros.wheels import folder
    from tutorial.ros.wheels.install import size

    place, found = folder.prefix(), pocket_ros2.real_rclpy()
    if folder.is_complete(place):
        say(f"folder    {place} ({size(place) / 1e6:.0f} MB)\n")
        say(f"in use    {'yes' if found and folder.has(found) else 'no: set TUTORIAL_ROS=rclpy to use it'}\n")
    else:
        state = "out of date" if place.exists() else "not installed"
        say(f"folder    {place}, {state}. {folder.how_to_get_it()}\n")
    say(ABOUT)


@ros.command(short_help="Run a command with it.", context_settings={"ignore_unknown_options": True})
@click.argument("command", nargs=-1, required=True, type=click.UNPROCESSED)
@click.pass_obj
def run(ros_args: list[str], /, command: tuple[str, ...]) -> None:
    """Run COMMAND with the real ROS 2, as in a terminal where one is sourced: tank ros run python talker.py."""
    from tutorial.paths import with_own_commands
    from tutorial.ros.wheels import folder

    folder.check()
    path = os.pathsep.join(filter(None, (str(folder.site_packages(folder.prefix())), os.environ.get("PYTHONPATH"))))
    variables = {"PYTHONPATH": path, folder.RANGE: folder.discovery_range()}
    try:
        os.execvpe(command[0], [*command, *ros_args], with_own_commands(os.environ) | variables)
    except OSError as error:
        raise TutorialError(f"{command[0]!r} cannot be run: {error.strerror}.") from None


def _finish(work: Callable[[Callable[[str], object]], object]) -> bool:
    """Call a function that reports its progress; return False if Ctrl-C interrupted it."""
    from tutorial.ros.wheels.install import AGAIN

    signal.signal(signal.SIGINT, signal.default_int_handler)
    try:
        with status_line() as report:
            work(report)
    except KeyboardInterrupt:
        say(f"Interrupted. {AGAIN}\n", err=True)
        return False
    return True
