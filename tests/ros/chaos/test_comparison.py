"""The comparison with other viewers: its table is what the models show."""

from comparison import PAGE, TABLE, judge, table
from viewers import TankTutorial

from tutorial.ros.chaos import FAULTS

NOTHING_TO_SAY = {"subset", "drop"}  # the one is allowed, the other cannot be known


def test_the_table_in_the_book_is_what_the_models_show():
    """If it is not: ``PYTHONPATH=tests/support python tests/support/comparison.py`` writes it anew."""
    assert TABLE.search(PAGE.read_text(encoding="utf-8"))[0] == table()


def test_this_viewer_is_silent_only_where_there_is_nothing_to_say():
    silent = {fault for fault in FAULTS if judge(TankTutorial, fault).endswith("silent")}
    assert silent == NOTHING_TO_SAY
