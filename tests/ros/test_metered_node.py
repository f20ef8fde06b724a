"""A node that counts is rclpy's in everything that its program sees: the same tests with a plain one."""

from __future__ import annotations

from functools import partial

import pytest
from programs import until
from rclpy.exceptions import InvalidTopicNameException
from rclpy.node import Node
from std_msgs.msg import String

from tutorial.ros.node_thread import NodeThread, SpinThread

THREADS = {
    "plain": lambda: SpinThread(Node, "tank"),
    "counting": lambda: NodeThread("tank"),
}


@pytest.fixture(params=THREADS)
def thread(domain, request):
    thread = THREADS[request.param]()
    yield thread
    thread.close()


@pytest.fixture
def node(thread):
    return thread.node


def send(publisher, count, *texts):
    """Publish once so many subscriptions have been found."""
    until(lambda: publisher.get_subscription_count() == count, "the match")
    for text in texts:
        publisher.publish(String(data=text))


def test_a_callback_gets_the_message_alone_if_it_can_do_with_that(node):
    got = []
    callbacks = [
        lambda message: got.append(("one", message.data)),
        lambda message, name="default": got.append((name, message.data)),
        lambda *arguments: got.append(("any", len(arguments))),
        partial(lambda name, message: got.append((name, message.data)), "partial"),
        lambda message, info: got.append(("two", message.data, sorted(info)[-1])),
    ]
    for callback in callbacks:
        node.create_subscription(String, "words", callback, 1)
    send(node.create_publisher(String, "words", 1), len(callbacks), "a")
    until(lambda: len(got) == len(callbacks), "all of them to be called")
    assert sorted(got) == [
        ("any", 1),
        ("default", "a"),
        ("one", "a"),
        ("partial", "a"),
        ("two", "a", "source_timestamp"),
    ]


@pytest.mark.parametrize("callback", [lambda: 0, lambda message, *, info: 0, partial(lambda message: 0, "")])
def test_a_callback_that_takes_something_else_is_refused_and_leaves_nothing(node, callback):
    before = list(node.subscriptions)
    with pytest.raises(RuntimeError, match="callback should be either be callable with one argument"):
        node.create_subscription(String, "words", callback, 1)
    assert list(node.subscriptions) == before
    assert getattr(node, "meters", []) == []


def test_a_coroutine_function_is_left_to_rclpy(node, backend):
    got = []

    async def on_words(message):
        got.append(message.data)

    if backend == "pocket":
        with pytest.raises(ImportError, match="coroutine"):
            node.create_subscription(String, "words", on_words, 1)
        return
    node.create_subscription(String, "words", on_words, 1)
    send(node.create_publisher(String, "words", 1), 1, "a")
    until(lambda: got == ["a"], "the callback")


def test_what_is_created_is_rclpys(node):
    publisher = node.create_publisher(msg_type=String, topic="words", qos_profile=1)
    subscription = node.create_subscription(msg_type=String, topic="words", callback=print, qos_profile=1)
    assert publisher in node.publishers
    assert subscription in node.subscriptions
    assert (publisher.topic_name, subscription.topic_name) == ("/words", "/words")
    with pytest.raises(InvalidTopicNameException):
        node.create_publisher(String, "no words", 1)
    with pytest.raises(TypeError):
        publisher.publish("a")


@pytest.mark.parametrize("failure", [SystemExit, KeyboardInterrupt, GeneratorExit, ValueError])
def test_whatever_a_callback_raises_is_seen_and_the_node_goes_on(thread, caplog, failure):
    heard = []

    def fail_at_first(message):
        heard.append(message.data)
        if len(heard) == 1:
            raise failure

    thread.node.create_subscription(String, "words", fail_at_first, 10)
    send(thread.node.create_publisher(String, "words", 10), 1, "first", "second")
    until(lambda: heard == ["first", "second"], "both messages")
    assert isinstance(thread.error, failure)
    assert "a callback of the node 'tank' failed; the others go on" in caplog.text


def test_a_node_that_its_program_has_destroyed_can_be_closed(thread):
    thread.node.create_subscription(String, "words", print, 1)
    thread.node.destroy_node()
    thread.close()
    thread.close()
    assert not thread._thread.is_alive()
