"""What is read from Python's own sentences, on each version that the tutorial is for."""

from __future__ import annotations

import asyncio
import gc

import pytest
import rclpy

from tutorial.checks._diagnose import likely_cause
from tutorial.controller import SimpleController


class Answer(SimpleController):
    def configure(self, config):
        self.on_joy()

    def on_joy(self, message):
        self.message = message

    def initialize(self, io_):
        io = io_  # noqa: F841

    def control():
        pass

    @property
    def speed(self):
        return 1.0


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


def made_it_a_local_variable():
    Answer().io  # noqa: B018


def kept_no_node():
    Answer().node  # noqa: B018


def read_it_too_early():
    Answer().message  # noqa: B018


def asked_for_the_loop():
    asyncio.get_running_loop()


def spun():
    try:
        rclpy.spin_once(None)
    finally:
        gc.collect()  # the real rclpy leaves half an executor, which complains as it goes


SENTENCES = {
    forgot_self: "Most likely self is missing: def control(self):",
    forgot_the_object: "Most likely parentheses are missing: Answer alone is the class",
    called_at_once: "Most likely the callback is called at once: give it without parentheses, self.on_joy.",
    set_on_none: "Most likely what stands before the dot is None",
    read_from_none: "Most likely what stands before the dot is None",
    took_the_class_for_an_object: "Most likely parentheses are missing where an object is made",
    made_it_a_local_variable: "Most likely self is missing in initialize: self.io = ...",
    kept_no_node: "Most likely configure does not keep it: self.node = config.node.",
    read_it_too_early: "Most likely it is read before anything has set it: configure comes first",
    asked_for_the_loop: "Most likely it asks for the event loop",
    spun: "Leave it out: the program spins its node already",
    set_what_there_is_not: "Did you mean 'speed'?",
}


def raised(mistake):
    with pytest.raises((AttributeError, TypeError, RuntimeError)) as info:
        mistake()
    return info.value


@pytest.mark.filterwarnings("ignore::pytest.PytestUnraisableExceptionWarning")
@pytest.mark.parametrize("mistake", SENTENCES, ids=lambda mistake: mistake.__name__)
def test_pythons_sentence_is_understood(mistake):
    assert likely_cause(raised(mistake), Answer).startswith(SENTENCES[mistake])
