"""The command ``tank package``, which makes a ROS 2 package for a controller or an example node."""

# ruff: noqa: PLC0415 - help must be fast

from collections.abc import Mapping
from pathlib import Path

import click

from tutorial.commands.options import part_class
from tutorial.errors import TutorialError, printable
from tutorial.system.printing import print_text


@click.command(short_help="Make a ROS 2 package from your own controller.")
@click.argument("name")
@click.option(
    "--controller",
    "own",
    metavar="FILE[:CLASS]",
    help="Use the controller in this Python file; if it defines several, CLASS selects one.",
)
@click.option(
    "--destination-directory",
    "destination",
    type=click.Path(file_okay=False, path_type=Path),
    default=Path(),
    help="Make the package in this folder instead of the current one.",
)
@click.option(
    "--interfaces", is_flag=True, help="Make an interface package with a message, a service and an action instead."
)
@click.option("--service", is_flag=True, help="Make an example node that offers a service. It needs a real ROS 2.")
def package(name: str, own: str | None, destination: Path, interfaces: bool, service: bool) -> None:
    """Make a ROS 2 package called NAME, which you can build with colcon and start with ros2 run or ros2 launch.

    Without --controller, the package contains an example node that does not need the tutorial.
    """
    from tutorial.commands.packaging.contents import make_interfaces, make_package

    folder = destination / name
    if interfaces + service + (own is not None) > 1:
        raise click.UsageError("Give only one of --controller, --interfaces and --service for a package.")
    example = "server" if service else "listener"
    files, executable = (
        (make_interfaces(name), "") if interfaces else make_package(name, part_class(own) if own else None, example)
    )
    _write(folder, files)
    print_text("".join(f"{printable(str(folder / path))}\n" for path in sorted(files)))
    if interfaces:
        print_text(
            "\nIf you add a file, list it in CMakeLists.txt. "
            "Build the package for the ROS 2 installed by tank ros install:\n\n"
        )
        print_text(f"    tank ros build {printable(str(folder))}\n\n")
        print_text(
            "or build it with a ROS 2 installation that you have sourced:\n\n    "
            f"colcon build --packages-select {name}\n"
        )
        return
    print_text(
        "\nFill in the license in package.xml and setup.py, and the maintainer if git doesn't know who you are. "
    )
    print_text("README.md explains how to build and run the package:\n\n")
    print_text(f"    colcon build --packages-select {name}\n    source install/setup.bash\n")
    print_text(f"    ros2 run {name} {executable}\n    ros2 launch {name} {name}.launch.py\n")


def _write(folder: Path, files: Mapping[str, bytes]) -> None:
    """Write a package's files into a new folder.

    Raises:
        TutorialError: the folder already exists, or cannot be written to.
    """
    try:
        folder.mkdir(parents=True)
        for path, content in files.items():
            (folder / path).parent.mkdir(exist_ok=True)
            (folder / path).write_bytes(content)
    except FileExistsError as error:
        text = (
            f"{str(error.filename)!r} already exists and will not be overwritten. Give a different name or destination."
        )
        raise TutorialError(text) from None
    except OSError as error:
        raise TutorialError(f"{str(folder)!r} cannot be written: {error.strerror}") from error
