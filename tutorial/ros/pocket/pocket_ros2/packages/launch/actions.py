"""Actions of a launch description."""

from collections.abc import Mapping
from dataclasses import dataclass

from _absent import TABLE, absent_names

__all__ = ["ExecuteProcess"]

__getattr__ = absent_names(__name__, TABLE["names"][__name__])


@dataclass(kw_only=True, eq=False)
class ExecuteProcess:
    """A process to start, described with the same keywords as in ROS 2 launch.

    Attributes:
        cmd: the program and its arguments.
        name: the process's name in the output.
        cwd: the process's working directory.
        env: the complete environment; None to inherit the launcher's environment.
        additional_env: variables to add to the environment.
        output: where the process's output goes, such as ``"screen"``.
        shell: run the command in a shell.
    """

    cmd: list[str]
    name: str | None = None
    cwd: str | None = None
    env: Mapping[str, str] | None = None
    additional_env: Mapping[str, str] | None = None
    output: str = "log"
    shell: bool = False
