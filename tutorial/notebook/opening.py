"""Opens what a notebook works with, each under a name."""

from __future__ import annotations

from ipywidgets import Widget

from tutorial.notebook.command import Command
from tutorial.notebook.desk import keep
from tutorial.notebook.program import Program
from tutorial.notebook.widgets.chaos_panel import ChaosPanel
from tutorial.notebook.widgets.image_view import ImageView
from tutorial.notebook.widgets.joint_plot import JointPlot
from tutorial.notebook.widgets.joystick import Joystick
from tutorial.notebook.widgets.node_graph import NodeGraph
from tutorial.notebook.widgets.picture import Picture
from tutorial.notebook.widgets.side_by_side import SideBySide
from tutorial.notebook.widgets.swimlane import swimlane as picture_of
from tutorial.paths import find_project
from tutorial.project import Project
from tutorial.ros.node_thread import MeteredNode, NodeThread

__all__ = [
    "chaos_panel",
    "image_view",
    "joint_plot",
    "joystick",
    "node_graph",
    "open_node",
    "open_program",
    "side_by_side",
    "start_command",
    "swimlane",
]


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


def swimlane(program: Program, count: int = 8) -> Picture:
    """Draw when the last messages of a program were received, posted and applied, and on which thread.

    Args:
        program: whose messages.
        count: how many of them.
    """
    return picture_of(program.trace, count)
