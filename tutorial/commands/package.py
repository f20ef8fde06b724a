"""The command ``tank package``: a controller, or a node, as a ROS 2 package of its own."""

# ruff: noqa: PLC0415 - help must be fast

from collections.abc import Mapping
from pathlib import Path

import click

from tutorial.commands.options import part_class
from tutorial.errors import TutorialError, printable
from tutorial.system.printing import say


@click.command(short_help="Make a ROS 2 package of a controller of your own.")
@click.argument("name")
@click.option(
    "--controller",
    "own",
    metavar="FILE[:CLASS]",
    help="Make it of the controller in this Python file; CLASS says which one, where there are several.",
)
@click.option(
    "--destination-directory",
    "destination",
    type=click.Path(file_okay=False, path_type=Path),
    default=Path(),
    help="Make the package's folder in this one; else in the current directory.",
)
@click.option("--interfaces", is_flag=True, help="Make one with a message, a service and an action instead.")
def package(name: str, own: str | None, destination: Path, interfaces: bool) -> None:
    """Make a ROS 2 package NAME, which colcon builds, and ros2 run and ros2 launch start.

    Without a controller it is made of an example, a node that needs nothing of the tutorial.
    """
    from tutorial.commands.packaging.contents import make_interfaces, make_package

    folder = destination / name
    if interfaces and own is not None:
        raise click.UsageError("A package has interfaces or a controller: give --interfaces or --controller, not both.")
    files, executable = (
        (make_interfaces(name), "") if interfaces else make_package(name, part_class(own) if own else None)
    )
    _write(folder, files)
    say("".join(f"{printable(str(folder / path))}\n" for path in sorted(files)))
    if interfaces:
        say("\nIf you add a file, list it in CMakeLists.txt. Build the package for the ROS 2 of tank ros install:\n\n")
        say(f"    tank ros build {printable(str(folder))}\n\n")
        say(f"or with a ROS 2 that you have sourced:\n\n    colcon build --packages-select {name}\n")
        return
    say("\nFill in its license, and its maintainer where git knows none, in package.xml and in setup.py. ")
    say("Its README.md says how to build and run it:\n\n")
    say(f"    colcon build --packages-select {name}\n    source install/setup.bash\n")
    say(f"    ros2 run {name} {executable}\n    ros2 launch {name} {name}.launch.py\n")


def _write(folder: Path, files: Mapping[str, bytes]) -> None:
    """Write a package's files into a folder that there is not yet.

    Raises:
        TutorialError: something of this name is there already, or cannot be written.
    """
    try:
        folder.mkdir(parents=True)
        for path, content in files.items():
            (folder / path).parent.mkdir(exist_ok=True)
            (folder / path).write_bytes(content)
    except FileExistsError as error:
        text = f"there is {str(error.filename)!r} already, and it stays as it is. Give another name, or destination."
        raise TutorialError(text) from None
    except OSError as error:
        raise TutorialError(f"{str(folder)!r} cannot be written: {error.strerror}") from error
