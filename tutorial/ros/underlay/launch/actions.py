"""Actions of a launch description."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

__all__ = ["ExecuteProcess"]


class ExecuteProcess:
    """A process to start, with the keywords of ROS 2 launch.

    Args:
        cmd: the program and its arguments.
        name: how to call the process in output.
        cwd: directory to start in.
        env: its whole environment; None inherits.
        additional_env: variables on top of the environment.
        output: where its output goes, for instance ``"screen"``.
        shell: run the command in a shell.
    """

    def __init__(
        self,
        *,
        cmd: Iterable[str],
        name: str | None = None,
        cwd: str | None = None,
        env: Mapping[str, str] | None = None,
        additional_env: Mapping[str, str] | None = None,
        output: str = "log",
        shell: bool = False,
    ) -> None:
        self.cmd = list(cmd)
        self.name = name
        self.cwd = cwd
        self.env = env
        self.additional_env = additional_env
        self.output = output
        self.shell = shell
