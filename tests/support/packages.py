"""Install the ROS 2 packages of ``tank package`` like colcon, but without colcon and without a network."""

import os
import subprocess
import sys
from importlib.util import find_spec
from pathlib import Path

import pytest
from programs import TIMEOUT

CONTROLLERS = """
from tutorial.controllers import joint_state_publisher, tank_controller

class TankController(tank_controller.TankController):
    pass

class JointStatePublisher(joint_state_publisher.JointStatePublisher):
    def configure(self, config):
        super().configure(config)
        config.node.get_logger().info("mine publishes")
"""
"""A learner's file: two controllers."""


def need_setuptools() -> None:
    """Skip the test if setuptools is missing. Don't import it: that fails after ``find_spec("pip")``."""
    if find_spec("setuptools") is None:
        pytest.skip("installing a package needs setuptools, which comes with ROS 2")


def run(*arguments: object, cwd: Path, **environment: str) -> str:
    """Run Python in a folder, and return its output."""
    pipe = {"stdout": subprocess.PIPE, "stderr": subprocess.STDOUT, "text": True, "timeout": 2 * TIMEOUT}
    words, variables = [sys.executable, *map(str, arguments)], {**os.environ, **environment}
    done = subprocess.run(words, cwd=cwd, env=variables, check=False, **pipe)
    assert done.returncode == 0, done.stdout
    return done.stdout


def install(package: Path, prefix: Path) -> Path:
    """Install a package like ``colcon build``, all packages into one prefix; return Python's path for it."""
    (package / "build").mkdir()
    how = ("--single-version-externally-managed", "--record", "build/record.txt")
    run("setup.py", "install", *how, "--prefix", prefix, cwd=package)
    (module,) = prefix.glob(f"lib/python*/site-packages/{package.name}")
    return module.parent
