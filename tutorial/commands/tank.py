"""The command ``tank``."""

from __future__ import annotations

import gc
import os
import sys
import tempfile
import threading
from contextlib import AsyncExitStack
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click
from tqdm.contrib import DummyTqdmFile

from tutorial import ros_backend
from tutorial.commands.asking import clear_ros_errors, named_node
from tutorial.commands.bag import bag
from tutorial.commands.chaos import chaos
from tutorial.commands.check import check
from tutorial.commands.options import duration_option, headless_option, linger_option, part_class, report_option
from tutorial.commands.package import package
from tutorial.commands.race import race
from tutorial.commands.ros import ros
from tutorial.commands.service import param, service
from tutorial.commands.terminal import INTERRUPTED, handle_signals, prepare_output, progress_bar, until_asked
from tutorial.commands.topic import node, topic
from tutorial.errors import TutorialError, printable
from tutorial.system.printing import print_text

if TYPE_CHECKING:
    from tutorial.commands.joystick import Gamepad, ScriptedDrive
    from tutorial.program.project import Project

FILE = click.Path(path_type=Path)
LINGER = 30.0  # [s] how long launched processes wait for each other, in addition to the duration: machines can be slow


def main(args: list[str] | None = None) -> None:
    """Run a command, and exit with its status.

    Args:
        args: the command line; None for the process's own command line.
    """
    words, ros_args = _split(sys.argv[1:] if args is None else args)
    prepare_output()
    try:
        status = tank.main(args=words, prog_name="tank", standalone_mode=False, obj=ros_args)
    except click.exceptions.Exit as end:
        status = end.exit_code
    except click.ClickException as error:
        error.show()
        status = error.exit_code
    except TutorialError as error:
        print_text(f"Error: {error}\n", err=True)
        status = 1
    except (KeyboardInterrupt, click.Abort):
        status = INTERRUPTED
    gc.freeze()  # otherwise, Python would spend 0.1 s collecting garbage at exit
    sys.exit(status if isinstance(status, int) else 0)


@click.group(context_settings={"help_option_names": ["-h", "--help"]})
@click.version_option(package_name="tank-tutorial", prog_name="tank")
def tank() -> None:
    """Learn ROS 2 by building a tank, step by step.

    Every command accepts ROS 2 arguments after --ros-args, such as -r __node:=viewer.
    """


@tank.command(short_help="Run a project: a simulation, or a viewer.")
@click.argument("project")
@duration_option
@linger_option
@headless_option
@report_option
@click.option(
    "--port",
    type=click.IntRange(1, 65535),
    help="Serve the 3D view on this port; by default, on the first free port from 7000 up.",
)
@click.option("--html", type=FILE, help="Save the run as a web page that replays it.")
@click.option("--bag", type=FILE, metavar="DIR", help="Record the program's topics to a new bag.")
@click.option(
    "--robot", metavar="MODEL", help="Use the robot in this MJCF or URDF file; the body is named after the file."
)
@click.option(
    "--controller", "own", multiple=True, metavar="FILE[:CLASS]", help="Use the controllers in this Python file."
)
@click.pass_obj
def run(
    ros_args: list[str], /, project: str, robot: str | None, own: tuple[str, ...], duration: float | None, **how: Any
) -> int:
    """Run PROJECT: a file such as project/step2.yaml, or the name of a tutorial project, such as step2."""
    from tutorial.program.controller_files import load_controllers
    from tutorial.program.project import Project
    from tutorial.system.paths import find_model, find_project

    ros_backend()  # otherwise, an error would blame the first controller that imports rclpy
    loaded = Project.load(find_project(project))
    if robot is not None:
        loaded = loaded.with_robot(find_model(robot))
    for given in own:
        loaded = loaded.with_own(load_controllers(*part_class(given)))
    asked = until_asked(_host(loaded, ros_args, duration, **how))
    return INTERRUPTED if asked and duration is not None else 0


