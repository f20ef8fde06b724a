"""What is read from Python's own sentences: on the versions that the tutorial is for, and on no others."""

from __future__ import annotations

import sys
import tomllib

import pytest
from packaging.specifiers import SpecifierSet

from tutorial.checks import _diagnose
from tutorial.checks._diagnose import PROVED, blamed, likely_cause, owner_of
from tutorial.controller import SimpleController
from tutorial.paths import HOME


class Answer(SimpleController):
    def configure(self, config):
        self.on_joy()

    def on_joy(self, message):
        self.message = message

    def control():
        pass

    @property
    def speed(self):
        return 1.0


class Plain:
    pass


class Slotted:
    __slots__ = ("speed",)


def forgot_self():
    Answer().control()


def forgot_the_object():
    Answer.on_joy(message=1)


def called_at_once():
    Answer().configure(None)


def set_on_none():
    None.speed = 1


def read_from_none():
    None.speed  # noqa: B018


def took_the_class_for_an_object():
    Answer.speed()


def set_what_there_is_not():
    slotted = Slotted()
    slotted.sped = 1


SENTENCES = {
    forgot_self: "Most likely self is missing: def control(self):",
    forgot_the_object: "Most likely parentheses are missing: Answer alone is the class",
    called_at_once: "Most likely the callback is called at once: give it without parentheses, self.on_joy.",
    set_on_none: "Most likely what stands before the dot is None",
    read_from_none: "Most likely what stands before the dot is None",
    took_the_class_for_an_object: "Most likely parentheses are missing where an object is made",
    set_what_there_is_not: "Did you mean 'speed'?",
}


def raised(mistake):
    with pytest.raises((AttributeError, TypeError)) as info:
        mistake()
    return info.value


@pytest.fixture
def unknown(monkeypatch):
    monkeypatch.setattr(_diagnose, "PROVED", ())


def test_every_python_that_the_tutorial_is_for_has_been_proved():
    project = tomllib.loads((HOME / "pyproject.toml").read_text())["project"]
    wanted = SpecifierSet(project["requires-python"])
    assert [version for version in ((3, minor) for minor in range(30)) if f"3.{version[1]}.0" in wanted] == [*PROVED]
    assert sys.version_info[:2] in PROVED


@pytest.mark.parametrize("mistake", SENTENCES, ids=lambda mistake: mistake.__name__)
def test_pythons_sentence_is_understood(mistake):
    assert likely_cause(raised(mistake), Answer).startswith(SENTENCES[mistake])


def test_a_class_that_is_no_controller_lets_its_init_set_what_it_has():
    assert likely_cause(raised(lambda: Plain().speed), Plain).endswith("let __init__ set it.")


@pytest.mark.usefixtures("unknown")
@pytest.mark.parametrize("mistake", SENTENCES, ids=lambda mistake: mistake.__name__)
def test_on_another_python_an_exception_speaks_for_itself(mistake):
    error = raised(mistake)
    assert blamed(error, Answer) is None
    structured = isinstance(error, AttributeError) and error.obj is not None
    assert structured or likely_cause(error, Answer) == _diagnose._GENERAL


@pytest.mark.parametrize("text", ["", "3 are too many", "'Answer' has nothing called 'speed'", "f() missing: 1", "'"])
@pytest.mark.parametrize("kind", [AttributeError, TypeError])
def test_a_sentence_that_is_not_known_is_no_cause(kind, text):
    error = kind(text)
    assert likely_cause(error, Answer) == _diagnose._GENERAL
    assert blamed(error, Answer) is None
    if kind is AttributeError:
        assert owner_of(error) == (None, "")
