"""What importing `tutorial.notebook` does to a kernel."""

from __future__ import annotations

from kernels import kernel

FORGOTTEN = """
from tutorial.notebook import topic_list
shown, _ = get_ipython().display_formatter.format({call})
print(shown["text/plain"])
"""


def test_a_forgotten_await_is_named_and_python_does_not_complain_later():
    with kernel() as desk:
        assert desk.run(FORGOTTEN.format(call="topic_list()")) == (
            "topic_list has not run yet: this takes a while, so write await before it.\n"
        )
        desk.run("from tutorial.checks.tank_controller import drive")
        assert desk.run(FORGOTTEN.format(call="drive.check()")).startswith("Exercise.check has not run yet")
        assert desk.run("import gc; gc.collect(); print()") == "\n"


def test_a_notebook_is_heard_on_its_own_machine_unless_it_is_told_otherwise(monkeypatch):
    monkeypatch.delenv("ROS_AUTOMATIC_DISCOVERY_RANGE", raising=False)
    asked = "import os, tutorial.notebook; print(os.environ['ROS_AUTOMATIC_DISCOVERY_RANGE'])"
    with kernel() as desk:
        assert desk.run(asked) == "LOCALHOST\n"
    monkeypatch.setenv("ROS_AUTOMATIC_DISCOVERY_RANGE", "OFF")
    with kernel() as desk:
        assert desk.run(asked) == "OFF\n"
