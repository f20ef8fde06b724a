"""What a cell shows whose ``await`` was left out."""

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