@tank.command(short_help="Publish a gamepad's input or a scripted drive on /joy.")
@click.option("--drive", metavar="FILE", help="Publish the drive in this file, or a tutorial drive, such as tour.")
@duration_option
@linger_option
@report_option
@click.pass_obj
def joy(ros_args: list[str], drive: str | None, duration: float | None, linger: float, report: Path | None) -> int:
    """Publish a gamepad's input on /joy or, if no gamepad is connected, a scripted drive."""
    from tutorial.commands.joystick import publish_joystick
    from tutorial.program.record import make_record, write_record

    source = _joy_source(drive)
    stop = threading.Event()
    handle_signals(stop.set)
    with named_node("joy", ros_args) as thread, progress_bar(duration) as progress:
        seconds = publish_joystick(thread.node, source, duration, linger, stop, progress)
        if report is not None:
            write_record(make_record(thread.node.get_name(), seconds, thread.node.meters), report)
    return INTERRUPTED if stop.is_set() and duration is not None else 0


@tank.command(short_help="Run all programs in a launch file.")
@click.argument("step")
@duration_option
@headless_option
@report_option
def launch(step: str, duration: float | None, headless: bool, report: Path | None) -> int:
    """Run a launch file: STEP is a path, or the name of a tutorial launch file, such as step3."""
    return _launch(step, duration, headless, report)


@tank.command(short_help="Run all programs of step 3, and summarize the run in a table.")
@duration_option
@headless_option
def demo(duration: float | None, headless: bool) -> int:
    """Run all programs of step 3, and summarize their messages in a table at the end."""
    from rich.console import Console

    from tutorial.commands.demo import read_records, summary

    if duration is None and not (sys.stdin.isatty() and sys.stdout.isatty()):
        duration = 20.0
    print_text("A joystick, a simulation and a viewer: three programs that communicate over ROS 2 topics.\n")
    print_text("Open the two addresses below in a browser.\n")
    print_text(f"The demo stops after {duration:g} s.\n" if duration else "Press Ctrl-C to stop.\n")
    with tempfile.TemporaryDirectory(prefix="tank-") as directory:
        status = _launch("step3", duration, headless, Path(directory))
        records = read_records(Path(directory))
    if records:
        Console().print(summary(records))
    return status


@tank.command(short_help="Open the first notebook in JupyterLab.")
@click.argument("jupyter_args", nargs=-1, type=click.UNPROCESSED)
def lab(jupyter_args: tuple[str, ...]) -> None:
    """Open JupyterLab on the first notebook. Arguments after -- are passed to JupyterLab."""
    from tutorial.commands.lab import lab_command, own_course, trust
    from tutorial.system.paths import with_own_commands

    course = own_course()
    trust(course / "notebooks")
    os.execve(sys.executable, lab_command(jupyter_args, course), with_own_commands(os.environ))


@tank.command("doctor", short_help="Check this machine, or find out why no messages arrive on a topic.")
@click.argument("topic_name", metavar="[TOPIC]", required=False)
@click.option(
    "--domain",
    "domains",
    type=click.IntRange(0, 232),
    multiple=True,
    help="Search this domain for TOPIC instead of domains 0 to 10. Can be repeated.",
)
@click.pass_obj
def check_up(ros_args: list[str], topic_name: str | None, domains: tuple[int, ...]) -> int:
    """Check whether this machine has what the tutorial needs, and suggest fixes.

    With TOPIC, find out why none of its messages arrive here. The search takes about five seconds and publishes
    nothing.
    """
    if topic_name is not None:
        from tutorial.commands.topic_doctor import doctor_of

        return doctor_of(topic_name, ros_args, domains)
    from tutorial.commands.doctor import doctor

    return doctor()


@tank.command(short_help="Show which exercises are solved.")
@click.argument("folder", required=False, type=click.Path(exists=True, file_okay=False, path_type=Path))
def progress(folder: Path | None) -> None:
    """Show which exercises are solved in the notebooks in FOLDER (by default, the current course folder)."""
    from tutorial.checks.catalogue import exercise_names
    from tutorial.checks.progress import FILE, Overview
    from tutorial.system.paths import HOME

    places = [Path(), Path("notebooks")] if folder is None else [folder, folder / "notebooks"]
    default = HOME / "notebooks" if folder is None else folder
    place = next((place for place in places if (place / FILE).exists()), default)
    print_text(f"{Overview(exercise_names(), place)!r}\n")


