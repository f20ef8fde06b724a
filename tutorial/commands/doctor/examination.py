"""The examination as a whole: every probe at once, each with a limit to its time, none able to spoil it."""

from __future__ import annotations

import os
import sys
import threading
import time
from collections.abc import Callable, Iterable, Mapping
from contextlib import suppress
from importlib import metadata
from itertools import chain
from pathlib import Path

from tutorial.commands.doctor.contained import ask
from tutorial.commands.doctor.finding import Finding, layout, summary
from tutorial.commands.doctor.installation import jupyter, mujoco, packages, python, python_home, rendering
from tutorial.commands.doctor.processes import listeners, ports, processes, running
from tutorial.commands.doctor.ros import backend, discovery, domain, nodes
from tutorial.commands.terminal import say
from tutorial.errors import TutorialError
from tutorial.ros.backend import choose, real_rclpy_exists

__all__ = ["PATIENCE", "doctor", "examine"]

PATIENCE = 60.0  # [s] for the examination as a whole; a child of its own gets half of that

Probe = Callable[[], Iterable[Finding]]


def doctor() -> int:
    """Look at this machine, and print what there is: a line or a few for each finding.

    Probes run on threads of their own, all at once, and what may crash or hang runs in processes of its own. A probe
    that fails is a finding.

    Returns:
        The exit status: 0 where there is no problem, else 1.
    """
    findings = []
    for finding in chain.from_iterable(examine(_probes(os.environ))):
        say(f"{layout(finding)}\n")
        findings.append(finding)
    say(f"\n{summary(findings)}\n")
    return int(any(finding.level == "problem" for finding in findings))


def examine(probes: Mapping[str, Probe], patience: float = PATIENCE) -> Iterable[list[Finding]]:
    """Run probes side by side.

    Args:
        probes: what each looks at, and the probe.
        patience: how long they may take together [s]. One that takes longer is given up; its thread is left behind.

    Yields:
        What each has found, in the order in which they are given, as soon as it is known.
    """
    runs = [_Run(subject, probe) for subject, probe in probes.items()]
    deadline = time.monotonic() + patience
    for run in runs:
        run.start()
    for run in runs:
        run.join(max(0.0, deadline - time.monotonic()))
        yield run.findings


class _Run(threading.Thread):
    """One probe at work. Until it is through, what is found is that it takes too long."""

    def __init__(self, subject: str, probe: Probe) -> None:
        super().__init__(name=f"probe of {subject}", daemon=True)
        self._subject, self._probe = subject, probe
        self.findings = [Finding(subject, "note", "it takes too long to look", "run tank doctor again")]

    def run(self) -> None:
        try:
            self.findings = list(self._probe())
        except Exception as error:  # noqa: BLE001 - whatever it is, the other probes go on
            text = f"it could not be looked at: {type(error).__name__}: {error}"
            mend = "look at it by hand; the rest of this list does not depend on it"
            if isinstance(error, ModuleNotFoundError) and error.name:
                mend = f"python -m pip install {error.name}"
            self.findings = [Finding(self._subject, "note", text, mend)]


def _probes(environment: Mapping[str, str]) -> dict[str, Probe]:
    """Bind the probes to this machine, in the order in which a reader wants to know."""
    return {
        "Python": lambda: python(sys.version_info[:3], sys.executable, python_home(sys.prefix, sys.base_prefix)),
        "MuJoCo": lambda: mujoco(environment, ask),
        "rendering": lambda: rendering(environment, ask),
        "packages": lambda: packages(_requirements(), _version_of),
        "JupyterLab": lambda: jupyter(_version_of, _extension_folders()),
        "ROS 2": lambda: backend(environment, choose, real_rclpy_exists, ask),
        "discovery": lambda: discovery(environment, _is_real()),
        "domain": lambda: domain(environment),
        "nodes": lambda: nodes(environment, ask),
        "processes": lambda: processes(running()),
        "ports": lambda: ports(listeners()),
    }


def _version_of(package: str) -> str | None:
    """The installed version of a package; None where there is none."""
    with suppress(metadata.PackageNotFoundError):
        return metadata.version(package)
    return None


def _requirements() -> list[str] | None:
    """What the tutorial requires; None where it is not installed."""
    with suppress(metadata.PackageNotFoundError):
        return metadata.requires("tank-tutorial")
    return None


def _extension_folders() -> list[Path]:
    """Where JupyterLab looks for extensions."""
    from jupyter_core.paths import jupyter_path  # noqa: PLC0415 - where it is missing, that is one finding

    return [Path(folder) for folder in jupyter_path("labextensions")]


def _is_real() -> bool:
    """Whether a real ROS 2 is in use; what is wrong with TUTORIAL_ROS is said by another probe."""
    with suppress(TutorialError):
        return choose() == "rclpy"
    return False
