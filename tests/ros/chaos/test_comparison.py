"""The comparison with other viewers: its table is what the models show."""

from comparison import PAGE, TABLE, table


def test_the_table_in_the_book_is_what_the_models_show():
    """If it is not: ``PYTHONPATH=tests/support python tests/support/comparison.py`` writes it anew."""
    assert TABLE.search(PAGE.read_text(encoding="utf-8"))[0] == table()
