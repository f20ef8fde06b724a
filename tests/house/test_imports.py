"""Side effects of imports."""

import pkgutil
import subprocess
import sys

import pytest

import tutorial

pytestmark = pytest.mark.process

SCRIPT = """
import importlib, signal, sys
before = signal.getsignal(signal.SIGINT)
for name in sys.argv[1:]:
    try:
        importlib.import_module(name)
    except ImportError as error:
        if type(error).__name__ != "NeedsRealROSError":  # services: the pocket ROS 2 has none
            raise
    assert signal.getsignal(signal.SIGINT) is before, name
"""


def test_no_import_changes_ctrl_c():
    names = [module.name for module in pkgutil.walk_packages(tutorial.__path__, "tutorial.")]
    modules = [name for name in names if name != "tutorial.__main__"]  # that one is a program
    ended = subprocess.run([sys.executable, "-c", SCRIPT, *modules], check=False, capture_output=True, text=True)
    assert ended.returncode == 0, ended.stderr


QUICK = """
import gc, sys
import tutorial.__main__
assert gc.isenabled() and gc.get_freeze_count() > 10_000
import rclpy
from sensor_msgs.msg import Joy
print("rosbags" in sys.modules)
"""


def test_slow_unneeded_modules_are_not_imported():
    """Imported objects are exempt from garbage collection, but later ones are not."""
    ended = subprocess.run([sys.executable, "-c", QUICK], check=False, capture_output=True, text=True)
    assert (ended.stdout, ended.stderr) == ("False\n", "")
