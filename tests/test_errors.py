"""What goes wrong is said without harm: `tutorial.errors`."""

from __future__ import annotations

import pytest

from tutorial.errors import printable, printable_lines


@pytest.mark.parametrize(
    ("text", "shown"),
    [
        ("/Tank/joint_state", "/Tank/joint_state"),
        ("Kran für Größe 3, 戦車", "Kran für Größe 3, 戦車"),
        ("a\x1b[2Jb\r\n\x07\x9bc", r"a\x1b[2Jb\r\n\x07\x9bc"),
        ("gpj.exe\u202egpj", r"gpj.exe\u202egpj"),
        ("a\u2028b\u00a0c", r"a\u2028b\xa0c"),
        ("half \udc80", r"half \udc80"),
        ("\U000e0041", r"\U000e0041"),
        ("", ""),
    ],
)
def test_what_a_terminal_would_obey_is_shown_as_an_escape(text: str, shown: str) -> None:
    assert printable(text) == shown
    assert printable(text).isprintable()
    printable(text).encode()  # can be written anywhere


def test_a_text_keeps_the_line_ends_and_tabs_that_it_has_of_its_own() -> None:
    assert printable_lines("a\x1bb\n\tc\r\n\u202e") == "a\\x1bb\n\tc\\r\n\\u202e"
