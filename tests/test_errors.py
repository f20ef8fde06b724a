"""Errors as harmless texts: `tutorial.errors`."""

import pytest

from tutorial.errors import describe_error, did_you_mean, printable, printable_lines


@pytest.mark.parametrize(
    ("text", "shown"),
    [
        ("Kran für Größe 3, 戦車", "Kran für Größe 3, 戦車"),
        ("a\x1b[2Jb\r\n\x07\x9bc", r"a\x1b[2Jb\r\n\x07\x9bc"),
        ("gpj.exe\u202egpj", r"gpj.exe\u202egpj"),
        ("a\u2028b\u00a0c", "a\\u2028b\u00a0c"),
        ("half \udc80", r"half \udc80"),
        ("\U000e0041", r"\U000e0041"),
    ],
)
def test_control_characters_are_escaped(text, shown):
    assert printable(text) == shown


def test_a_texts_own_line_ends_and_tabs_stay():
    assert printable_lines("a\x1bb\n\tc\r\n\u202e") == "a\\x1bb\n\tc\\r\n\\u202e"


def test_an_error_outside_the_readers_file_has_no_line():
    assert describe_error(ValueError("mine"), "mine.py") == "mine.py: ValueError: mine"


def test_of_many_valid_names_only_some_are_listed():
    assert did_you_mean("b", "ac") == " Known: 'a', 'c'."
    said = did_you_mean("n1234", (f"n{i}" for i in range(2000)))
    assert said.startswith(" Did you mean 'n1234'? Known: 'n0', 'n1', ")
    assert said.endswith(" and 1,970 more.")
