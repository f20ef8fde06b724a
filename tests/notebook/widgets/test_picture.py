"""The picture in a cell."""

from xml.etree import ElementTree

import pytest

from tutorial.notebook.widgets.picture import Picture
from tutorial.notebook.widgets.svg import draw, new_picture, shorten, to_text, write


def test_it_shows_a_new_picture_with_its_description():
    picture = Picture("<svg></svg>", "a rectangle", "rectangle")
    assert repr(picture) == "Picture('rectangle')"
    assert (picture.svg, picture.alt) == ("<svg></svg>", "a rectangle")
    picture.show("<svg/>", "nothing")
    assert (picture.svg, picture.alt) == ("<svg/>", "nothing")
    assert {"svg", "alt", "ended"} <= picture.get_state().keys(), "the page receives them"
    picture.close()
    picture.close()


def test_every_name_is_escaped():
    root = new_picture(10, 10)
    text = write(root, 1, 2, "<b>&\x00\x1b\ud800\u202e")
    draw(text, "title").text = "a\x01b"
    read = ElementTree.fromstring(to_text(root))
    assert read[0].text == r"<b>&\x00\x1b\ud800\u202e"
    assert read[0][0].text == r"a\x01b"


@pytest.mark.parametrize(("text", "short"), [("abcdef", "abcdef"), ("abcdefg", "abc…fg"), ("a" * 99, "aaa…aa")])
def test_a_long_name_is_shortened_in_the_middle(text, short):
    assert shorten(text, 6) == short
