"""What the notebooks import: programs, nodes, widgets and topic tools, each opened under a name.

Opening something under a name closes what was open under it, so any cell can be run twice; `close_all` closes the
rest. Everything here belongs to the kernel's main thread.
"""

from tutorial.notebook.bag_tools import bag_play
from tutorial.notebook.command import Command
from tutorial.notebook.desk import close_all, log, until
from tutorial.notebook.opening import (
    chaos_panel,
    image_view,
    joint_plot,
    joystick,
    node_graph,
    open_node,
    open_program,
    side_by_side,
    start_command,
    swimlane,
)
from tutorial.notebook.process import prepare_process
from tutorial.notebook.program import Program
from tutorial.notebook.progress import progress
from tutorial.notebook.topic_tools import topic_echo, topic_hz, topic_info, topic_list
from tutorial.notebook.widgets.line_plot import line_plot

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
