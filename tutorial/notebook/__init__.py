"""The API for the notebooks: programs, nodes, widgets and topic tools, each registered by name.

Opening an object closes an earlier object with the same name, so that any cell can be run twice. `close_all` closes
everything. Call these functions on the kernel's main thread.
"""

from collections.abc import Callable, Sequence
from contextlib import suppress

from ipywidgets import Widget
from rclpy.executors import Executor, SingleThreadedExecutor

from tutorial.checks.catalogue import exercise_names
from tutorial.checks.progress import Overview
from tutorial.errors import TutorialError
from tutorial.notebook.bag_tools import bag_play
from tutorial.notebook.command import Command
from tutorial.notebook.desk import close_all, keep, log, until
from tutorial.notebook.faults import start_fault, stop_fault
from tutorial.notebook.process import prepare_process
from tutorial.notebook.program import Program
from tutorial.notebook.service_tools import (
    param_describe,
    param_dump,
    param_get,
    param_list,
    param_set,
    service_call,
    service_list,
)
from tutorial.notebook.topic_tools import node_list, topic_echo, topic_hz, topic_info, topic_list, why
from tutorial.notebook.widgets.callback_lanes import callback_lanes
from tutorial.notebook.widgets.chaos_panel import ChaosPanel
from tutorial.notebook.widgets.column import Column
from tutorial.notebook.widgets.image_view import ImageView
from tutorial.notebook.widgets.joint_plot import JointPlot
from tutorial.notebook.widgets.joystick import Joystick
from tutorial.notebook.widgets.line_plot import line_plot
from tutorial.notebook.widgets.node_graph import NodeGraph
from tutorial.notebook.widgets.side_by_side import SideBySide
from tutorial.notebook.widgets.swimlane import swimlane
from tutorial.program.project import Project
from tutorial.ros.node_thread import MeteredNode, NodeThread, SpinThread
from tutorial.ros.watched_node import WatchedNode
from tutorial.system.paths import find_project
from tutorial.system.printing import print_text

__all__ = [
    "Command",
    "Program",
    "bag_play",
    "callback_lanes",
    "chaos_panel",
    "close_all",
    "end_deadlock",
    "image_view",
    "joint_plot",
    "joystick",
    "line_plot",
    "log",
    "node_graph",
    "node_list",
    "open_node",
    "open_program",
    "open_watched_node",
    "param_describe",
    "param_dump",
    "param_get",
    "param_list",
    "param_set",
    "progress",
    "service_call",
    "service_list",
    "side_by_side",
    "start_command",
    "start_fault",
    "stop_fault",
    "swimlane",
    "topic_echo",
    "topic_hz",
    "topic_info",
    "topic_list",
    "until",
    "why",
]

prepare_process()


def open_program(project: Project | str, node: str = "tank") -> Program:
    """Open a project as a program in this kernel. Any open program with the same node name is closed first.

    Args:
        project: a project, its path, or its name, such as ``"step1"``.
        node: the name of the program's node.

    Raises:
        TutorialError: there is no such project, or a controller does not fit its body.
    """
    loaded = project if isinstance(project, Project) else Project.load(find_project(project))
    return keep(f"program {node}", lambda: Program(loaded, node), Program.close)


def open_node(name: str) -> MeteredNode:
    """Make a node whose callbacks run on a separate thread. Any open node with the same name is closed first.

    Args:
        name: the node's name.
    """
    return keep(f"node {name}", lambda: NodeThread(name), NodeThread.close).node


def open_watched_node(name: str, executor: Callable[..., Executor] = SingleThreadedExecutor) -> WatchedNode:
    """Make a node as `open_node` does, and record for `callback_lanes` when the node's callbacks run and wait.

    Args:
        name: the node's name.
        executor: the class of the executor that runs the callbacks.
    """
    return keep(f"node {name}", lambda: SpinThread(WatchedNode, name, executor=executor), _close_watched).node


async def end_deadlock(node: WatchedNode) -> None:
    """Wait until a callback deadlocks; print an explanation, and raise a `DeadlockError` in the callback. Idempotent.

    Raises:
        TutorialError: no callback deadlocked within 30 s.
    """
    await until(lambda: node.deadlocks() or node.ended, "a deadlock")
    node.end_deadlocks()
    print_text("".join(f"{text}\n" for text in node.ended))
    thread = next(each for each in SpinThread.alive if each.node is node)
    with suppress(TutorialError):  # a multithreaded executor reports an exception only at the next callback
        await until(lambda: thread.error, timeout=1.0)


def _close_watched(thread: SpinThread[WatchedNode]) -> None:
    thread.node.end_deadlocks()  # otherwise, the node's thread might never end
    thread.close()


def start_command(line: str) -> Command:
    """Start or restart a command in a separate process, as in a second terminal.

    Args:
        line: the command line, for instance ``"tank joy"``.

    Raises:
        TutorialError: there is no such command.
    """
    return keep(f"command {line}", lambda: Command(line), Command.close)


def joystick() -> Joystick:
    """Show a joystick with two sticks that publishes on ``/joy``."""
    return keep("joystick", Joystick, Joystick.end)


def joint_plot(topic: str = "/Tank/joint_state") -> JointPlot:
    """Show a live plot of joint positions, as rqt_plot does.

    Args:
        topic: a topic of type ``sensor_msgs/msg/JointState``.
    """
    return keep(f"plot of {topic}", lambda: JointPlot(topic), JointPlot.end)


def chaos_panel() -> ChaosPanel:
    """Publish joint states with faults, as ``tank chaos`` does, and show a slider for each kind of fault."""
    return keep("chaos panel", ChaosPanel, ChaosPanel.end)


def image_view(topic: str = "/Tank/camera/image") -> ImageView:
    """Show the images on a topic, as rqt_image_view does.

    Args:
        topic: a topic of type ``sensor_msgs/msg/Image``.
    """
    return keep(f"pictures of {topic}", lambda: ImageView(topic), ImageView.end)


def node_graph() -> NodeGraph:
    """Show the nodes, the topics between them and the topics' rates, as rqt_graph does."""
    return keep("node graph", NodeGraph, NodeGraph.end)


def side_by_side(*widgets: Widget | Sequence[Widget]) -> SideBySide:
    """Show widgets in a row. On a narrow page, 3D views are stacked.

    Args:
        widgets: the widgets to show; a list of widgets becomes a column.
    """
    return SideBySide(*(widget if isinstance(widget, Widget) else Column(widget) for widget in widgets))


def progress(step: int | None = None) -> Overview:
    """Show which exercises are solved, as recorded in ``.tank_progress.json`` beside the notebook.

    Args:
        step: show only the step with this number; None for all steps.
    """
    return Overview(exercise_names(step))