@tank.command(short_help="Print a robot's description as URDF.")
@click.argument("model")
def urdf(model: str) -> None:
    """Print MODEL as URDF: an MJCF or URDF file, or the name of a tutorial model, such as tank.

    RobotDescriptionPublisher publishes the same text. Save it with: tank urdf tank > tank.urdf.
    """
    from tutorial.body import Body
    from tutorial.description.urdf import robot_description
    from tutorial.system.paths import find_model
    from tutorial.world import Placement

    path = find_model(model)
    print_text(robot_description(Body.displayed(Placement(path.stem.capitalize(), path))))


for command in (bag, chaos, check, node, package, param, race, ros, service, topic):
    tank.add_command(command)


def _split(words: list[str]) -> tuple[list[str], list[str]]:
    """Separate the command's own arguments from ROS 2's, which extend from ``--ros-args`` to ``--`` or to the end."""
    if "--ros-args" not in words:
        return words, []
    begin = words.index("--ros-args")
    end = words.index("--", begin) + 1 if "--" in words[begin:] else len(words)
    return words[:begin] + words[end:], words[begin:end]


async def _host(
    project: Project,
    ros_args: list[str],
    duration: float | None,
    linger: float,
    headless: bool,
    report: Path | None,
    port: int | None,
    html: Path | None,
    bag: Path | None,
) -> None:
    """Run a project on the running event loop."""
    from tutorial.commands.run_bag import bag_of
    from tutorial.program.host import Host
    from tutorial.program.record import write_record
    from tutorial.view.bodies import View
    from tutorial.view.replay import recorded
    from tutorial.view.scene import Scene

    async with AsyncExitStack() as stack:
        scene = Scene()
        view = None if headless and html is None else View(scene)
        with clear_ros_errors():
            host = await stack.enter_async_context(Host(project, ros_args, view))
        print_text(f"{project.tree()}\n")
        if not headless:
            from tutorial.view.web import SceneServer

            server = await stack.enter_async_context(SceneServer(scene, port=port, title=host.node.get_name()))
            print_text(f"3D view: {server.url}\n")
        if bag is not None:
            await stack.enter_async_context(bag_of(host, bag))
        if html is not None:
            stack.enter_context(recorded(scene, html, host.node.get_name(), host.shown_at, host.joint_positions))
        progress = stack.enter_context(progress_bar(duration))
        try:
            await host.run(duration, linger, progress)
        finally:
            if report is not None:
                write_record(host.record(), report)


def _joy_source(drive: str | None) -> ScriptedDrive | Gamepad:
    from tutorial.commands.joystick import Gamepad, ScriptedDrive
    from tutorial.system.paths import find_drive

    if drive is None and (gamepad := Gamepad.find()) is not None:
        print_text(f"gamepad: {printable(gamepad.name)}\n")
        return gamepad
    path = find_drive(drive or "tour")
    print_text(f"{'' if drive else 'no gamepad is connected; '}scripted drive: {path.name}\n")
    return ScriptedDrive(path)


def _launch(step: str, duration: float | None, headless: bool, report: Path | None) -> int:
    """Run a launch file in this terminal. Its processes receive the options through environment variables."""
    from tutorial.commands.launcher import Launcher, load_launch_file
    from tutorial.system.paths import find_launch_file

    ros_backend()  # otherwise, each process would report that ROS 2 is missing
    environment: dict[str, str] = {}
    if duration is not None:
        environment |= {"TANK_DURATION": str(duration), "TANK_LINGER": str(LINGER + duration)}
    if headless:
        environment["TANK_HEADLESS"] = "1"
    if report is not None:
        environment["TANK_REPORT"] = str(report.absolute())
    processes = load_launch_file(find_launch_file(step))
    above_the_bar: Any = DummyTqdmFile(sys.stdout)
    launcher = Launcher(processes, environment, above_the_bar)
    with progress_bar(duration) as progress:
        status = launcher.run(progress)
    return INTERRUPTED if launcher.interrupted and duration is not None and not status else status
