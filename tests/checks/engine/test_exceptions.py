"""CPython's messages and their causes, on each supported version."""

import asyncio
import gc

import pytest
import rclpy
from rclpy.exceptions import NotInitializedException
from rclpy.node import Node

from tutorial.checks.engine.exceptions import likely_cause
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


class Given:
    """An answer that gets a node of its program."""


SENTENCES = {
    "You probably forgot self: def control(self):": lambda: Answer().control(),
    "You probably forgot the parentheses: Answer is the class": lambda: Answer.on_joy(message=1),
    "Your code probably calls the callback immediately. Pass it without parentheses": lambda: Answer().configure(0),
    "The value is a tuple. Unpack it": lambda: (1,).header,
    "You probably forgot self in initialize: self.io = ...": lambda: Answer().io,
    "Your code probably doesn't store it in configure: self.node = config.node.": lambda: Answer().node,
    "Your code probably reads it before it is set: configure runs first": lambda: Answer().message,
    "Your code probably uses the event loop": asyncio.get_running_loop,
    "A list cannot be a key in a dict": lambda: {[]: 1},
    "Remove this call: the program calls rclpy.init, spins its node": lambda: rclpy.spin_once(None),
    "Did you mean 'join'?": lambda: "".jion,
}


@pytest.mark.filterwarnings("ignore::pytest.PytestUnraisableExceptionWarning")
@pytest.mark.parametrize("sentence", SENTENCES)
def test_pythons_messages_are_understood(sentence):
    with pytest.raises((AttributeError, TypeError, RuntimeError)) as info:
        SENTENCES[sentence]()
    assert likely_cause(info.value, Answer).startswith(sentence)
    del info
    gc.collect()  # the real rclpy's spin_once leaves a half-initialized executor, which warns when it is collected


@pytest.mark.parametrize(("answer", "spun"), [(Answer, "its node (config.node)"), (Given, "the node that Given gets")])
@pytest.mark.parametrize("make", [Node, rclpy.create_node])
def test_an_own_node_is_refused(answer, spun, make):
    with pytest.raises(NotInitializedException) as info:
        make("own")
    assert likely_cause(info.value, answer).startswith(
        f"Remove this call: the program calls rclpy.init, spins {spun}, and"
    )
