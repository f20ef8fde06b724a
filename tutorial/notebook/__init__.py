"""What the notebooks import: programs, nodes, widgets and topic tools, each opened under a name.

Opening something under a name closes what was open under it, so any cell can be run twice; `close_all` closes the
rest. Everything here belongs to the kernel's main thread.
"""

from ipywidgets import Widget

from tutorial.checks.catalogue import exercise_names
from tutorial.checks.progress import Overview
from tutorial.notebook.bag_tools import bag_play
from tutorial.notebook.command import Command
from tutorial.notebook.desk import close_all, keep, log, until
from tutorial.notebook.process import prepare_process
from tutorial.notebook.program import Program
from tutorial.notebook.topic_tools import topic_echo, topic_hz, topic_info, topic_list
from tutorial.notebook.widgets.chaos_panel import ChaosPanel
from tutorial.notebook.widgets.image_view import ImageView
from tutorial.notebook.widgets.joint_plot import JointPlot
from tutorial.notebook.widgets.joystick import Joystick
from tutorial.notebook.widgets.line_plot import line_plot
from tutorial.notebook.widgets.node_graph import NodeGraph
from tutorial.notebook.widgets.side_by_side import SideBySide
from tutorial.notebook.widgets.swimlane import swimlane
from tutorial.program.project import Project
from tutorial.ros.node_thread import MeteredNode, NodeThread
from tutorial.system.paths import find_project

__all__ = [
    "Command",
    "Program",
    "bag_play",
    "chaos_panel",
    "close_all",
    "image_view",
    "joint_plot",
    "joystick",
    "line_plot",
    "log",
    "node_graph",
    "open_node",
    "open_program",
    "progress",
    "side_by_side",
    "start_command",
    "swimlane",
    "topic_echo",
    "topic_hz",
    "topic_info",
    "topic_list",
    "until",
]

prepare_process()


def open_program(project: Project | str, node: str = "tank") -> Program:
    """Run a project within this kernel; a program of the same node name is closed first.

    Args:
        project: a project, or the path or the name of one, such as ``"step1"``.
        node: what the program's node is called.

    Raises:
        TutorialError: there is no such project, or a controller does not fit its body.
    """
    loaded = project if isinstance(project, Project) else Project.load(find_project(project))
    return keep(f"program {node}", lambda: Program(loaded, node), Program.close)


def open_node(name: str) -> MeteredNode:
    """Make a node of its own, whose callbacks run on a thread of its own; one of the same name is closed first.

    Args:
        name: the node's name.
    """
    return keep(f"node {name}", lambda: NodeThread(name), NodeThread.close).node


def start_command(line: str) -> Command:
    """Start a command in a process of its own, as in a second terminal; if it runs already, it is stopped first.

    Args:
        line: as one would type it, for instance ``"tank joy"``.

    Raises:
        TutorialError: there is no such command.
    """
    return keep(f"command {line}", lambda: Command(line), Command.close)


def joystick() -> Joystick:
    """Show a joystick with two sticks, which publishes ``/joy``."""
    return keep("joystick", Joystick, Joystick.end)


def joint_plot(topic: str = "/Tank/joint_state") -> JointPlot:
    """Show a live plot of joint positions, as rqt_plot does.

    Args:
        topic: of type ``sensor_msgs/msg/JointState``.
    """
    return keep(f"plot of {topic}", lambda: JointPlot(topic), JointPlot.end)


def chaos_panel() -> ChaosPanel:
    """Show a slider for each fault in a stream of joint states, which it publishes; ``tank chaos`` at a terminal."""
    return keep("chaos panel", ChaosPanel, ChaosPanel.end)


def image_view(topic: str = "/Tank/camera/image") -> ImageView:
    """Show the pictures of a topic, as rqt_image_view does.

    Args:
        topic: of type ``sensor_msgs/msg/Image``.
    """
    return keep(f"pictures of {topic}", lambda: ImageView(topic), ImageView.end)


def node_graph() -> NodeGraph:
    """Show the nodes and the topics between them, with their rates, as rqt_graph does."""
    return keep("node graph", NodeGraph, NodeGraph.end)


def side_by_side(*widgets: Widget) -> SideBySide:
    """Show widgets in a row; on a narrow page, one below the other.

    Views share the room that the others leave.
    """
    return SideBySide(*widgets)


def progress(step: int | None = None) -> Overview:
    """Show which exercises are solved; that is remembered beside the notebook, in ``.tank_progress.json``.

    Args:
        step: the number of the only step to show; None for all.
    """
    return Overview(exercise_names(step))
